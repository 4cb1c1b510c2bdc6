#pragma once
#include <tuple>

namespace candela {

// Tables of knobs by name alone, for what one pass hands to another: a type in a pass's In names in `MadeBy` the tables
// that its content follows from, and a pass that is handed plain buffers and images names them in `InputKnobs`
// (passes/shared/pass.h).
struct BvhKnobs;
struct ColoredShadowKnobs;
struct CullKnobs;
struct DeepShadowKnobs;
struct FogKnobs;
struct GBufferKnobs;
struct IblKnobs;
struct LampKnobs;
struct LightKnobs;
struct LightRangeKnobs;
struct LightRayKnobs;
struct LightVolumeKnobs;
struct LightVoxelKnobs;
struct MaskKnobs;
struct OcclusionCullKnobs;
struct OcclusionKnobs;
struct ProbeKnobs;
struct ReflectionKnobs;
struct RefractionKnobs;
struct ReliefKnobs;
struct ResolveKnobs;
struct SunKnobs;
struct SupersampleKnobs;
struct SurfaceKnobs;
struct TextureKnobs;

// How many samples a pixel has, and how many pictures a frame is the mean of.
using SampleCountKnobs = std::tuple<ResolveKnobs, SupersampleKnobs>;
// Which items are drawn.
using DrawnItemKnobs = std::tuple<CullKnobs, OcclusionCullKnobs>;

}  // namespace candela
