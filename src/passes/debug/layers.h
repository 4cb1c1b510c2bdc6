#pragma once
#include <array>

#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"

namespace candela {

// The layers beside beauty, in the order of shaders/layers.frag's outputs.
enum class Layer : uint32_t { depth, normal, albedo, object_id, material_id, direct };
inline constexpr uint32_t layer_count = 6;

// Depth (metres along the view axis), world normal, base colour, ids and direct light of the nearest opaque or masked
// surface, one sample at the pixel's centre: averaged ids and depths would name surfaces that do not exist. Blended
// surfaces do not appear. Background: depth 1e10, ids 0xffffffff, everything else 0.
struct Layers {
  static constexpr std::string_view name = "layers";
  using SharedKnobs = std::tuple<TextureKnobs, ReliefKnobs>;
  static constexpr LayerName layers[layer_count] = {
      {"depth", "metres along the view axis; 1e10 where there is nothing", LayerForm::distance},
      {"normal", "world-space shading normal", LayerForm::direction},
      {"albedo", "base colour", LayerForm::color},
      {"object_id", "index of the glTF node", LayerForm::id},
      {"material_id", "index into glTF's materials", LayerForm::id},
      {"direct", "light from the scene's lights alone"}};
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;  // optional
    Lighting lists;         // empty: every light for every pixel
    std::array<bool, layer_count> wanted{};
  };
  struct Out {
    std::array<ImageHandle, layer_count> images;  // empty where not wanted
    NearestSurface drawn;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
