#pragma once
#include <type_traits>

#include "base/fields.h"
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
#include "passes/post/pack.h"
#include "passes/post/readback.h"
#include "passes/post/resolve.h"
#include "passes/post/supersample.h"
#include "passes/post/tonemap.h"
#include "passes/reflections/reflections.h"
#include "passes/shadows/lamp_layers.h"
#include "passes/shadows/light_voxels.h"
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
struct PassList {
  // f(std::type_identity<P>{}) for every pass.
  template <class F>
  static void each(F&& f) {
    (f(std::type_identity<P>{}), ...);
  }
};

// The one list of passes, about in the order of a frame. Names, knob tables, --set, `candela list`, the sweep of errors
// and the layers derive from it.
using AllPasses =
    PassList<PoseItems, Cull, CullCompact, Deform, Occluders, DepthPyramid, OcclusionCull, Rasterize, RasterizeViews,
             TraceKeys, BlendedTiles, KeyDepth, DepthPrepass, DepthViews, ColoredShadows, TileDepth, PoseLights,
             LightBoundsPass, LightAssign, LightScan, LightFill, LightSort, FillLightVoxels, AmbientOcclusion, FogGrid,
             FogMarch, ShadeVisible, GBuffer, ShadeGBuffer, LightVolumeLists, ShadeVolumes, PutSamples, ShadeForward,
             ShadeUnlit, Sky, Background, Reflections, ReflectionsOver, Refraction, Transparent, Weighted, Moments,
             Fragments, Phenomenological, Layers, Terms, FogLayers, SunLayers, LampLayers, OcclusionLayer, LightHeat,
             LightVolumeLayer, TraversalHeat, TreeBoxes, MotionLayer, MatteIds, MatteRanks, Supersample, Resolve,
             VolumetricLight, Exposure, BloomPass, Tonemap, Pack, Readback, Dump>;

namespace knobs_detail {
template <class Tuple, class K>
struct Append;
template <class... Ks, class K>
struct Append<std::tuple<Ks...>, K> {
  using type = std::conditional_t<(std::is_same_v<Ks, K> || ...), std::tuple<Ks...>, std::tuple<Ks..., K>>;
};
template <class Tuple, class More>
struct AppendAll {
  using type = Tuple;
};
template <class Tuple, class K, class... More>
struct AppendAll<Tuple, std::tuple<K, More...>> : AppendAll<typename Append<Tuple, K>::type, std::tuple<More...>> {};

template <class P>
auto tables_of() {
  if constexpr (HasKnobs<P> && SharesKnobs<P>)
    return typename AppendAll<std::tuple<typename P::Knobs>, typename P::SharedKnobs>::type{};
  else if constexpr (HasKnobs<P>)
    return std::tuple<typename P::Knobs>{};
  else if constexpr (SharesKnobs<P>)
    return typename P::SharedKnobs{};
  else
    return std::tuple<>{};
}

template <class Tuple, class... P>
struct Collect {
  using type = Tuple;
};
template <class Tuple, class P, class... More>
struct Collect<Tuple, P, More...> : Collect<typename AppendAll<Tuple, decltype(tables_of<P>())>::type, More...> {};
template <class List>
struct TablesOf;
template <class... P>
struct TablesOf<PassList<P...>> : Collect<std::tuple<>, P...> {};

template <class Tuple, class K>
struct Holds;
template <class... Ks, class K>
struct Holds<std::tuple<Ks...>, K> : std::disjunction<std::is_same<Ks, K>...> {};
}  // namespace knobs_detail

// Whether knobs of the table K change a pass's work: it is its own or shared, or what the pass is handed follows from
// it.
template <class P, class K>
bool follows() {
  using knobs_detail::Holds;
  bool yes = Holds<decltype(knobs_detail::tables_of<P>()), K>::value;
  if constexpr (FollowsKnobs<P>) yes = yes || Holds<typename P::InputKnobs, K>::value;
  typename P::In in{};
  for_each_field(in, [&]<class T>(const T&) {
    if constexpr (requires { typename T::MadeBy; }) yes = yes || Holds<typename T::MadeBy, K>::value;
  });
  return yes;
}
// Their names, in the order of the list.
template <class K>
std::vector<std::string> passes_of_table() {
  std::vector<std::string> names;
  AllPasses::each([&]<class P>(std::type_identity<P>) {
    if (follows<P, K>()) names.emplace_back(P::name);
  });
  return names;
}

// One value of every knob table that some pass has or shares.
class KnobValues {
 public:
  template <class K>
  const K& get() const {
    return std::get<K>(tables_);
  }
  template <class K>
  K& get() {
    return std::get<K>(tables_);
  }
  // f(table's name, row, its struct) for every knob.
  template <class F>
  void each(F&& f) {
    const auto table = [&]<class K>(K& knobs) {
      for (const Knob<K>& row : K::table()) f(K::name, row, knobs);
    };
    std::apply([&](auto&... knobs) { (table(knobs), ...); }, tables_);
  }
  // Tells an open pass of the builder the values that it works with. A table may say that it does nothing in a scene.
  template <class P>
  void declare(GraphBuilder& builder, const P& pass, const SceneFacts& facts) const {
    const auto table = [&]<class K>(const K&) {
      if constexpr (requires { K::matter(facts); })
        if (!K::matter(facts)) return;
      for (const Knob<K>& row : K::table()) {
        if constexpr (IgnoresKnobs<P>)
          if (pass.ignores(row.name)) continue;
        builder.knob(std::string(K::name) + "." + std::string(row.name), row.text(row.value(get<K>())));
      }
    };
    std::apply([&](const auto&... knobs) { (table(knobs), ...); }, knobs_detail::tables_of<P>());
  }

 private:
  knobs_detail::TablesOf<AllPasses>::type tables_;
};

}  // namespace candela
