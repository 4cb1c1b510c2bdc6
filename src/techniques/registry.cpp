#include "passes/shared/light_lists.h"
#include "passes/shared/pass.h"
#include "passes/shared/pass_list.h"
#include "techniques/technique.h"

namespace candela {

std::span<const Technique> techniques() {
  static const KnobSetting rays[] = {{"sun", "mode", "traced"},
                                     {"local", "method", "traced"},
                                     {"occlusion", "method", "rays"},
                                     {"reflections", "method", "traced"}};
  static const Technique table[] = {
      {"clustered", "forward shading, lights listed by tile and depth slice", forward, LightGridKind::clusters},
      {"forward-plus", "forward shading, lights listed by 16x16 tiles between the depths of their samples", forward,
       LightGridKind::tiles},
      {"brute-force", "forward shading, every light for every pixel: correct first, and the yardstick", forward,
       LightGridKind::none},
      {"visibility", "triangles rasterized in compute, each visible one of a pixel shaded once; lights as clustered",
       visibility, LightGridKind::clusters, Technique::Keys::rasterized},
      {"hybrid", "visibility, with shadows, ambient occlusion and reflections by rays", visibility,
       LightGridKind::clusters, Technique::Keys::rasterized, rays},
      {"ray", "what the camera sees, shadows, occlusion and reflections by rays, shaded as visibility", visibility,
       LightGridKind::clusters, Technique::Keys::traced, rays},
      {"deferred-clustered", "surfaces into a G-buffer, shaded in compute; lights as clustered", deferred,
       LightGridKind::clusters},
      {"deferred-tiled", "surfaces into a G-buffer, shaded in compute; lights as forward-plus", deferred,
       LightGridKind::tiles},
      {"deferred-volumes", "surfaces into a G-buffer, each light drawn as the volume that it reaches", deferred_volumes,
       LightGridKind::none},
  };
  return table;
}

LayerForm layer_form(std::string_view layer) {
  for (const PassInfo& pass : pass_list())
    for (const LayerName& name : pass.layers)
      if (name.name == layer) return name.form;
  return LayerForm::light;
}

}  // namespace candela
