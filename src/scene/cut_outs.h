#pragma once
#include <string>
#include <vector>

#include "scene/scene.h"

namespace candela {

// Blended materials whose surfaces hide all or nothing: their alpha, by factor, texture and corners, is nowhere more
// than 1/255 from 0 or 1, and no animation moves it. Exporters write many cut-outs so, leaves and fences. Decodes the
// textures; one that cannot be read makes none.
std::vector<uint32_t> cut_out_materials(const Scene& scene);

// How those are drawn (--cut-outs).
const std::vector<std::string>& cut_out_choices();
// blended: as the file says. masked: as masks with a cutoff of a half, which need no order, hide what is behind them
// from the depth pre-pass on and cast shadows of their shape; edges, which blending smooths over a texel, are hard.
void apply_cut_outs(Scene& scene, const std::string& choice);

}  // namespace candela
