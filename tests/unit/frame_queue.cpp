#include <gtest/gtest.h>

#include "techniques/frame.h"

namespace candela {
namespace {

struct Made {
  BufferHandle buffer;
};

// A pass without a mark and one with.
struct Plain {
  static constexpr std::string_view name = "plain";
  struct In {};
  using Out = Made;
  Need needed(const SceneFacts&, const FrameRequest&) const { return {}; }
  Out declare(GraphBuilder& builder, const In&) const {
    return {builder.write(builder.create(BufferDesc{.name = "made", .size_bytes = 4}), Access::compute_write)};
  }
  void record(CommandList&, const In&, const Out&) const {}
};
struct Marked : Plain {
  static constexpr std::string_view name = "marked";
  static constexpr Queue queue = Queue::compute;
};

TEST(FrameQueue, AMarkedPassGoesToTheComputeQueue) {
  GraphBuilder builder;
  const SceneFacts facts;
  const FrameRequest request;
  const KnobValues knobs;
  Frame frame{builder, facts, request, knobs, {}, {}};
  builder.sink(frame.add(Plain{}, {}).buffer);
  builder.sink(frame.add(Marked{}, {}).buffer);
  const FramePlan plan = compile_graph(builder).plan;
  ASSERT_EQ(plan.passes.size(), 2u);
  EXPECT_EQ(plan.passes[0].queue, Queue::main);
  EXPECT_EQ(plan.passes[1].queue, Queue::compute);
  EXPECT_EQ(plan.batches.size(), 2u);
}

}  // namespace
}  // namespace candela
