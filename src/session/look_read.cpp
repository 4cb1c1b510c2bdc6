#include "session/look_read.h"

#include <nlohmann/json.hpp>

#include "base/log.h"
#include "job/content_hash.h"

namespace candela {

Expected<LookRead> read_look_files(const Job& job) {
  LookRead look;
  if (!job.look.empty()) {
    auto read = read_look_file(job.look);
    if (!read) return std::unexpected(read.error());
    look.file = std::move(*read);
    auto at = look.file->at();
    if (!at) return std::unexpected(at.error());
    look.at_begin = std::move(*at);
  }
  for (const PathRequest& path : look.at_begin.paths) look.motion += path_json(path).dump();
  for (const InstancesRequest& instances : look.at_begin.instances) look.motion += instances_json(instances).dump();
  return look;
}

Expected<void> hash_look(const Job& job, const Scene& scene, LookRead& look) {
  const auto skies = sky_files(job, look.at_begin);
  if (!skies) return std::unexpected(skies.error());
  const auto contents = hash_files({}, *skies, "");
  if (!contents) return std::unexpected(contents.error());
  const SkyLook& sky = look.at_begin.sky;
  look.skies = fmt::format("{} {} {} {} {}", contents->hex(), sky.gradient.has_value(), sky.atmosphere.has_value(),
                           sky.second.has_value(), sky.extract_sun ? int(*sky.extract_sun) : -1);
  const auto content = hash_files(scene.files, *skies, job.look);
  if (!content) return std::unexpected(content.error());
  look.content = *content;
  return {};
}

Expected<JobSky> read_sky(const Job& job, const LookRead& look, const Scene& scene) {
  std::vector<std::string> warnings;
  auto sky = JobSky::read(job, look.at_begin, scene, warnings);
  if (sky)
    for (const std::string& warning : warnings) log::warning("{}", warning);
  return sky;
}

}  // namespace candela
