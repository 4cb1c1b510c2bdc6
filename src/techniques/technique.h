#pragma once
#include <array>
#include <span>
#include <string_view>

#include "graph/builder.h"
#include "passes/pass.h"
#include "passes/scene_inputs.h"
#include "scene/survey.h"

namespace candela {

// A graph under construction, with what passes ask to know whether they are needed.
struct Frame {
  GraphBuilder& builder;
  const SceneFacts& facts;
  const FrameRequest& request;

  // Adds a pass and returns its outputs; empty ones when the pass says it is not needed, or a required input is empty
  // (DESIGN section 4). The reason is kept in the plan.
  template <Pass P>
  typename P::Out add(const P& pass, typename P::In in) {
    if (const Need need = pass.needed(facts, request); !need) {
      builder.leave_out(std::string(P::name), need.reason);
      return {};
    }
    builder.begin_pass(std::string(P::name));
    typename P::Out out = pass.declare(builder, in);
    if (!builder.end_pass([pass, in = std::move(in), out](CommandList& commands) { pass.record(commands, in, out); }))
      return {};
    return out;
  }
};

// Knobs that the job sets, for passes that have them.
struct FrameKnobs {
  bool cull_enabled = true;
};

// How a technique wants the frame's light lists laid out (frame/light_grid.h).
enum class LightGridKind { none, clusters, tiles };

// What a technique leaves: linear radiance (multisampled when the request is), and single-sample layers.
struct FrameImages {
  ImageHandle color;
  std::vector<std::pair<std::string, ImageHandle>> layers;  // by name, those that were wanted
};

using TechniqueFunction = FrameImages (*)(Frame&, const SceneInputs&, const FrameKnobs&);
struct Technique {
  std::string_view name, description;
  TechniqueFunction build;
  LightGridKind light_grid;
};
std::span<const Technique> techniques();

FrameImages forward(Frame& frame, const SceneInputs& scene, const FrameKnobs& knobs);

}  // namespace candela
