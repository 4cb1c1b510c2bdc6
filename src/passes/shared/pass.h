#pragma once
#include <concepts>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "base/knob.h"
#include "gpu/command_list.h"
#include "graph/builder.h"
#include "passes/shared/frame_request.h"
#include "passes/shared/knob_tables.h"
#include "scene/survey.h"

namespace candela {

// Whether a frame needs a pass; if not, the reason as a user understands it ("the scene has no blended material").
class Reason {
 public:
  Reason() = default;
  Reason(const char* literal) : literal_(literal) {}
  Reason(std::string text) : text_(std::move(text)) {}
  bool empty() const { return literal_.empty() && text_.empty(); }
  operator std::string() const { return literal_.empty() ? text_ : std::string(literal_); }

 private:
  std::string_view literal_;  // which is not copied: passes are asked often
  std::string text_;
};
struct Need {
  bool yes = true;
  Reason reason;
  explicit operator bool() const { return yes; }
};
inline Need needed_if(bool condition, Reason otherwise) {
  return condition ? Need{} : Need{false, std::move(otherwise)};
}

inline Need needed_for_solid_surfaces(const SceneFacts& facts) {
  return needed_if(facts.lit_items + facts.unlit_items > 0, "the scene has no opaque or masked surface");
}

// docs/building/design.md, "A pass". No base class: a pass is a plain struct of this shape.
template <class P>
concept Pass = requires(const P pass, const SceneFacts& facts, const FrameRequest& request, GraphBuilder& builder,
                        const typename P::In& in, const typename P::Out& out, CommandList& commands) {
  { P::name } -> std::convertible_to<std::string_view>;
  { pass.needed(facts, request) } -> std::same_as<Need>;
  { pass.declare(builder, in) } -> std::same_as<typename P::Out>;
  { pass.record(commands, in, out) } -> std::same_as<void>;
};

// Optional parts of a pass.

// Knobs of its own, in the member `knobs`, which the frame fills in before it asks anything of the pass.
template <class P>
concept HasKnobs = requires(P pass) {
  requires KnobTable<typename P::Knobs>;
  { pass.knobs } -> std::convertible_to<typename P::Knobs>;
};
// Knobs of other tables that change its work on other ways than by a member: std::tuple of the tables.
template <class P>
concept SharesKnobs = requires {
  std::tuple_size<typename P::SharedKnobs>::value;
};

// Tables of passes before it, whose knobs change its work by the plain buffers and images that it is handed; what In
// holds of other types says so itself (`MadeBy`, passes/shared/knob_tables.h). The plan has their values where those
// passes stand.
template <class P>
concept FollowsKnobs = requires {
  std::tuple_size<typename P::InputKnobs>::value;
};

// Knobs of its tables that do nothing in this frame (tile sizes where there are no tiles): they are not among the
// plan's, so that equal work is one plan.
template <class P>
concept IgnoresKnobs = requires(const P pass) {
  { pass.ignores(std::string_view{}) } -> std::same_as<bool>;
};

// A queue of its own: Queue::compute runs beside the drawing where the device has a second queue (graph/queues.h).
template <class P>
concept ChoosesQueue = requires {
  { P::queue } -> std::convertible_to<Queue>;
};

// What the values of a layer are, which says how PNG and video show them (--view).
enum class LayerForm : uint8_t {
  light,      // radiance: through exposure and tone curve, as beauty
  color,      // linear, 0 to 1 in each channel
  fraction,   // 0 to 1
  count,      // whole numbers
  distance,   // metres; background_depth_m where there is nothing
  direction,  // unit vectors; 0 where there is nothing
  id,         // 32-bit whole numbers, 2^32-1 where there is nothing
  matte,      // pairs of an id, as bits of a float, and its fraction of the pixel
  motion,     // pixels, x to the right, y up
};
// Layers that it can give (--layers): it publishes their images in declare().
struct LayerName {
  std::string_view name;
  std::string_view description;  // one line
  LayerForm form = LayerForm::light;
};
template <class P>
concept HasLayers = requires {
  {std::span<const LayerName>(P::layers)};
};

// An effect, which --effects can leave out or ask for by this name. Several passes may be parts of one.
template <class P>
concept IsEffect = requires {
  { P::effect } -> std::convertible_to<std::string_view>;
};

// Effects that are no passes but other ways of its shading.
template <class P>
concept ShadesEffect = requires {
  {std::span<const std::string_view>(P::shading_effects)};
};

// Numbers that it counts for the host: Report is a struct of 32-bit words, Out::report a buffer of its size with memory
// host_read, which the pass also makes a sink; empty where there is nothing to count. warnings() says what a user must
// know of it.
template <class P>
concept Reports = requires(const P pass, const typename P::Out out, const typename P::Report& report) {
  { out.report } -> std::convertible_to<BufferHandle>;
  { pass.warnings(report) } -> std::same_as<std::vector<std::string>>;
};
// The same with why the picture is not to be had: empty where it is.
template <class P>
concept Refuses = requires(const P pass, const typename P::Report& report) {
  { pass.refusal(report) } -> std::same_as<std::string>;
};
// The same with knobs under which it is to be had; empty: none.
template <class P>
concept Enlarges = requires(const P pass, const typename P::Report& report) {
  { pass.enlarged(report) } -> std::same_as<std::vector<KnobSetting>>;
};
// The same with what is worth telling, but no cause for concern.
template <class P>
concept ReportsNotes = requires(const P pass, const typename P::Report& report) {
  { pass.notes(report) } -> std::same_as<std::vector<std::string>>;
};

}  // namespace candela
