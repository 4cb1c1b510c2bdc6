#include "frame/caster_hash.h"

#include <cstring>

#include "frame/frame_views.h"
#include "scene/glow.h"

namespace candela {
namespace {

// Bytes of what is laid out for the device, which has no padding, and of single numbers.
class Bytes {
 public:
  template <class T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= 8);
    const size_t at = bytes_.size();
    bytes_.resize(at + sizeof(T));
    std::memcpy(bytes_.data() + at, &value, sizeof(T));
  }
  Hash128 hash() const { return hash128(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

void add_mask(const Material& m, Bytes& out) {
  out.add(m.base_color.w);
  out.add(m.alpha_cutoff);
  const TextureSlot& slot = m.base_color_texture;
  out.add(slot.image);
  out.add(slot.sampler);
  out.add(slot.uv_set);
  out.add(slot.offset);
  out.add(slot.scale);
  out.add(slot.rotation_rad);
}

}  // namespace

std::optional<Hash128> caster_hash(const DrawList& draws, const FrameUpload& upload, const Pose& pose,
                                   const TextureKnobs& textures) {
  Bytes out;
  for (const DrawRun& run : draws.runs) {
    if (!casts_shadows(run)) continue;
    out.add(uint32_t(run.alpha));
    out.add(run.count);
    for (uint32_t i = run.first; i < run.first + run.count; ++i) {
      const shared::Item& item = upload.items[i];
      const shared::Geometry& geometry = upload.geometries[item.geometry];
      if (geometry.flags & shared::geometry_deformed) return std::nullopt;
      out.add(item.bounds_centre);
      out.add(item.bounds_extent);
      out.add(upload.transforms[item.transform]);
      out.add(geometry);
      out.add(item.first_index);
      out.add(item.index_count);
      const Material material = item.material < pose.materials.size() ? pose.materials[item.material] : Material{};
      out.add(uint32_t(glows_all_over(material)));
      if (run.alpha == AlphaMode::mask) add_mask(material, out);
    }
  }
  for (const Knob<TextureKnobs>& row : TextureKnobs::table()) out.add(row.value(textures));
  return out.hash();
}

Hash128 depth_views_key(const Hash128& casters, const ViewImage& image) {
  Bytes out;
  out.add(casters);
  out.add(hash128(image.name));
  out.add(image.size_px);
  out.add(image.layers);
  for (const shared::View& view : image.views) out.add(view);
  return out.hash();
}

}  // namespace candela
