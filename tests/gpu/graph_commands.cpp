#include "gpu_fixture.h"

// Fixed state of pipelines, and the commands that draw, dispatch and copy, each with the accesses that it needs.
namespace candela::gpu::test::graph_commands {

namespace {

constexpr VkFormat rgba = VK_FORMAT_R32G32B32A32_SFLOAT;
constexpr uint32_t width = 16, height = 8;
constexpr Access to = Access::transfer_destination, from = Access::transfer_source;

struct DrawPush {
  glm::vec4 color{1, 1, 1, 1};
  float depth = 0.5f;
};

GraphicsPipelineDesc flat() {
  return {.vertex_shader = "at_depth.vert", .fragment_shader = "flat.frag", .color_formats = {rgba}};
}
ImageDesc target_desc(std::string name, VkFormat format = rgba) {
  return {.name = std::move(name), .format = format, .width_px = width, .height_px = height};
}

class Commands : public GpuTest {
 protected:
  // A pass that draws into `color` (and `depth`), and what it left, read back.
  std::vector<glm::vec4> drawn(const std::function<void(CommandList&, std::span<const PipelineHandle>)>& draw,
                               const std::vector<GraphicsPipelineDesc>& pipelines, VkFormat depth_format) {
    GraphBuilder builder;
    builder.begin_pass("draw");
    const ImageHandle color = builder.write(builder.create(target_desc("color")), Access::color_attachment);
    ImageHandle depth;
    if (depth_format) {
      depth = builder.write(builder.create(target_desc("depth", depth_format)), Access::depth_attachment);
    }
    std::vector<PipelineHandle> handles;
    for (const GraphicsPipelineDesc& desc : pipelines) handles.push_back(builder.pipeline(desc));
    const CommandList::Attachment target{color};
    builder.end_pass([=](CommandList& commands) {
      commands.begin_rendering({&target, 1}, depth);
      draw(commands, handles);
      commands.end_rendering();
    });
    return texels(builder, add_readback(builder, "color", color, width * height * 16));
  }
  std::vector<glm::vec4> texels(const GraphBuilder& builder, BufferHandle buffer) {
    const CompiledGraph graph = compile_graph(builder);
    run(graph, {.hash_outputs = true});
    const FrameRun result = run(graph);
    const auto found = result.readbacks.find(buffer.resource);
    return found == result.readbacks.end() ? std::vector<glm::vec4>{} : values_of<glm::vec4>(*found->second);
  }
};

size_t count_of(const std::vector<glm::vec4>& values, glm::vec4 wanted) {
  return size_t(std::count(values.begin(), values.end(), wanted));
}

}  // namespace

TEST_F(Commands, ViewportAndScissorBoundWhatIsDrawn) {
  const auto values = drawn(
      [](CommandList& commands, std::span<const PipelineHandle> pipelines) {
        commands.bind(pipelines[0]);
        commands.set_viewport({4, 2}, {8, 4});
        commands.push(DrawPush{{1, 0, 0, 0}});
        commands.draw(3);
        commands.set_viewport({0, 0}, {width, height});
        commands.set_scissor({0, 6}, {3, 2});
        commands.push(DrawPush{{0, 1, 0, 0}});
        commands.draw(3);
      },
      {flat()}, VK_FORMAT_UNDEFINED);
  ASSERT_EQ(values.size(), width * height);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const bool in_viewport = x >= 4 && x < 12 && y >= 2 && y < 6, in_scissor = x < 3 && y >= 6;
      EXPECT_EQ(values[y * width + x], glm::vec4(in_viewport, in_scissor, 0, 0)) << x << " " << y;
    }
}

TEST_F(Commands, EachAttachmentBlendsAndMasksForItself) {
  GraphBuilder builder;
  builder.begin_pass("draw");
  const ImageHandle first = builder.write(builder.create(target_desc("first")), Access::color_attachment);
  const ImageHandle second = builder.write(builder.create(target_desc("second")), Access::color_attachment);
  GraphicsPipelineDesc desc = flat();
  desc.fragment_shader = "flat_twice.frag";
  desc.color_formats = {rgba, rgba};
  desc.attachments = {{Blend::additive, 0x3}, {Blend::none, 0xe}};
  const PipelineHandle pipeline = builder.pipeline(desc);
  builder.end_pass([=](CommandList& commands) {
    const CommandList::Attachment targets[] = {{first}, {second}};
    commands.begin_rendering(targets, {});
    commands.bind(pipeline);
    commands.push(DrawPush{{1, 2, 4, 8}});
    commands.draw(3);
    commands.draw(3);
    commands.end_rendering();
  });
  const BufferHandle of_first = add_readback(builder, "first", first, width * height * 16);
  const BufferHandle of_second = add_readback(builder, "second", second, width * height * 16);
  EXPECT_EQ(count_of(texels(builder, of_first), {2, 4, 0, 0}), width * height);
  EXPECT_EQ(count_of(texels(builder, of_second), {0, 2, 4, 8}), width * height);
}

TEST_F(Commands, StencilKeepsWhatItMarked) {
  GraphicsPipelineDesc mark = flat();
  mark.depth_format = VK_FORMAT_D32_SFLOAT_S8_UINT;
  mark.stencil_test = true;
  mark.attachments = {{Blend::none, 0}};
  mark.stencil = {.pass = VK_STENCIL_OP_REPLACE};
  GraphicsPipelineDesc draw = mark;
  draw.attachments.clear();
  draw.stencil = {.compare = VK_COMPARE_OP_EQUAL};
  const auto values = drawn(
      [](CommandList& commands, std::span<const PipelineHandle> pipelines) {
        commands.push(DrawPush{});
        commands.set_scissor({2, 1}, {5, 3});
        commands.set_stencil_reference(3);
        commands.bind(pipelines[0]);
        commands.draw(3);
        commands.set_scissor({0, 0}, {width, height});
        commands.bind(pipelines[1]);
        commands.draw(3);
      },
      {mark, draw}, VK_FORMAT_D32_SFLOAT_S8_UINT);
  ASSERT_EQ(values.size(), width * height);
  EXPECT_EQ(count_of(values, {1, 1, 1, 1}), 15u);
  EXPECT_EQ(values[1 * width + 2].x, 1);
  EXPECT_EQ(values[0].x, 0);
}

// What lies outside the near and far plane is clipped, or drawn at the plane.
TEST_F(Commands, DepthClampKeepsWhatIsNearerThanThePlane) {
  for (const bool clamp : {false, true}) {
    GraphicsPipelineDesc desc = flat();
    desc.depth_format = VK_FORMAT_D32_SFLOAT;
    desc.depth_test = desc.depth_write = true;
    desc.depth_clamp = clamp;
    const auto values = drawn(
        [](CommandList& commands, std::span<const PipelineHandle> pipelines) {
          commands.bind(pipelines[0]);
          commands.push(DrawPush{{1, 0, 0, 0}, 1.5f});
          commands.draw(3);
          commands.push(DrawPush{{0, 1, 0, 0}, 0.99f});
          commands.draw(3);
        },
        {desc}, VK_FORMAT_D32_SFLOAT);
    EXPECT_EQ(count_of(values, clamp ? glm::vec4(1, 0, 0, 0) : glm::vec4(0, 1, 0, 0)), width * height)
        << "the clamped depth is 1, nearer than 0.99";
  }
}

TEST_F(Commands, DepthBiasMovesDepth) {
  for (const float bias : {0.0f, -float(1 << 20)}) {
    GraphicsPipelineDesc desc = flat(), behind = flat();
    desc.depth_format = behind.depth_format = VK_FORMAT_D32_SFLOAT;
    desc.depth_test = desc.depth_write = behind.depth_test = true;
    desc.depth_bias_constant = bias;
    const auto values = drawn(
        [](CommandList& commands, std::span<const PipelineHandle> pipelines) {
          commands.bind(pipelines[0]);
          commands.push(DrawPush{{1, 0, 0, 0}, 0.5f});
          commands.draw(3);
          commands.bind(pipelines[1]);
          commands.push(DrawPush{{0, 1, 0, 0}, 0.47f});  // 0.5 - 2^20 * 2^-25 is 0.46875
          commands.draw(3);
        },
        {desc, behind}, VK_FORMAT_D32_SFLOAT);
    EXPECT_EQ(count_of(values, bias == 0 ? glm::vec4(1, 0, 0, 0) : glm::vec4(0, 1, 0, 0)), width * height);
  }
}

TEST_F(Commands, GroupsOfADispatchComeFromABuffer) {
  GraphBuilder builder;
  builder.begin_pass("prepare");
  const BufferHandle groups = builder.write(builder.create(BufferDesc{"groups", 16}), to);
  const ImageHandle blank = builder.write(builder.create(target_desc("image")), to);
  builder.end_pass([=](CommandList& commands) {
    commands.fill_buffer(groups, 1);
    commands.clear_image(blank, {7, 7, 7, 7});
  });
  builder.begin_pass("fill");
  builder.read(groups, Access::indirect_read, "groups");
  const ImageHandle image = builder.write(blank, Access::storage_image_write);
  const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "fill.comp"});
  builder.end_pass([=](CommandList& commands) {
    commands.bind(pipeline);
    commands.push(FillPush{commands.storage(image), width, height, std::bit_cast<uint32_t>(2.0f)});
    commands.dispatch_indirect(groups, 4);
  });
  const auto values = texels(builder, add_readback(builder, "image", image, width * height * 16));
  ASSERT_EQ(values.size(), width * height);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x)
      EXPECT_EQ(values[y * width + x], x < 8 && y < 4 ? glm::vec4(2, x, y, 1) : glm::vec4(7)) << "one group of 8 x 4";
}

TEST_F(Commands, DrawsComeFromIndicesAndBuffers) {
  GraphBuilder builder;
  builder.begin_pass("prepare");
  const BufferHandle indices = builder.write(builder.create(BufferDesc{"indices", 12}), to);
  const BufferHandle draws = builder.write(builder.create(BufferDesc{"draws", 64}), to);
  builder.end_pass([=](CommandList& commands) {
    for (uint32_t i = 0; i < 3; ++i) commands.fill_buffer(indices, i, 4 * i, 4);
    // {vertices, instances, first, first instance} at 0, {indices, instances, first, offset, first instance} at 32
    const uint32_t words[] = {3, 1, 0, 0, 0, 0, 0, 0, 3, 1, 0, 0, 0};
    for (uint32_t i = 0; i < std::size(words); ++i) commands.fill_buffer(draws, words[i], 4 * i, 4);
  });
  builder.begin_pass("draw");
  builder.read(indices, Access::index_read, "indices");
  builder.read(draws, Access::indirect_read, "draws");
  const ImageHandle color = builder.write(builder.create(target_desc("color")), Access::color_attachment);
  GraphicsPipelineDesc desc = flat();
  desc.blend = Blend::additive;
  const PipelineHandle pipeline = builder.pipeline(desc);
  builder.end_pass([=](CommandList& commands) {
    const CommandList::Attachment target{color};
    commands.begin_rendering({&target, 1}, {});
    commands.bind(pipeline);
    commands.bind_index_buffer(indices);
    const auto add = [&](glm::vec4 value) { commands.push(DrawPush{value}); };
    add({1, 0, 0, 0});
    commands.draw_indexed(3);
    add({0, 1, 0, 0});
    commands.draw_indirect(draws, 0, 1);
    add({0, 0, 1, 0});
    commands.draw_indexed_indirect(draws, 32, 1);
    commands.end_rendering();
  });
  const auto values = texels(builder, add_readback(builder, "color", color, width * height * 16));
  EXPECT_EQ(count_of(values, {1, 1, 1, 0}), width * height);
}

// image -> mip 1 (blit) -> another image's layer (copy) -> buffer -> buffer -> image -> buffer.
TEST_F(Commands, CopiesCarryTexels) {
  GraphBuilder builder;
  const ImageHandle source = add_fill(builder, "source", width, height, 3);
  builder.begin_pass("blit");
  builder.read(source, from, "source");
  ImageHandle chain =
      builder.create(ImageDesc{.name = "chain", .format = rgba, .width_px = width, .height_px = height, .mips = 2});
  chain = builder.write(chain, to, ImageRange::mip(1));
  builder.end_pass([=](CommandList& commands) { commands.blit(source, chain, true); });
  builder.begin_pass("copy image");
  builder.read(chain, from, "chain", ImageRange::mip(1));
  ImageDesc desc = target_desc("array");
  desc.width_px = width / 2, desc.height_px = height / 2, desc.kind = ImageKind::d2_array, desc.layers = 2;
  const ImageHandle array = builder.write(builder.create(desc), to, ImageRange::layer(1));
  builder.end_pass([=](CommandList& commands) { commands.copy_image(chain, array); });
  constexpr uint64_t bytes = width / 2 * height / 2 * 16;
  builder.begin_pass("to buffer");
  builder.read(array, from, "array", ImageRange::layer(1));
  const BufferHandle first = builder.write(builder.create(BufferDesc{"first", bytes}), to);
  builder.end_pass([=](CommandList& commands) { commands.copy_to_buffer(array, first); });
  builder.begin_pass("copy buffer");
  builder.read(first, from, "first");
  const BufferHandle second = builder.write(builder.create(BufferDesc{"second", bytes + 64}), to);
  builder.end_pass([=](CommandList& commands) { commands.copy_buffer(first, 0, second, 0, bytes); });
  builder.begin_pass("to image");
  builder.read(second, from, "second");
  desc = target_desc("last");
  desc.width_px = width / 2, desc.height_px = height / 2;
  const ImageHandle last = builder.write(builder.create(desc), to);
  builder.end_pass([=](CommandList& commands) { commands.copy_to_image(second, last); });
  const auto values = texels(builder, add_readback(builder, "last", last, bytes));
  ASSERT_EQ(values.size(), bytes / 16);
  for (uint32_t y = 0; y < height / 2; ++y)
    for (uint32_t x = 0; x < width / 2; ++x)
      EXPECT_EQ(values[y * width / 2 + x], glm::vec4(3, 2 * float(x) + 0.5f, 2 * float(y) + 0.5f, 1));
}

TEST_F(Commands, ADepthImageIsClearedByACommand) {
  GraphBuilder builder;
  builder.begin_pass("clear");
  const ImageHandle depth = builder.write(builder.create(target_desc("depth", VK_FORMAT_D32_SFLOAT)), to);
  builder.end_pass([=](CommandList& commands) { commands.clear_image(depth, {0.625f, 0, 0, 0}); });
  builder.begin_pass("look");
  builder.read(depth, Access::sampled_compute, "depth");
  const ImageHandle image = builder.write(builder.create(target_desc("image")), Access::storage_image_write);
  const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "depth_to_image.comp"});
  builder.end_pass([=](CommandList& commands) {
    commands.bind(pipeline);
    commands.push(glm::uvec4(commands.sampled(depth), commands.storage(image), width, height));
    commands.dispatch(width, height);
  });
  EXPECT_EQ(count_of(texels(builder, add_readback(builder, "image", image, width * height * 16)), glm::vec4(0.625f)),
            width * height);
}

TEST_F(Commands, ACommandWithoutItsAccessIsRefused) {
  GraphBuilder builder;
  builder.begin_pass("wrong");
  const BufferHandle buffer = builder.write(builder.create(BufferDesc{"groups", 16}), Access::compute_write);
  builder.end_pass([=](CommandList& commands) { commands.fill_buffer(buffer, 0); });
  builder.sink(buffer);
  const CompiledGraph graph = compile_graph(builder);
  ASSERT_TRUE(runner->prepare(graph));
  EXPECT_DEATH(runner->run(graph, {}, {}), "'wrong' uses .*groups.* transfer_destination");
}

}  // namespace candela::gpu::test::graph_commands
