#pragma once
#include "passes/debug/dump.h"
#include "passes/debug/layers.h"
#include "passes/debug/light_heat.h"
#include "passes/debug/light_volume_layer.h"
#include "passes/debug/mattes.h"
#include "passes/debug/motion.h"
#include "passes/debug/tree_views.h"
#include "passes/geometry/cull.h"
#include "passes/geometry/cull_compact.h"
#include "passes/geometry/deform.h"
#include "passes/geometry/depth_prepass.h"
#include "passes/geometry/depth_pyramid.h"
#include "passes/geometry/depth_views.h"
#include "passes/geometry/key_depth.h"
#include "passes/geometry/metaballs.h"
#include "passes/geometry/occlusion_cull.h"
#include "passes/geometry/pose_items.h"
#include "passes/geometry/rasterize.h"
#include "passes/geometry/trace_keys.h"
#include "passes/lights/light_assign.h"
#include "passes/lights/light_bounds.h"
#include "passes/lights/light_fill.h"
#include "passes/lights/light_scan.h"
#include "passes/lights/light_sort.h"
#include "passes/lights/light_volumes.h"
#include "passes/lights/pose_lights.h"
#include "passes/lights/tile_depth.h"
#include "passes/occlusion/occlusion.h"
#include "passes/occlusion/occlusion_layer.h"
#include "passes/post/bloom.h"
#include "passes/post/exposure.h"
#include "passes/post/motion_blur.h"
#include "passes/post/pack.h"
#include "passes/post/readback.h"
#include "passes/post/resolve.h"
#include "passes/post/smooth_edges.h"
#include "passes/post/subframes.h"
#include "passes/post/supersample.h"
#include "passes/post/tonemap.h"
#include "passes/reflections/reflections.h"
#include "passes/shadows/light_rays.h"
#include "passes/shadows/light_voxels.h"
#include "passes/shadows/local_layers.h"
#include "passes/shadows/sun_layers.h"
#include "passes/sky/background.h"
#include "passes/sky/sky.h"
#include "passes/surfaces/gbuffer.h"
#include "passes/surfaces/put_samples.h"
#include "passes/surfaces/refraction.h"
#include "passes/surfaces/shade_gbuffer.h"
#include "passes/surfaces/shade_visible.h"
#include "passes/surfaces/shade_volumes.h"
#include "passes/surfaces/surface_pass.h"
#include "passes/surfaces/terms.h"
#include "passes/surfaces/transparent.h"
#include "passes/transparency/colored_shadows.h"
#include "passes/transparency/deep_shadows.h"
#include "passes/transparency/fragments.h"
#include "passes/transparency/moments.h"
#include "passes/transparency/phenomenological.h"
#include "passes/transparency/weighted.h"
#include "passes/volumes/fog.h"
#include "passes/volumes/fog_layers.h"
#include "passes/volumes/fog_march.h"
#include "passes/volumes/volumetric.h"

namespace candela {

template <class... P>
struct PassList {};

// The one list of passes, about in the order of a frame. Names, knob tables, --set, `candela list`, the sweep of errors
// and the layers derive from it (shared/pass_list.h, shared/knob_values.h).
using AllPasses =
    PassList<PoseItems, MetaballPolygons, Cull, CullCompact, Deform, Occluders, DepthPyramid, OcclusionCull, Rasterize,
             RasterizeViews, TraceKeys, BlendedTiles, KeyDepth, DepthPrepass, DepthViews, ColoredShadows, DeepShadows,
             TileDepth, PoseLights, LightBoundsPass, LightAssign, LightScan, LightFill, LightSort, FillLightVoxels,
             LightRays, AmbientOcclusion, FogGrid, FogMarch, ShadeVisible, GBuffer, ShadeGBuffer, LightVolumeLists,
             ShadeVolumes, PutSamples, ShadeForward, ShadeUnlit, Sky, Background, Reflections, ReflectionsOver,
             Refraction, Transparent, Weighted, Moments, Fragments, Phenomenological, Layers, Terms, FogLayers,
             SunLayers, LocalLayers, OcclusionLayer, LightHeat, LightVolumeLayer, TraversalHeat, TreeBoxes, MotionLayer,
             MatteIds, MatteRanks, Supersample, Resolve, VolumetricLight, Subframes, SubframesMean, MotionBlur,
             SmoothEdges, Exposure, BloomPass, Tonemap, Pack, Readback, Dump>;

}  // namespace candela
