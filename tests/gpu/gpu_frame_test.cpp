#include <limits>

#include "gpu/frame_hash.h"
#include "gpu_fixture.h"

namespace candela::gpu::test::gpu_frame {

class Frame : public GpuTest {};

namespace {

constexpr uint32_t width = 20, height = 10;
constexpr VkFormat color_format = VK_FORMAT_R32G32B32A32_SFLOAT;

GraphicsPipelineDesc flat(uint32_t samples, Blend blend = Blend::none) {
  return {.vertex_shader = "fullscreen.vert",
          .fragment_shader = "flat.frag",
          .color_formats = {color_format},
          .samples = samples,
          .blend = blend};
}

// Draws a full-screen triangle additively onto `image`, which the first writer clears.
ImageHandle add_layer(GraphBuilder& builder, const std::string& name, ImageHandle image, glm::vec4 color,
                      uint32_t samples, ImageHandle* resolve = nullptr) {
  builder.begin_pass(name);
  image = builder.write(image, Access::color_attachment);
  if (resolve) *resolve = builder.write(*resolve, Access::resolve_attachment);
  const PipelineHandle pipeline = builder.pipeline(flat(samples, Blend::additive));
  const CommandList::Attachment target{image, resolve ? *resolve : ImageHandle{}};
  builder.end_pass([=](CommandList& commands) {
    commands.begin_rendering({&target, 1}, {});
    commands.bind(pipeline);
    commands.push(color);
    commands.draw(3);
    commands.end_rendering();
  });
  return image;
}

void expect_all(const Readback& readback, glm::vec4 wanted) {
  const auto values = values_of<glm::vec4>(readback);
  size_t wrong = 0;
  for (const glm::vec4& value : values) wrong += value != wanted;
  EXPECT_EQ(wrong, 0u) << values[0].x << " " << values[0].y << " " << values[0].z << " " << values[0].w;
}

// Colour and depth of 4 samples, both written by the pass "draw"; "resolve" then resolves the colour and is read back.
BufferHandle add_multisampled(GraphBuilder& builder, glm::vec4 color, VkFormat format) {
  builder.begin_pass("draw");
  ImageHandle image = builder.create(
      ImageDesc{.name = "color", .format = format, .width_px = width, .height_px = height, .samples = 4});
  ImageHandle depth = builder.create(
      ImageDesc{.name = "depth", .format = VK_FORMAT_D32_SFLOAT, .width_px = width, .height_px = height, .samples = 4});
  ImageHandle resolved =
      builder.create(ImageDesc{.name = "resolved", .format = format, .width_px = width, .height_px = height});
  image = builder.write(image, Access::color_attachment);
  depth = builder.write(depth, Access::depth_attachment);
  GraphicsPipelineDesc desc = flat(4);
  desc.color_formats = {format};
  desc.depth_format = VK_FORMAT_D32_SFLOAT;
  desc.depth_test = desc.depth_write = true;
  const PipelineHandle pipeline = builder.pipeline(desc);
  const CommandList::Attachment target{image};
  builder.end_pass([=](CommandList& commands) {
    commands.begin_rendering({&target, 1}, depth);
    commands.bind(pipeline);
    commands.push(color);
    commands.draw(3);
    commands.end_rendering();
  });
  builder.begin_pass("resolve");
  builder.read(depth, Access::depth_test, "depth");
  image = builder.write(image, Access::color_attachment);
  resolved = builder.write(resolved, Access::resolve_attachment);
  const CommandList::Attachment both{image, resolved};
  builder.end_pass([=](CommandList& commands) {
    commands.begin_rendering({&both, 1}, depth);
    commands.end_rendering();
  });
  return add_readback(builder, "resolved", resolved, width * height * format_bytes(format));
}

const PassHash& hash_of(const FrameRun& run, const std::string& pass, const std::string& resource) {
  for (const PassHash& hash : run.hashes)
    if (hash.pass == pass && hash.resource == resource) return hash;
  ADD_FAILURE() << "no hash of " << resource << " after " << pass;
  static const PassHash none;
  return none;
}

}  // namespace

TEST_F(Frame, ReadsBackWhatAComputePassWrote) {
  GraphBuilder builder;
  const BufferHandle bytes = add_readback(builder, "image", add_fill(builder, "image", 13, 7, 2.5f), 13 * 7 * 16);
  const CompiledGraph graph = compile_graph(builder);
  for (const bool timed : {false, true}) {
    const FrameRun result = run(graph, {.timed = timed});
    ASSERT_TRUE(result.readbacks.contains(bytes.resource));
    const auto texels = values_of<glm::vec4>(*result.readbacks.at(bytes.resource));
    ASSERT_EQ(texels.size(), 13u * 7);
    for (uint32_t y = 0; y < 7; ++y)
      for (uint32_t x = 0; x < 13; ++x) EXPECT_EQ(texels[y * 13 + x], glm::vec4(2.5f, x, y, 1));
    EXPECT_EQ(result.passes.size(), timed ? 2u : 0u);
  }
}

TEST_F(Frame, TheFirstWriterClearsAndLaterOnesLoad) {
  for (const uint32_t samples : {1u, 4u}) {
    GraphBuilder builder;
    ImageHandle resolved{}, image{};
    builder.begin_pass("first");
    image = builder.create(ImageDesc{.name = "color",
                                     .format = color_format,
                                     .width_px = width,
                                     .height_px = height,
                                     .samples = samples,
                                     .clear = {0.5f, 0.25f, 0, 1}});
    image = builder.write(image, Access::color_attachment);
    const CommandList::Attachment target{image};
    builder.end_pass([=](CommandList& commands) {
      commands.begin_rendering({&target, 1}, {});
      commands.end_rendering();
    });
    if (samples > 1) {
      builder.begin_pass("second");
      resolved =
          builder.create(ImageDesc{.name = "resolved", .format = color_format, .width_px = width, .height_px = height});
      image = builder.write(image, Access::color_attachment);
      resolved = builder.write(resolved, Access::resolve_attachment);
      const CommandList::Attachment both{image, resolved};
      const PipelineHandle pipeline = builder.pipeline(flat(samples, Blend::additive));
      builder.end_pass([=](CommandList& commands) {
        commands.begin_rendering({&both, 1}, {});
        commands.bind(pipeline);
        commands.push(glm::vec4(1, 2, 4, 8));
        commands.draw(3);
        commands.end_rendering();
      });
    } else {
      resolved = add_layer(builder, "second", image, {1, 2, 4, 8}, samples);
    }
    const BufferHandle bytes = add_readback(builder, "result", resolved, width * height * 16);
    const CompiledGraph graph = compile_graph(builder);
    for (int frame = 0; frame < 2; ++frame)  // a second frame clears again
      expect_all(*run(graph).readbacks.at(bytes.resource), {1.5f, 2.25f, 4, 9});
  }
}

// Depth is cleared to 0 (reversed: far), written by one pass, tested by the next, then sampled by compute.
TEST_F(Frame, DepthIsWrittenTestedAndSampled) {
  GraphBuilder builder;
  builder.begin_pass("prepass");
  ImageHandle depth = builder.create(
      ImageDesc{.name = "depth", .format = VK_FORMAT_D32_SFLOAT, .width_px = width, .height_px = height});
  depth = builder.write(depth, Access::depth_attachment);
  const PipelineHandle prepass = builder.pipeline(GraphicsPipelineDesc{.vertex_shader = "fullscreen.vert",
                                                                       .depth_format = VK_FORMAT_D32_SFLOAT,
                                                                       .depth_test = true,
                                                                       .depth_write = true});
  builder.end_pass([=](CommandList& commands) {
    commands.begin_rendering({}, depth);
    commands.bind(prepass);
    commands.draw(3);
    commands.end_rendering();
  });
  builder.begin_pass("shade");
  builder.read(depth, Access::depth_test, "depth");
  ImageHandle color =
      builder.create(ImageDesc{.name = "color", .format = color_format, .width_px = width, .height_px = height});
  color = builder.write(color, Access::color_attachment);
  GraphicsPipelineDesc equal = flat(1), greater = flat(1, Blend::additive);
  equal.depth_format = greater.depth_format = VK_FORMAT_D32_SFLOAT;
  equal.depth_test = greater.depth_test = true;
  equal.depth_compare = VK_COMPARE_OP_EQUAL;
  greater.depth_compare = VK_COMPARE_OP_GREATER;
  const PipelineHandle passes = builder.pipeline(equal), fails = builder.pipeline(greater);
  const CommandList::Attachment target{color};
  builder.end_pass([=](CommandList& commands) {
    commands.begin_rendering({&target, 1}, depth);
    commands.bind(passes);
    commands.push(glm::vec4(3));
    commands.draw(3);
    commands.bind(fails);
    commands.draw(3);
    commands.end_rendering();
  });
  builder.begin_pass("sample depth");
  builder.read(depth, Access::sampled_compute, "depth");
  ImageHandle copy =
      builder.create(ImageDesc{.name = "copy", .format = color_format, .width_px = width, .height_px = height});
  copy = builder.write(copy, Access::storage_image_write);
  const PipelineHandle sample = builder.pipeline(ComputePipelineDesc{.shader = "depth_to_image.comp"});
  builder.end_pass([=](CommandList& commands) {
    commands.bind(sample);
    commands.push(std::array<uint32_t, 4>{commands.sampled(depth), commands.storage(copy), width, height});
    commands.dispatch(width, height);
  });
  const BufferHandle shaded = add_readback(builder, "color", color, width * height * 16);
  const BufferHandle sampled = add_readback(builder, "copy", copy, width * height * 16);
  const FrameRun result = run(compile_graph(builder));
  expect_all(*result.readbacks.at(shaded.resource), glm::vec4(3));
  expect_all(*result.readbacks.at(sampled.resource), glm::vec4(0.5f));
}

// Images that share memory: what the first left there, NaNs, must not show in the second.
TEST_F(Frame, AliasedImagesDoNotShowWhatWasThereBefore) {
  GraphBuilder builder;
  const ImageHandle poison = add_fill(builder, "poison", width, height, std::numeric_limits<float>::quiet_NaN());
  const BufferHandle first = add_readback(builder, "poison", poison, width * height * 16);
  builder.begin_pass("clear");
  ImageHandle image = builder.create(ImageDesc{
      .name = "clean", .format = color_format, .width_px = width, .height_px = height, .clear = {1, 2, 3, 4}});
  image = builder.write(image, Access::color_attachment);
  const CommandList::Attachment target{image};
  builder.end_pass([=](CommandList& commands) {
    commands.begin_rendering({&target, 1}, {});
    commands.end_rendering();
  });
  image = add_layer(builder, "add", image, glm::vec4(1), 1);
  const BufferHandle second = add_readback(builder, "clean", image, width * height * 16);
  const CompiledGraph graph = compile_graph(builder);
  ASSERT_EQ(graph.plan.resources[size_t(poison.resource)].block, graph.plan.resources[size_t(image.resource)].block);
  const FrameRun result = run(graph);
  EXPECT_TRUE(std::isnan(values_of<float>(*result.readbacks.at(first.resource))[0]));
  expect_all(*result.readbacks.at(second.resource), {2, 3, 4, 5});
}

// A compute pass writes indices, draw commands and a zeroed count; the draw reads all three; its fragments count
// themselves.
TEST_F(Frame, IndirectDrawsReadWhatComputeWrote) {
  GraphBuilder builder;
  builder.begin_pass("make draws");
  BufferHandle commands = builder.create(BufferDesc{.name = "commands", .size_bytes = 40});
  BufferHandle counts = builder.create(BufferDesc{.name = "counts", .size_bytes = 4, .zeroed = true});
  BufferHandle indices = builder.create(BufferDesc{.name = "indices", .size_bytes = 12});
  commands = builder.write(commands, Access::compute_write);
  counts = builder.write(counts, Access::compute_write);
  indices = builder.write(indices, Access::compute_write);
  const PipelineHandle make = builder.pipeline(ComputePipelineDesc{.shader = "make_draws.comp"});
  builder.end_pass([=](CommandList& list) {
    list.bind(make);
    list.push(std::array<uint64_t, 3>{list.address(commands), list.address(counts), list.address(indices)});
    list.dispatch(1);
  });
  builder.begin_pass("draw");
  builder.read(commands, Access::indirect_read, "commands");
  builder.read(counts, Access::indirect_read, "counts");
  builder.read(indices, Access::index_read, "indices");
  ImageHandle color =
      builder.create(ImageDesc{.name = "color", .format = color_format, .width_px = width, .height_px = height});
  color = builder.write(color, Access::color_attachment);
  BufferHandle counter =
      builder.create(BufferDesc{.name = "counter", .size_bytes = 4, .memory = BufferMemory::host_read, .zeroed = true});
  counter = builder.write(counter, Access::fragment_write);
  GraphicsPipelineDesc desc = flat(1, Blend::additive);
  desc.fragment_shader = "count.frag";
  const PipelineHandle pipeline = builder.pipeline(desc);
  const CommandList::Attachment target{color};
  builder.end_pass([=](CommandList& list) {
    struct {
      glm::vec4 color;
      uint64_t counter;
    } const push{glm::vec4(1), list.address(counter)};
    list.begin_rendering({&target, 1}, {});
    list.bind(pipeline);
    list.push(push);
    list.bind_index_buffer(indices);
    list.draw_indexed_indirect_count(commands, 0, counts, 0, 2);
    list.end_rendering();
  });
  builder.sink(counter);
  const BufferHandle bytes = add_readback(builder, "color", color, width * height * 16);
  const CompiledGraph graph = compile_graph(builder);
  for (int frame = 0; frame < 2; ++frame) {  // zeroed in every frame
    const FrameRun result = run(graph);
    expect_all(*result.readbacks.at(bytes.resource), glm::vec4(1));
    EXPECT_EQ(values_of<uint32_t>(*result.readbacks.at(counter.resource))[0], width * height);
  }
}

TEST_F(Frame, HashesRepeatAndCountNonFiniteValues) {
  GraphBuilder builder;
  const ImageHandle good = add_fill(builder, "good", width, height, 1);
  const ImageHandle bad = add_fill(builder, "bad", width, height, std::numeric_limits<float>::infinity());
  const BufferHandle bytes = add_readback(builder, "good", good, width * height * 16);
  add_readback(builder, "bad", bad, width * height * 16);
  const CompiledGraph graph = compile_graph(builder);
  const FrameRun first = run(graph, {.hash_outputs = true}), second = run(graph, {.hash_outputs = true});
  ASSERT_EQ(first.hashes.size(), 4u);
  for (size_t i = 0; i < first.hashes.size(); ++i) {
    EXPECT_EQ(first.hashes[i].hash, second.hashes[i].hash) << first.hashes[i].resource;
    EXPECT_EQ(first.hashes[i].nonfinite, first.hashes[i].resource == "bad" ? width * height : 0u);
  }
  EXPECT_EQ(first.hashes[0].pass, "fill good");
  EXPECT_EQ(first.hashes[0].hash, hash128(first.readbacks.at(bytes.resource)->bytes()));
  EXPECT_NE(first.hashes[0].hash, first.hashes[1].hash);
}

TEST_F(Frame, MultisampledImagesAreHashedSampleBySample) {
  for (const VkFormat format : {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R16G16B16A16_SFLOAT}) {
    const auto hashed = [&](glm::vec4 color) {
      GraphBuilder builder;
      add_multisampled(builder, color, format);
      return run(compile_graph(builder), {.hash_outputs = true});
    };
    const FrameRun first = hashed({1, 2, 3, 4}), second = hashed({1, 2, 3, 4}), other = hashed({1, 2, 3, 5});
    const PassHash& color = hash_of(first, "draw", "color");
    EXPECT_EQ(color.hash, hash_of(second, "draw", "color").hash);
    EXPECT_NE(color.hash, hash_of(other, "draw", "color").hash);
    EXPECT_EQ(hash_of(first, "draw", "depth").hash, hash_of(other, "draw", "depth").hash);
    // Every sample holds what was drawn, in words of 32 bits; depth is what fullscreen.vert gives.
    const std::vector<glm::vec4> samples(width * height * 4, glm::vec4(1, 2, 3, 4));
    EXPECT_EQ(color.hash, hash128(std::as_bytes(std::span(samples))));
    const std::vector<float> depths(width * height * 4, 0.5f);
    EXPECT_EQ(hash_of(first, "draw", "depth").hash, hash128(std::as_bytes(std::span(depths))));
    EXPECT_EQ(color.nonfinite, 0u);
  }
}

// An infinity made in a multisampled pass is that pass's, not the resolve's that follows.
TEST_F(Frame, NonFiniteSamplesAreChargedToThePassThatMadeThem) {
  for (const VkFormat format : {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R16G16B16A16_SFLOAT}) {
    GraphBuilder builder;
    add_multisampled(builder, {1, std::numeric_limits<float>::infinity(), 0, 1}, format);
    const FrameRun result = run(compile_graph(builder), {.hash_outputs = true});
    ASSERT_FALSE(result.hashes.empty());
    EXPECT_EQ(result.hashes.front().pass, "draw");
    EXPECT_EQ(hash_of(result, "draw", "color").nonfinite, width * height * 4);
    EXPECT_EQ(hash_of(result, "draw", "depth").nonfinite, 0u);
  }
}

// Every sample of every pixel has a value of its own; what is hashed is all of them, in order.
TEST_F(Frame, EachSampleIsHashedAtItsOwnPlace) {
  constexpr uint32_t samples = 4;
  std::vector<glm::vec4> texels(width * height * samples);
  for (size_t i = 0; i < texels.size(); ++i) texels[i] = glm::vec4(i, i + 0.25f, i + 0.5f, i + 0.75f);
  const auto bytes = std::as_bytes(std::span(texels));
  Buffer buffer(*device, bytes.size(), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                Buffer::Memory::upload, Device::Purpose::scene, "texels");
  std::memcpy(buffer.mapped(), bytes.data(), bytes.size());
  GraphBuilder builder;
  const BufferHandle source = builder.import_buffer(BufferDesc{.name = "texels", .size_bytes = bytes.size()});
  builder.begin_pass("samples");
  builder.read(source, Access::fragment_read, "texels");
  ImageHandle image = builder.create(
      ImageDesc{.name = "color", .format = color_format, .width_px = width, .height_px = height, .samples = samples});
  image = builder.write(image, Access::color_attachment);
  GraphicsPipelineDesc desc = flat(samples);
  desc.fragment_shader = "one_sample.frag";
  const PipelineHandle pipeline = builder.pipeline(desc);
  const CommandList::Attachment target{image};
  builder.end_pass([=](CommandList& commands) {
    commands.begin_rendering({&target, 1}, {});
    commands.bind(pipeline);
    for (uint32_t which = 0; which < samples; ++which) {
      struct {
        uint64_t source;
        uint32_t width, samples, which, unused;
      } const push{commands.address(source), width, samples, which, 0};
      commands.push(push);
      commands.draw(3);
    }
    commands.end_rendering();
  });
  builder.sink(image);
  const FrameRun result = run(compile_graph(builder), {.hash_outputs = true}, {{source.resource, &buffer}});
  EXPECT_EQ(hash_of(result, "samples", "color").hash, hash128(bytes));
}

TEST_F(Frame, MultisampledIntegersAreHashed) {
  GraphBuilder builder;
  builder.begin_pass("clear");
  ImageHandle image = builder.create(ImageDesc{.name = "ids",
                                               .format = VK_FORMAT_R32_UINT,
                                               .width_px = width,
                                               .height_px = height,
                                               .samples = 4,
                                               .clear = {7, 0, 0, 0}});
  image = builder.write(image, Access::color_attachment);
  const CommandList::Attachment target{image};
  builder.end_pass([=](CommandList& commands) {
    commands.begin_rendering({&target, 1}, {});
    commands.end_rendering();
  });
  builder.sink(image);
  const FrameRun result = run(compile_graph(builder), {.hash_outputs = true});
  const std::vector<uint32_t> samples(width * height * 4, 7);
  EXPECT_EQ(hash_of(result, "clear", "ids").hash, hash128(std::as_bytes(std::span(samples))));
}

// What a frame imports may grow and shrink from frame to frame; its own images stay.
TEST_F(Frame, ImagesStayWhilePlansDifferOnlyInWhatTheyImport) {
  const auto planned = [](uint64_t import_bytes, uint32_t image_width) {
    GraphBuilder builder;
    const BufferHandle source = builder.import_buffer(BufferDesc{.name = "source", .size_bytes = import_bytes});
    builder.begin_pass("fill");
    builder.read(source, Access::compute_read, "source");
    ImageHandle image = builder.create(
        ImageDesc{.name = "image", .format = color_format, .width_px = image_width, .height_px = height});
    image = builder.write(image, Access::storage_image_write);
    const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "fill.comp"});
    builder.end_pass([=](CommandList& commands) {
      commands.bind(pipeline);
      commands.push(
          FillPush{commands.storage(image), image_width, height, std::bit_cast<uint32_t>(float(import_bytes))});
      commands.dispatch(image_width, height);
    });
    const BufferHandle bytes = add_readback(builder, "image", image, image_width * height * 16);
    return std::tuple(compile_graph(builder), source, bytes);
  };
  const Buffer buffer(*device, 64, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                      Buffer::Memory::upload, Device::Purpose::scene, "source");
  const auto render = [&](uint64_t import_bytes, uint32_t image_width) {
    const auto [graph, source, bytes] = planned(import_bytes, image_width);
    const auto prepared = runner->prepare(graph);
    EXPECT_TRUE(prepared);
    const FrameRun result = runner->run(graph, {{source.resource, &buffer}}, {});
    EXPECT_EQ(values_of<float>(*result.readbacks.at(bytes.resource))[0], float(import_bytes));
    return prepared && prepared->allocated;
  };
  EXPECT_TRUE(render(16, width));
  EXPECT_FALSE(render(64, width));
  EXPECT_FALSE(render(32, width));
  EXPECT_TRUE(render(32, width + 1));
}

TEST(CountNonFinite, KnowsFloatHalfAndDepth) {
  const std::array<float, 4> floats{1, -std::numeric_limits<float>::infinity(), std::nanf(""), 0};
  EXPECT_EQ(count_nonfinite(VK_FORMAT_R32G32B32A32_SFLOAT, std::as_bytes(std::span(floats))), 2u);
  EXPECT_EQ(count_nonfinite(VK_FORMAT_D32_SFLOAT, std::as_bytes(std::span(floats))), 2u);
  EXPECT_EQ(count_nonfinite(VK_FORMAT_R32_UINT, std::as_bytes(std::span(floats))), 0u);
  const std::array<uint16_t, 4> halves{0x3c00, 0x7c00, 0xfe00, 0x7bff};
  EXPECT_EQ(count_nonfinite(VK_FORMAT_R16G16B16A16_SFLOAT, std::as_bytes(std::span(halves))), 2u);
}

TEST_F(Frame, AReadbackStaysWhileLaterFramesRender) {
  GraphBuilder one, two;
  const BufferHandle a = add_readback(one, "image", add_fill(one, "image", width, height, 1), width * height * 16);
  const BufferHandle b = add_readback(two, "image", add_fill(two, "image", width, height, 2), width * height * 16);
  const auto kept = run(compile_graph(one)).readbacks.at(a.resource);
  const auto later = run(compile_graph(two)).readbacks.at(b.resource);
  EXPECT_EQ(values_of<float>(*kept)[0], 1);
  EXPECT_EQ(values_of<float>(*later)[0], 2);
}

TEST_F(Frame, AThousandFramesUseNoMoreMemoryThanTen) {
  GraphBuilder builder;
  add_readback(builder, "image", add_fill(builder, "image", width, height, 1), width * height * 16);
  const CompiledGraph graph = compile_graph(builder);
  uint64_t early = 0;
  for (int frame = 0; frame < 1000; ++frame) {
    run(graph, {.timed = frame % 2 == 0});
    if (frame == 10) early = device->memory_use().peak;
  }
  EXPECT_GT(early, 0u);
  EXPECT_EQ(device->memory_use().peak, early);
}

TEST_F(Frame, APassGetsOnlyWhatItDeclared) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  GraphBuilder builder;
  const ImageHandle image = add_fill(builder, "image", width, height, 1);
  builder.begin_pass("sneaky");
  BufferHandle buffer = builder.create(BufferDesc{.name = "buffer", .size_bytes = 16});
  buffer = builder.write(buffer, Access::compute_write);
  builder.end_pass([=](CommandList& commands) { commands.sampled(image); });
  builder.sink(buffer);
  builder.sink(image);
  const CompiledGraph graph = compile_graph(builder);
  EXPECT_DEATH(run(graph), "'sneaky' uses version 1 of 'image' without having declared it as sampled_fragment");
}

}  // namespace candela::gpu::test::gpu_frame
