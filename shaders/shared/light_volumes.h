#ifndef CANDELA_SHARED_LIGHT_VOLUMES_H
#define CANDELA_SHARED_LIGHT_VOLUMES_H
#include "shared/types.h"
SHARED_BEGIN
struct VolumeDraw {  // VkDrawIndirectCommand
  uint vertex_count, instance_count, first_vertex, first_instance;
};
struct VolumeDraws {
  VolumeDraw draw[3];  // of each list
  uint count[3];       // 1, or 0 where it is empty
};
struct LightVolumesPush {
  uint64_t lights;
  uint64_t masks;   // of each group of lights and each list 8 words, a bit a light
  uint64_t counts;  // the same: how many
  uint64_t draws;   // VolumeDraws
  uint64_t lists;   // of each list the lights in ascending order, light_count places
  uint group_count;
};
SHARED_END

#ifdef __cplusplus
namespace candela::shared {
enum : uint { volumes_everywhere = 0, volumes_outside = 1, volumes_inside = 2, volume_lists = 3 };
inline constexpr uint light_volumes_group = 256;
static_assert(sizeof(VolumeDraw) == 16 && sizeof(VolumeDraws) == 60);
}  // namespace candela::shared
#else
// Lights that reach everywhere; those whose volume the camera is outside of; and inside of.
const uint volumes_everywhere = 0u, volumes_outside = 1u, volumes_inside = 2u, volume_lists = 3u;
const uint light_volumes_group = 256u, light_volumes_words = 8u;
const uint volume_vertices = 60u;  // of 20 triangles (lib/light_volume.glsl)
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer VolumeDrawsRef { VolumeDraws v; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer VolumeWordsRef { uint w[]; };
#endif
#endif
