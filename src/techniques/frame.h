#pragma once
#include <cstring>
#include <functional>
#include <map>
#include <optional>
#include <span>

#include "base/fields.h"
#include "passes/post/pack.h"
#include "passes/shared/frame_values.h"
#include "passes/shared/knob_values.h"
#include "passes/shared/pass.h"

namespace candela {

// An image that the frame gives to the host, in a buffer of rows from the top: tightly packed texels, or as files hold
// it (pack_layout).
struct FrameOutput {
  std::string layer;  // "beauty" (linear, pre-exposed, premultiplied alpha), "display" (tone-mapped), "depth", ...
  uint32_t part = 0;  // of a layer of several images, in their order: a level of Cryptomatte
  VkFormat format = VK_FORMAT_UNDEFINED;
  int resource = -1;  // the buffer in the plan; none of what is only looked at
  Packing packing = Packing::texels;
  int counts = -1;                // place among what Pack counted
  uint32_t components = 4;        // that a file stores, from red on
  bool exact = false;             // 32-bit floats, whatever the job's colours are stored as
  bool carries_exposure = false;  // values grow with the light and thus have the pre-exposure; alpha has not
};

// What a pass counted, by the buffer in the plan, and how to say it.
struct FrameReport {
  int resource = -1;
  std::function<std::vector<std::string>(std::span<const std::byte>)> warnings, notes;
  std::function<std::string(std::span<const std::byte>)> refusal = {};
  std::function<std::vector<KnobSetting>(std::span<const std::byte>)> enlarged = {};
};

// Of the pictures that a frame is made of, the one that reasons are given with.
inline bool is_first_picture(std::string_view instance) { return instance.empty() || instance == "s00"; }

// A graph under construction, with what passes ask to know whether they are needed, and what the frame gives.
struct Frame {
  GraphBuilder& builder;
  const SceneFacts& facts;
  const FrameRequest& request;
  const KnobValues& knobs;
  std::vector<FrameOutput> outputs;
  std::vector<FrameReport> reports;
  // Called behind each pass that is added, with its instance's name: what looks at a frame without being part of it.
  std::function<void(Frame&, const std::string&)> observe = {};
  int counts = -1;                                // the buffer of shared::PackCounts in the plan
  const FrameValues& values = FrameValues::none;  // for recording alone

  // Adds a pass and returns its outputs; empty ones, which carry the reason, when the pass says it is not needed or a
  // required input is empty (docs/building/design.md, "Leaving out"). A pass that stands in the frame several times has
  // an instance's name.
  template <Pass P>
  typename P::Out add(P pass, typename P::In in, std::string_view instance = {}) {
    std::string name(P::name);
    if (!instance.empty()) name.append(".").append(instance);
    if constexpr (HasKnobs<P>) pass.knobs = knobs.get<typename P::Knobs>();
    if (const Need need = pass.needed(facts, request); !need)
      return absent<typename P::Out>(builder.leave_out(name, need.reason));
    if constexpr (ChoosesQueue<P>)
      builder.begin_pass(name, P::queue);
    else
      builder.begin_pass(name);
    knobs.declare(builder, own_knob_tables<P>(), facts, [&](std::string_view knob) {
      if constexpr (IgnoresKnobs<P>) return pass.ignores(knob);
      return false;
    });
    typename P::Out out = pass.declare(builder, in);
    if (!builder.end_pass([pass, in = std::move(in), out](CommandList& commands) { pass.record(commands, in, out); }))
      return absent<typename P::Out>(builder.last_absence());
    if constexpr (Reports<P>)
      if (out.report) reports.push_back(report_of(pass, out.report));
    if (observe) observe(*this, name);
    return out;
  }

 private:
  template <class P>
  static FrameReport report_of(const P& pass, BufferHandle buffer) {
    const auto read = [](std::span<const std::byte> bytes) {
      typename P::Report report;
      std::memcpy(&report, bytes.data(), sizeof report);
      return report;
    };
    FrameReport result{buffer.resource, [pass, read](auto bytes) { return pass.warnings(read(bytes)); }, {}};
    if constexpr (ReportsNotes<P>) result.notes = [pass, read](auto bytes) { return pass.notes(read(bytes)); };
    if constexpr (Refuses<P>) result.refusal = [pass, read](auto bytes) { return pass.refusal(read(bytes)); };
    if constexpr (Enlarges<P>) result.enlarged = [pass, read](auto bytes) { return pass.enlarged(read(bytes)); };
    return result;
  }
  template <class T>
  static T absent(int reason) {
    T value{};
    mark(value, reason);
    return value;
  }
  template <class T>
  static void mark(T& value, int reason) {
    if constexpr (std::is_same_v<T, ImageHandle> || std::is_same_v<T, BufferHandle>)
      value.absence = reason;
    else if constexpr (requires { std::tuple_size<T>::value; })
      for (auto& each : value) mark(each, reason);
    else if constexpr (std::is_aggregate_v<T> && std::is_class_v<T>)
      for_each_field(value, [&](auto& field) { mark(field, reason); });
  }
};

}  // namespace candela
