#include "gpu_fixture.h"

namespace candela::gpu::test {

class Frame : public GpuTest {};

TEST_F(Frame, ReadsBackWhatAComputePassWrote) {
  GraphBuilder builder;
  const BufferHandle bytes = add_readback(builder, "image", add_fill(builder, "image", 13, 7, 2.5f), 13 * 7 * 16);
  const CompiledGraph graph = compile_graph(builder);
  for (const bool timed : {false, true}) {
    const FrameRun result = run(graph, {.timed = timed});
    ASSERT_TRUE(result.readbacks.contains(bytes.resource));
    const auto values = values_of<float>(*result.readbacks.at(bytes.resource));
    ASSERT_EQ(values.size(), 13u * 7 * 4);
    for (uint32_t y = 0; y < 7; ++y)
      for (uint32_t x = 0; x < 13; ++x) {
        const float* texel = &values[(y * 13 + x) * 4];
        EXPECT_EQ(texel[0], 2.5f);
        EXPECT_EQ(texel[1], float(x));
        EXPECT_EQ(texel[2], float(y));
      }
    EXPECT_EQ(result.passes.size(), timed ? 2u : 0u);
  }
}

}  // namespace candela::gpu::test
