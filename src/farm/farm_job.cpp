#include "farm/farm_job.h"

#include "base/files.h"
#include "base/json.h"

namespace candela {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

template <class T>
Expected<T> member(const Json& j, const char* key, const std::string& place) {
  try {
    return j.at(key).get<T>();
  } catch (const Json::exception&) {
    return fail(ErrorKind::input, place + ": /" + key, "is missing or of another kind");
  }
}

// Reads members until the first that is not right.
class Members {
 public:
  Members(const Json& j, std::string place) : j_(j), place_(std::move(place)) {}
  template <class T>
  Members& read(const char* key, T& into) {
    if (!result_) return *this;
    if (auto value = member<T>(j_, key, place_))
      into = std::move(*value);
    else
      result_ = std::unexpected(value.error());
    return *this;
  }
  // Of jobs that were written before there was one.
  template <class T>
  Members& read_where_it_is(const char* key, T& into) {
    return j_.is_object() && j_.contains(key) ? read(key, into) : *this;
  }
  const Expected<void>& result() const { return result_; }

 private:
  const Json& j_;
  std::string place_;
  Expected<void> result_;
};

Expected<void> check_texts(const FarmJob& job, const std::string& place) {
  const auto refuse = [&](const Error& error) {
    return std::unexpected(Error{ErrorKind::input, error.message, place});
  };
  if (const auto frames = parse_frame_list(job.frames); !frames) return refuse(frames.error());
  if (const auto rate = parse_frame_rate(job.fps); !rate) return refuse(rate.error());
  for (const std::string& output : job.outputs)
    if (const auto pattern = parse_pattern(output); !pattern) return refuse(pattern.error());
  const size_t frames = job.frame_list().size();
  if (job.shards < 1 || size_t(job.shards) > frames)
    return fail(ErrorKind::input, place + ": /shards", "{} is not from 1 to the number of frames, {}", job.shards,
                frames);
  return {};
}

}  // namespace

FrameList FarmJob::frame_list() const { return *parse_frame_list(frames); }
FrameRate FarmJob::rate() const { return *parse_frame_rate(fps); }
std::vector<fs::path> FarmJob::files(int64_t frame) const {
  std::vector<fs::path> paths;
  for (const std::string& output : outputs) paths.push_back(work / parse_pattern(output)->name(frame));
  return paths;
}

fs::path FarmJob::work_from_folder() const {
  const fs::path inside = folder.lexically_relative(work);
  if (inside.empty() || *inside.begin() == "..") return work;
  return work.lexically_relative(folder);
}

fs::path farm_job_file(const fs::path& folder) { return folder / "job.json"; }
fs::path farm_records(const fs::path& folder) { return folder / "records"; }

std::string farm_job_json(const FarmJob& job) {
  Json j;
  j["version"] = CANDELA_VERSION;
  j["name"] = job.name;
  j["scene"] = job.scene;
  j["frames"] = job.frames;
  j["fps"] = job.fps;
  j["outputs"] = job.outputs;
  j["video"] = job.video;
  j["audio"] = job.audio;
  j["video_codec"] = job.video_codec;
  j["video_pad"] = job.video_pad;
  j["shards"] = job.shards;
  j["rounds"] = job.rounds;
  j["work"] = job.work_from_folder().string();
  j["program"] = job.program;
  j["arguments"] = job.arguments;
  j["needs"] = {{"cpus", job.needs.cpus},
                {"memory_mb", job.needs.memory_mb},
                {"gpus", job.needs.gpus},
                {"minutes", job.needs.minutes}};
  j["engine_options"] = job.engine_options;
  j["job"] = own_json(job_json(job.job));
  return j.dump(2) + "\n";
}

Expected<FarmJob> read_farm_job(const fs::path& folder) {
  std::error_code failed;
  const fs::path file = farm_job_file(folder);
  if (!fs::exists(file, failed))
    return fail(
        ErrorKind::usage, "DIR",
        "'{}' is not the folder of a farm job: it has no job.json (candela farm shell, make or slurm makes one)",
        folder.string());
  const auto read = read_json_file(file);
  if (!read) return std::unexpected(read.error());
  FarmJob job;
  std::string work;
  Json needs, picture;
  auto good = Members(*read, file.string())
                  .read("name", job.name)
                  .read("scene", job.scene)
                  .read("frames", job.frames)
                  .read("fps", job.fps)
                  .read("outputs", job.outputs)
                  .read("video", job.video)
                  .read("audio", job.audio)
                  .read_where_it_is("video_codec", job.video_codec)
                  .read_where_it_is("video_pad", job.video_pad)
                  .read("shards", job.shards)
                  .read("rounds", job.rounds)
                  .read("work", work)
                  .read("program", job.program)
                  .read("arguments", job.arguments)
                  .read("engine_options", job.engine_options)
                  .read("needs", needs)
                  .read("job", picture)
                  .result();
  if (good)
    good = Members(needs, file.string() + ": /needs")
               .read("cpus", job.needs.cpus)
               .read("memory_mb", job.needs.memory_mb)
               .read("gpus", job.needs.gpus)
               .read("minutes", job.needs.minutes)
               .result();
  if (!good) return std::unexpected(good.error());
  // Where this machine sees them.
  job.folder = fs::absolute(folder).lexically_normal();
  if (!job.folder.has_filename()) job.folder = job.folder.parent_path();
  job.work = (job.folder / work).lexically_normal();
  if (!job.work.has_filename() && job.work.has_relative_path()) job.work = job.work.parent_path();
  const auto decided = job_from_json(picture.dump());
  if (!decided) return std::unexpected(Error{ErrorKind::input, decided.error().message, file.string() + ": /job"});
  job.job = *decided;
  if (auto texts = check_texts(job, file.string()); !texts) return std::unexpected(texts.error());
  return job;
}

Expected<void> write_farm_job(const FarmJob& job) {
  const fs::path file = farm_job_file(job.folder);
  const std::string text = farm_job_json(job);
  std::error_code failed;
  if (fs::exists(file, failed)) {
    const auto there = read_file(file);
    if (!there) return std::unexpected(there.error());
    if (text != std::string_view(reinterpret_cast<const char*>(there->data()), there->size()))
      return fail(ErrorKind::usage, "--job", "'{}' holds another job; name a new folder, or remove that one",
                  job.folder.string());
  }
  for (const char* part : {"logs", "records"}) {
    fs::create_directories(job.folder / part, failed);
    if (failed)
      return fail(ErrorKind::output, (job.folder / part).string(), "cannot make the folder: {}", failed.message());
  }
  return write_file_atomically(file, text);
}

}  // namespace candela
