#pragma once
#include <concepts>
#include <span>
#include <string>
#include <string_view>

#include "base/knob.h"
#include "gpu/command_list.h"
#include "graph/builder.h"
#include "scene/survey.h"

namespace candela {

// Whether a frame needs a pass; if not, the reason as a user understands it ("the scene has no blended material").
struct Need {
  bool yes = true;
  std::string reason;
  explicit operator bool() const { return yes; }
};
inline Need needed_if(bool condition, std::string_view otherwise) {
  return condition ? Need{} : Need{false, std::string(otherwise)};
}

// DESIGN section 3. No base class: a pass is a plain struct of this shape.
template <class P>
concept Pass = requires(const P pass, const SceneFacts& facts, const FrameRequest& request, GraphBuilder& builder,
                        const typename P::In& in, const typename P::Out& out, CommandList& commands) {
  { P::name } -> std::convertible_to<std::string_view>;
  { pass.needed(facts, request) } -> std::same_as<Need>;
  { pass.declare(builder, in) } -> std::same_as<typename P::Out>;
  { pass.record(commands, in, out) } -> std::same_as<void>;
};

}  // namespace candela
