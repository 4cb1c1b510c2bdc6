#include "render/cryptomatte.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/hash.h"
#include "render/metadata.h"
#include "scene/matte_names.h"

namespace candela {
namespace {

// Names with places that something could be drawn with.
std::vector<std::string> manifest_names(const Scene& scene, const std::string& layer) {
  if (layer == "crypto_material") return material_names(scene);
  std::vector<std::string> names;
  const std::vector<std::string> all = node_names(scene);
  for (size_t n = 0; n < all.size(); ++n)
    if (scene.nodes[n].mesh >= 0) names.push_back(all[n]);
  return names;
}

}  // namespace

bool is_cryptomatte(const std::string& layer) { return layer == "crypto_object" || layer == "crypto_material"; }

std::vector<std::string> matte_channels(const std::string& layer, uint32_t level) {
  std::vector<std::string> names;
  for (const char channel : {'R', 'G', 'B', 'A'}) names.push_back(fmt::format("{}{:02}.{}", layer, level, channel));
  return names;
}

void add_cryptomatte(std::vector<MetadataEntry>& metadata, const Scene& scene, const std::string& layer) {
  nlohmann::ordered_json manifest = nlohmann::ordered_json::object();
  // Names are unique: appended, for a look-up of each among those before it would take their square.
  auto& entries = manifest.get_ref<nlohmann::ordered_json::object_t&>();
  for (const std::string& name : manifest_names(scene, layer))
    entries.emplace_back(name, fmt::format("{:08x}", matte_id(name)));
  const std::string key = "cryptomatte/" + fmt::format("{:08x}", hash32(layer)).substr(0, 7) + "/";
  const auto add = [&](const std::string& name, std::string text) {
    metadata.push_back(text_entry((key + name).c_str(), std::move(text)));
  };
  add("name", layer);
  add("hash", "MurmurHash3_32");
  add("conversion", "uint32_to_float32");
  add("manifest", manifest.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace candela
