#include "gpu_fixture.h"
#include "shared/cull.h"
#include "shared/deform.h"
#include "shared/scene.h"

namespace candela::gpu::test {

struct SharedStruct {
  const char* name;
  uint32_t kind;   // as round_trip.comp numbers them
  size_t size;     // of an element in an array
  size_t members;  // bytes that belong to members
};

class RoundTrip : public GpuTest, public ::testing::WithParamInterface<SharedStruct> {};

// Every word of element 1 has a value of its own, so a member that GLSL expects elsewhere, or another stride, shows.
TEST_P(RoundTrip, GlslReadsTheBytesThatCppWrote) {
  const SharedStruct shape = GetParam();
  std::vector<uint32_t> words(2 * shape.size / 4);
  for (size_t i = 0; i < words.size(); ++i) words[i] = 0x3f000000u + uint32_t(i);  // normal floats
  Buffer source(*device, words.size() * 4,
                VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT, Buffer::Memory::upload,
                Device::Purpose::scene, "source");
  std::memcpy(source.mapped(), words.data(), words.size() * 4);

  GraphBuilder builder;
  const BufferHandle in = builder.import_buffer(BufferDesc{.name = "source", .size_bytes = words.size() * 4});
  builder.begin_pass("round trip");
  builder.read(in, Access::compute_read, "source");
  BufferHandle out =
      builder.create(BufferDesc{.name = "target", .size_bytes = shape.size, .memory = BufferMemory::host_read});
  out = builder.write(out, Access::compute_write);
  const PipelineHandle pipeline =
      builder.pipeline(ComputePipelineDesc{.shader = "round_trip.comp", .constants = {{0, "kind", shape.kind}}});
  builder.end_pass([=](CommandList& commands) {
    commands.bind(pipeline);
    const std::array<uint64_t, 2> push{commands.address(in), commands.address(out)};
    commands.push(push);
    commands.dispatch(1);
  });
  builder.sink(out);
  const FrameRun result = run(compile_graph(builder), {}, {{in.resource, &source}});
  ASSERT_TRUE(result.readbacks.contains(out.resource));
  const auto read = values_of<uint32_t>(*result.readbacks.at(out.resource));
  for (size_t i = 0; i < shape.members / 4; ++i) EXPECT_EQ(read[i], words[shape.size / 4 + i]) << "word " << i;
}

template <class T>
constexpr SharedStruct shape(const char* name, uint32_t kind, size_t members = sizeof(T)) {
  return {name, kind, sizeof(T), members};
}
INSTANTIATE_TEST_SUITE_P(
    Shared, RoundTrip,
    ::testing::Values(shape<shared::Transform>("Transform", 0), shape<shared::Geometry>("Geometry", 1),
                      shape<shared::Item>("Item", 2), shape<shared::Material>("Material", 3),
                      shape<shared::Light>("Light", 4),
                      shape<shared::FrameConstants>("FrameConstants", 5,
                                                    offsetof(shared::FrameConstants, pre_exposure) + 4),
                      shape<shared::CullGroup>("CullGroup", 6), shape<shared::DrawCommand>("DrawCommand", 7),
                      shape<shared::DeformJob>("DeformJob", 8), shape<shared::ImageLight>("ImageLight", 9),
                      shape<shared::SkySlice>("SkySlice", 10), shape<shared::SkyLight>("SkyLight", 11),
                      shape<shared::FogMedium>("FogMedium", 12), shape<shared::ProbeLights>("ProbeLights", 13)),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace candela::gpu::test
