#include "render/id_names.h"

#include <fmt/format.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "render/metadata.h"
#include "scene/matte_names.h"

namespace candela {
namespace {

std::set<uint32_t> ids_in(const PlaneView& plane, int width, int height) {
  std::set<uint32_t> ids;
  uint32_t last = ~0u;
  for (size_t y = 0; y < size_t(height); ++y)
    for (size_t x = 0; x < size_t(width); ++x) {
      uint32_t id = 0;
      std::memcpy(&id, plane.data + y * plane.row_bytes + x * sizeof id, sizeof id);
      if (id != last) ids.insert(id);
      last = id;
    }
  return ids;
}

}  // namespace

void add_id_names(std::vector<MetadataEntry>& metadata, const Scene& scene, const PlaneView& plane, int width,
                  int height) {
  const bool objects = plane.name == "object_id.X";
  if (!objects && plane.name != "material_id.X") return;
  const std::vector<std::string> names = objects ? node_names(scene) : material_names(scene);
  nlohmann::ordered_json j = nlohmann::ordered_json::object();
  auto& entries = j.get_ref<nlohmann::ordered_json::object_t&>();  // each id is there once: appended
  for (const uint32_t id : ids_in(plane, width, height))
    if (id < names.size()) entries.emplace_back(fmt::format("{}", id), names[id]);
  metadata.push_back(text_entry(objects ? "candela:object_id" : "candela:material_id",
                                j.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)));
}

void add_id_names(FloatImage& image, const Scene& scene) {
  for (const Channel& channel : image.channels)
    if (channel.type == ChannelType::uint32)
      add_id_names(image.metadata, scene,
                   {channel.name, channel.type, reinterpret_cast<const std::byte*>(channel.u.data()),
                    size_t(image.width) * sizeof(uint32_t)},
                   image.width, image.height);
}

}  // namespace candela
