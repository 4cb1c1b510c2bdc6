#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"

namespace candela {

// What Cryptomatte layers tell apart (Friedman, Jones, "Fully automatic ID mattes with support for motion blur and
// transparency", 2015): objects are glTF's nodes.
enum class Matte : uint32_t { object, material };
inline constexpr uint32_t matte_count = 2;
inline constexpr LayerName matte_layers[matte_count] = {
    {"crypto_object", "Cryptomatte: coverage by object, as pairs of id and share of the pixel's samples",
     LayerForm::matte},
    {"crypto_material", "Cryptomatte: the same by material", LayerForm::matte}};

// The id (scene/matte_names.h) of the opaque or masked surface that beauty shows at each of its samples, as the bits of
// a float, 0 where there is none. Blended surfaces do not count. Tested against beauty's depth: coverage is beauty's.
struct MatteIds {
  static constexpr std::string_view name = "matte_ids";
  using InputKnobs = SampleCountKnobs;
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;  // optional
    ImageHandle depth;      // optional: nothing is opaque or masked without it
    ImageHandle ids;        // optional: of the pictures of a supersampled frame before this one
  };
  struct Out {
    ImageHandle ids;  // multisampled, or a layer for each picture of a supersampled frame
    BatchPipelines pipelines;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Matte matte = Matte::object;
};

// Ids by their fraction of a pixel's samples, which is exact in steps of one sample: rank 0 is the largest, of equal
// ones the lower id. Two ranks an image. With as many ranks as samples nothing is lost; where fewer lose something it
// is a warning.
struct MatteRanks {
  static constexpr std::string_view name = "matte_ranks";
  struct Knobs {
    static constexpr std::string_view name = "cryptomatte";
    int ranks = 6;
    static std::span<const Knob> table();
  };
  static constexpr std::span<const LayerName> layers = matte_layers;
  struct In {
    ImageHandle ids;
    uint32_t width_px = 0, height_px = 0;
    uint32_t samples = 1;       // a pixel, of all pictures
    bool multisampled = false;  // else a layer for each sample
  };
  struct Report {
    uint32_t pixels, most;  // pixels with more ids than ranks, the most ids of a pixel
  };
  struct Out {
    std::vector<ImageHandle> levels;  // id, coverage, id, coverage
    BufferHandle report;              // empty where there are ranks for all
    PipelineHandle pipeline;
  };
  std::vector<std::string> warnings(const Report& report) const;
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  uint32_t ranks(const In& in) const { return std::min(uint32_t(knobs.ranks), in.samples); }
  Knobs knobs;
  Matte matte = Matte::object;
};

}  // namespace candela
