#include "gpu/kept_image.h"
#include "gpu_fixture.h"
#include "shared/samplers.h"

// Mips, layers, cubes and 3D images on the device: what the graph's plans of them mean. Every graph also runs timed and
// hashed, which submits each pass alone and looks at every output between passes.
namespace candela::gpu::test::graph_subresources {

namespace {

constexpr VkFormat rgba = VK_FORMAT_R32G32B32A32_SFLOAT;

class Subresources : public GpuTest {
 protected:
  std::vector<glm::vec4> texels(const GraphBuilder& builder, BufferHandle buffer) {
    const CompiledGraph graph = compile_graph(builder);
    std::vector<glm::vec4> first;
    for (const RunOptions options : {RunOptions{}, RunOptions{.timed = true}, RunOptions{.hash_outputs = true}}) {
      const FrameRun result = run(graph, options);
      const auto found = result.readbacks.find(buffer.resource);
      if (found == result.readbacks.end()) return {};
      const auto values = values_of<glm::vec4>(*found->second);
      if (first.empty()) first = values;
      EXPECT_EQ(std::memcmp(values.data(), first.data(), first.size() * sizeof(glm::vec4)), 0);
    }
    return first;
  }
};

struct HalvePush {
  uint32_t source, target, width, height;
};

// Steps 0 to mips-2: each reads one mip and writes the next.
ImageHandle add_halving(GraphBuilder& builder, ImageHandle image, uint32_t mips) {
  builder.begin_pass("halve");
  const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "halve.comp"});
  for (uint32_t mip = 1; mip < mips; ++mip) {
    builder.begin_step();
    builder.read(image, Access::sampled_compute, "image", ImageRange::mip(mip - 1));
    image = builder.write(image, Access::storage_image_write, ImageRange::mip(mip));
  }
  builder.end_pass([=](CommandList& commands) {
    const glm::uvec2 size = commands.size(image, commands.step() + 1);
    commands.bind(pipeline);
    commands.push(HalvePush{commands.sampled(image), commands.storage(image), size.x, size.y});
    commands.dispatch(size.x, size.y);
  });
  return image;
}

ImageHandle add_filled(GraphBuilder& builder, ImageDesc desc, float base, ImageRange range = ImageRange::mip(0)) {
  builder.begin_pass("fill " + desc.name);
  ImageHandle image = builder.write(builder.create(desc), Access::storage_image_write, range);
  const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "fill.comp"});
  builder.end_pass([=](CommandList& commands) {
    const glm::uvec2 size = commands.size(image, range.first_mip);
    commands.bind(pipeline);
    commands.push(FillPush{commands.storage(image), size.x, size.y, std::bit_cast<uint32_t>(base)});
    commands.dispatch(size.x, size.y);
  });
  return image;
}

struct SamplePush {
  uint32_t source, target, count;
  float lod;
  glm::vec4 place[6];
};
static_assert(sizeof(SamplePush) <= 128);

// What a sampler gives at some places of an image that is seen as `kind`; 5: depth, compared.
BufferHandle add_samples(GraphBuilder& builder, ImageHandle image, ImageRange range, ImageKind view, uint32_t kind,
                         uint32_t sampler, std::vector<glm::vec4> places, float lod = 0) {
  const std::string name = fmt::format("samples {}", builder.passes().size());
  builder.begin_pass(name);
  builder.read(image, Access::sampled_compute, "image", range, view);
  const ImageHandle out = builder.write(
      builder.create(ImageDesc{.name = name, .format = rgba, .width_px = uint32_t(places.size()), .height_px = 1}),
      Access::storage_image_write);
  const PipelineHandle pipeline = builder.pipeline(
      ComputePipelineDesc{.shader = "sample_kinds.comp", .constants = {{0, "KIND", kind}, {1, "SAMPLER", sampler}}});
  builder.end_pass([=](CommandList& commands) {
    SamplePush push{commands.sampled(image), commands.storage(out), uint32_t(places.size()), lod, {}};
    std::copy(places.begin(), places.end(), push.place);
    commands.bind(pipeline);
    commands.push(push);
    commands.dispatch(uint32_t(places.size()));
  });
  return add_readback(builder, name, out, places.size() * sizeof(glm::vec4));
}

struct KindPush {
  uint32_t target;
  float base;
  glm::uvec3 size;
};

}  // namespace

TEST_F(Subresources, EachMipHalvesTheOneBefore) {
  GraphBuilder builder;
  constexpr uint32_t mips = 4, width = 32, height = 16;
  ImageHandle image =
      add_filled(builder, {.name = "chain", .format = rgba, .width_px = width, .height_px = height, .mips = mips}, 3);
  image = add_halving(builder, image, mips);
  const uint64_t texels_of_all = width * height + width * height / 4 + width * height / 16 + width * height / 64;
  const auto values = texels(builder, add_readback(builder, "chain", image, texels_of_all * sizeof(glm::vec4)));
  ASSERT_EQ(values.size(), texels_of_all);
  size_t at = 0;
  for (uint32_t mip = 0; mip < mips; ++mip) {
    const float scale = float(1u << mip);
    for (uint32_t y = 0; y < height >> mip; ++y)
      for (uint32_t x = 0; x < width >> mip; ++x, ++at)
        ASSERT_EQ(values[at], glm::vec4(3, (float(x) + 0.5f) * scale - 0.5f, (float(y) + 0.5f) * scale - 0.5f, 1))
            << "mip " << mip << " at " << x << " " << y;
  }
}

TEST_F(Subresources, AChainIsTimedAsOnePassAndHasABarrierForEachStep) {
  GraphBuilder builder;
  ImageHandle image =
      add_filled(builder, {.name = "chain", .format = rgba, .width_px = 16, .height_px = 16, .mips = 5}, 1);
  image = add_halving(builder, image, 5);
  add_readback(builder, "chain", image, 16 * 341);
  const CompiledGraph graph = compile_graph(builder);
  ASSERT_EQ(graph.plan.passes.size(), 3u);
  const PlanPass& halve = graph.plan.passes[1];
  EXPECT_EQ(halve.steps(), 4u);
  for (uint32_t step = 0; step < 4; ++step)
    EXPECT_EQ(halve.barriers_before(step).images.size(), 2u) << "the mip that is read, the mip that is written";
  EXPECT_EQ(graph.plan.passes[2].barriers.images.size(), 2u) << "four sampled mips are one barrier, the last is one";
  const FrameRun result = run(graph, {.timed = true});
  ASSERT_EQ(result.passes.size(), 3u);
  EXPECT_EQ(result.passes[1].name, "halve");
}

TEST_F(Subresources, AStepReachesOnlyWhatItDeclared) {
  for (const bool write : {false, true}) {
    GraphBuilder builder;
    ImageHandle image =
        add_filled(builder, {.name = "chain", .format = rgba, .width_px = 8, .height_px = 8, .mips = 3}, 1);
    builder.begin_pass("halve");
    for (uint32_t mip = 1; mip < 3; ++mip) {
      builder.begin_step();
      builder.read(image, Access::sampled_compute, "image", ImageRange::mip(mip - 1));
      image = builder.write(image, Access::storage_image_write, ImageRange::mip(mip));
    }
    builder.end_pass([=](CommandList& commands) {
      write ? commands.storage(image, ImageRange::mip(1)) : commands.sampled(image, ImageRange::mip(0));
    });
    builder.sink(image);
    const CompiledGraph graph = compile_graph(builder);
    ASSERT_TRUE(runner->prepare(graph));
    EXPECT_DEATH(
        runner->run(graph, {}, {}),
        write ? "'halve' uses .*chain.mip 1.* storage_image_write or .* in step 1"
              : "'halve' uses .*chain.mip 0.* sampled_fragment or sampled_compute or sampled_graphics in step 1");
  }
}

TEST_F(Subresources, OneDrawReachesTheSixFacesOfACube) {
  for (const bool with_depth : {false, true}) {
    GraphBuilder builder;
    builder.begin_pass("draw faces");
    ImageHandle cube = builder.create(ImageDesc{.name = "cube",
                                                .format = rgba,
                                                .width_px = 4,
                                                .height_px = 4,
                                                .clear = {9, 9, 9, 9},
                                                .kind = ImageKind::cube,
                                                .layers = 6});
    cube = builder.write(cube, Access::color_attachment);
    ImageHandle depth;
    if (with_depth)
      depth = builder.write(builder.create(ImageDesc{.name = "depth",
                                                     .format = VK_FORMAT_D32_SFLOAT,
                                                     .width_px = 4,
                                                     .height_px = 4,
                                                     .clear = {0.35f},
                                                     .kind = ImageKind::d2_array,
                                                     .layers = 6}),
                            Access::depth_attachment);
    GraphicsPipelineDesc desc{
        .vertex_shader = "layered.vert", .fragment_shader = "layered.frag", .color_formats = {rgba}};
    if (with_depth) desc.depth_format = VK_FORMAT_D32_SFLOAT, desc.depth_test = desc.depth_write = true;
    const PipelineHandle pipeline = builder.pipeline(desc);
    const CommandList::Attachment target{cube};
    builder.end_pass([=](CommandList& commands) {
      commands.begin_rendering({&target, 1}, depth);
      commands.bind(pipeline);
      commands.draw(3, 6);
      commands.end_rendering();
    });
    // The directions of the faces in their order: +x, -x, +y, -y, +z, -z.
    const std::vector<glm::vec4> directions = {{1, 0.01f, 0.01f, 0},  {-1, 0.01f, 0.01f, 0}, {0.01f, 1, 0.01f, 0},
                                               {0.01f, -1, 0.01f, 0}, {0.01f, 0.01f, 1, 0},  {0.01f, 0.01f, -1, 0}};
    const auto values =
        texels(builder, add_samples(builder, cube, {}, ImageKind::cube, 2, SAMPLER_NEAREST_CLAMP, directions));
    ASSERT_EQ(values.size(), 6u);
    for (size_t face = 0; face < 6; ++face)
      EXPECT_EQ(values[face].x, with_depth && face < 3 ? 9 : float(face + 1))
          << "face " << face << ": each layer has its own depth";
  }
}

TEST_F(Subresources, AMipOfALayerIsAnAttachment) {
  GraphBuilder builder;
  builder.begin_pass("draw");
  ImageHandle image = builder.create(ImageDesc{.name = "array",
                                               .format = rgba,
                                               .width_px = 8,
                                               .height_px = 4,
                                               .clear = {7, 7, 7, 7},
                                               .kind = ImageKind::d2_array,
                                               .mips = 2,
                                               .layers = 3});
  const PipelineHandle pipeline = builder.pipeline(GraphicsPipelineDesc{.vertex_shader = "fullscreen.vert",
                                                                        .fragment_shader = "flat.frag",
                                                                        .color_formats = {rgba},
                                                                        .blend = Blend::additive});
  const std::pair<uint32_t, uint32_t> parts[] = {{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 1}, {1, 2}};  // mip, layer
  for (const auto& [mip, layer] : parts)
    image = builder.write(image, Access::color_attachment, ImageRange::layer(layer, mip));
  builder.end_pass([=](CommandList& commands) {
    for (const auto& [mip, layer] : parts) {
      const CommandList::Attachment target{image, {}, ImageRange::layer(layer, mip)};
      commands.begin_rendering({&target, 1}, {});
      commands.bind(pipeline);
      commands.push(glm::vec4(float(mip), float(layer), 0, 0));
      if (layer != 1) commands.draw(3);
      commands.end_rendering();
    }
  });
  const auto values = texels(builder, add_readback(builder, "array", image, (32 + 8) * 3 * sizeof(glm::vec4)));
  ASSERT_EQ(values.size(), 120u);
  size_t at = 0;
  for (const auto& [mip, layer] : parts)
    for (uint32_t i = 0; i < (mip ? 8u : 32u); ++i, ++at)
      ASSERT_EQ(values[at], glm::vec4(7, 7, 7, 7) + (layer != 1 ? glm::vec4(mip, layer, 0, 0) : glm::vec4(0)))
          << "mip " << mip << " layer " << layer << ": cleared once each, and drawn where it was drawn";
}

TEST_F(Subresources, AVolumeIsStoredAndSampled) {
  GraphBuilder builder;
  builder.begin_pass("fill volume");
  ImageHandle volume = builder.create(ImageDesc{.name = "volume",
                                                .format = rgba,
                                                .width_px = 8,
                                                .height_px = 4,
                                                .kind = ImageKind::d3,
                                                .mips = 2,
                                                .depth_px = 6});
  volume = builder.write(volume, Access::storage_image_write, ImageRange::mip(0));
  volume = builder.write(volume, Access::storage_image_write, ImageRange::mip(1));
  const PipelineHandle pipeline =
      builder.pipeline(ComputePipelineDesc{.shader = "fill_kinds.comp", .constants = {{0, "KIND", 4}}});
  builder.end_pass([=](CommandList& commands) {
    commands.bind(pipeline);
    for (const uint32_t mip : {0u, 1u}) {
      const glm::uvec3 size = commands.size_3d(volume, mip);
      commands.push(KindPush{commands.storage(volume, ImageRange::mip(mip)), float(10 * mip), size});
      commands.dispatch(size.x, size.y, size.z);
    }
  });
  // Between the centres of texels (2, 1, 3) and (3, 2, 4), and in the smaller mip.
  const BufferHandle big = add_samples(builder, volume, ImageRange::mip(0), ImageKind::d3, 4, SAMPLER_LINEAR_CLAMP,
                                       {{3.0f / 8, 2.0f / 4, 4.0f / 6, 0}});
  const BufferHandle small =
      add_samples(builder, volume, {}, ImageKind::d3, 4, SAMPLER_NEAREST_CLAMP, {{2.5f / 4, 1.5f / 2, 2.5f / 3, 0}}, 1);
  const auto of_big = texels(builder, big), of_small = texels(builder, small);
  ASSERT_EQ(of_big.size(), 1u);
  ASSERT_EQ(of_small.size(), 1u);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(of_big[0][i], glm::vec4(0, 2.5f, 1.5f, 3.5f)[i], 0.02f);
  EXPECT_EQ(of_small[0], glm::vec4(10, 2, 1, 2));
}

TEST_F(Subresources, SamplersClampRepeatAndFilter) {
  GraphBuilder builder;
  const ImageHandle image = add_filled(builder, {.name = "ramp", .format = rgba, .width_px = 4, .height_px = 4}, 1);
  const std::vector<glm::vec4> places = {{0.5f, 0.5f, 0, 0}, {1.125f, 0.125f, 0, 0}, {-0.4f, 0.125f, 0, 0}};
  std::map<uint32_t, BufferHandle> buffers;
  for (uint32_t sampler = SAMPLER_LINEAR_CLAMP; sampler <= SAMPLER_NEAREST_REPEAT; ++sampler)
    buffers[sampler] = add_samples(builder, image, {}, ImageKind::d2, 0, sampler, places);
  const auto x_of = [&](uint32_t sampler, size_t place) { return texels(builder, buffers[sampler]).at(place).y; };
  EXPECT_NEAR(x_of(SAMPLER_LINEAR_CLAMP, 0), 1.5f, 0.02f);
  EXPECT_EQ(x_of(SAMPLER_NEAREST_CLAMP, 0), 2);
  EXPECT_EQ(x_of(SAMPLER_NEAREST_CLAMP, 1), 3);
  EXPECT_EQ(x_of(SAMPLER_NEAREST_REPEAT, 1), 0);
  EXPECT_EQ(x_of(SAMPLER_LINEAR_CLAMP, 1), 3);
  EXPECT_NEAR(x_of(SAMPLER_LINEAR_REPEAT, 1), 0, 0.02f);
  EXPECT_EQ(x_of(SAMPLER_NEAREST_REPEAT, 2), 2);
  EXPECT_EQ(x_of(SAMPLER_NEAREST_CLAMP, 2), 0);
}

// Depth is reversed: a receiver at least as near to the light as what the map holds is lit.
TEST_F(Subresources, AShadowSamplerCompares) {
  GraphBuilder builder;
  builder.begin_pass("draw depth");
  ImageHandle maps = builder.create(ImageDesc{.name = "maps",
                                              .format = VK_FORMAT_D32_SFLOAT,
                                              .width_px = 4,
                                              .height_px = 4,
                                              .clear = {0.75f},
                                              .kind = ImageKind::d2_array,
                                              .layers = 2});
  maps = builder.write(maps, Access::depth_attachment, ImageRange::layer(1));
  builder.end_pass([=](CommandList& commands) {
    commands.begin_rendering({}, maps);
    commands.end_rendering();
  });
  const BufferHandle buffer =
      add_samples(builder, maps, ImageRange::layer(1), ImageKind::d2, 5, SAMPLER_SHADOW_LINEAR,
                  {{0.5f, 0.5f, 0.7f, 0}, {0.5f, 0.5f, 0.75f, 0}, {0.5f, 0.5f, 0.8f, 0}, {2.0f, -1.0f, 0.8f, 0}});
  const auto values = texels(builder, buffer);
  ASSERT_EQ(values.size(), 4u);
  EXPECT_EQ(values[0].x, 0);
  EXPECT_EQ(values[1].x, 1);
  EXPECT_EQ(values[2].x, 1);
  EXPECT_EQ(values[3].x, 1) << "clamped";
}

TEST_F(Subresources, AStorageImageIsReadAndWritten) {
  GraphBuilder builder;
  ImageHandle image = add_filled(builder, {.name = "sum", .format = rgba, .width_px = 6, .height_px = 5, .mips = 2}, 4,
                                 ImageRange::mip(1));
  builder.begin_pass("add");
  const PipelineHandle pipeline =
      builder.pipeline(ComputePipelineDesc{.shader = "fill_kinds.comp", .constants = {{0, "KIND", 0}}});
  for (int i = 0; i < 3; ++i) {
    builder.begin_step();
    image = builder.write(image, Access::storage_image_read_write, ImageRange::mip(1));
  }
  builder.end_pass([=](CommandList& commands) {
    const glm::uvec3 size = commands.size_3d(image, 1);
    commands.bind(pipeline);
    commands.push(KindPush{commands.storage(image), float(commands.step() + 1), size});
    commands.dispatch(size.x, size.y);
  });
  builder.begin_pass("read back");
  builder.read(image, Access::transfer_source, "sum", ImageRange::mip(1));
  const BufferHandle buffer = builder.write(
      builder.create(BufferDesc{.name = "bytes", .size_bytes = 6 * 16, .memory = BufferMemory::host_read}),
      Access::transfer_destination);
  builder.end_pass([=](CommandList& commands) { commands.copy_to_buffer(image, buffer); });
  builder.sink(buffer);
  const auto values = texels(builder, buffer);
  ASSERT_EQ(values.size(), 6u) << "3 x 2 texels";
  for (uint32_t i = 0; i < 6; ++i) EXPECT_EQ(values[i], glm::vec4(10, i % 3 + 6, i / 3 + 6, 7));
}

// A cube is stored to as an array, one face of it is seen as 2D, all as an array.
TEST_F(Subresources, OneImageIsSeenInSeveralWays) {
  GraphBuilder builder;
  builder.begin_pass("fill cube");
  ImageHandle cube = builder.create(
      ImageDesc{.name = "cube", .format = rgba, .width_px = 4, .height_px = 4, .kind = ImageKind::cube, .layers = 6});
  cube = builder.write(cube, Access::storage_image_write);
  const PipelineHandle pipeline =
      builder.pipeline(ComputePipelineDesc{.shader = "fill_kinds.comp", .constants = {{0, "KIND", 1}}});
  builder.end_pass([=](CommandList& commands) {
    commands.bind(pipeline);
    commands.push(KindPush{commands.storage(cube), 5, {4, 4, 6}});
    commands.dispatch(4, 4, 6);
  });
  const BufferHandle face =
      add_samples(builder, cube, ImageRange::layer(4), ImageKind::d2, 0, SAMPLER_NEAREST_CLAMP, {{0.9f, 0.1f, 0, 0}});
  const BufferHandle array = add_samples(builder, cube, {}, ImageKind::d2_array, 1, SAMPLER_NEAREST_CLAMP,
                                         {{0.9f, 0.1f, 2, 0}, {0.1f, 0.9f, 5, 0}});
  const BufferHandle whole_cube =
      add_samples(builder, cube, {}, ImageKind::cube, 2, SAMPLER_NEAREST_CLAMP, {{-1, 0, 0, 0}, {0, 0, -1, 0}});
  EXPECT_EQ(texels(builder, face).at(0), glm::vec4(5, 3, 0, 4));
  EXPECT_EQ(texels(builder, array).at(0), glm::vec4(5, 3, 0, 2));
  EXPECT_EQ(texels(builder, array).at(1), glm::vec4(5, 0, 3, 5));
  EXPECT_EQ(texels(builder, whole_cube).at(0).w, 1);
  EXPECT_EQ(texels(builder, whole_cube).at(1).w, 5);
}

// One frame fills a cube, and others sample it, copy it and sample it again, whether outputs are hashed or not.
TEST_F(Subresources, AKeptImageOutlivesItsFrame) {
  const ImageDesc desc{
      .name = "sky", .format = rgba, .width_px = 4, .height_px = 4, .kind = ImageKind::cube, .mips = 2, .layers = 6};
  const KeptImage kept(*device, desc, VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
  EXPECT_GE(kept.bytes(), 6 * (16 + 4) * 16u);
  const std::vector<glm::vec4> directions = {{1, 0, 0, 0},  {-1, 0, 0, 0}, {0, 1, 0, 0},
                                             {0, -1, 0, 0}, {0, 0, 1, 0},  {0, 0, -1, 0}};
  const KeptKeys to_fill{.filled = {}, .seen = {{1, 2}}};
  const auto sampled = [&](GraphBuilder& builder, ImageHandle sky, float lod, bool hashed) {
    const BufferHandle buffer =
        add_samples(builder, sky, {}, ImageKind::cube, 2, SAMPLER_NEAREST_CLAMP, directions, lod);
    const CompiledGraph graph = compile_graph(builder, to_fill);
    const FrameRun result = run(graph, {.hash_outputs = hashed, .images = {{sky.resource, &kept}}});
    return values_of<glm::vec4>(*result.readbacks.at(buffer.resource));
  };
  for (const float value : {1.0f, 10.0f}) {  // filled anew: nothing of the old stays
    GraphBuilder builder;
    builder.begin_pass("fill");
    ImageHandle sky = builder.create(desc);
    for (uint32_t mip = 0; mip < 2; ++mip)
      for (uint32_t face = 0; face < 6; ++face) {
        const Access access = mip == 0 ? Access::transfer_destination : Access::color_attachment;
        sky = builder.write(sky, access, ImageRange::layer(face, mip));
      }
    builder.end_pass([=](CommandList& commands) {
      for (uint32_t face = 0; face < 6; ++face) {
        commands.clear_image(sky, glm::vec4(value + float(face)), ImageRange::layer(face, 0));
        commands.begin_rendering(std::array{CommandList::Attachment{sky, {}, ImageRange::layer(face, 1)}}, {});
        commands.end_rendering();
      }
    });
    builder.keep(sky, {1, 2}, "kept");
    const auto values = sampled(builder, sky, 0, value > 1);
    for (size_t face = 0; face < 6; ++face) EXPECT_EQ(values.at(face).x, value + float(face));
  }
  for (const bool hashed : {false, true, false}) {
    GraphBuilder builder;
    const ImageHandle sky = builder.import_image(desc);
    const BufferHandle face = add_readback(builder, "faces", sky, 6 * (16 + 4) * 16);
    const auto values = sampled(builder, sky, hashed ? 1 : 0, hashed);
    for (size_t i = 0; i < 6; ++i) EXPECT_EQ(values.at(i).x, hashed ? 0 : 10 + float(i));
    const FrameRun result = run(compile_graph(builder), {.images = {{sky.resource, &kept}}});
    const auto copied = values_of<glm::vec4>(*result.readbacks.at(face.resource));
    EXPECT_EQ(copied.at(5 * 16 + 15).x, 15);
    EXPECT_EQ(copied.at(6 * 16).x, 0);
  }
  GraphBuilder builder;
  const ImageHandle sky = builder.import_image(desc);
  add_samples(builder, sky, {}, ImageKind::cube, 2, SAMPLER_NEAREST_CLAMP, directions);
  const CompiledGraph graph = compile_graph(builder);
  ASSERT_TRUE(runner->prepare(graph));
  EXPECT_DEATH(runner->run(graph, {}, {}), "given for the import 'sky'");
}

// The one used longest ago goes first; what is being used stays alive.
TEST_F(Subresources, TheCacheKeepsToItsBudget) {
  const ImageDesc desc{.name = "entry", .format = rgba, .width_px = 64, .height_px = 64};
  const auto key = [](int i) { return Hash128{uint64_t(i), 7}; };
  const uint64_t each = KeptImage(*device, desc, VK_IMAGE_USAGE_TRANSFER_DST_BIT).bytes();
  ImageCache cache(*device, 2 * each + each / 2);
  const auto insert = [&](int i) { cache.insert(key(i), cache.make(desc, VK_IMAGE_USAGE_TRANSFER_DST_BIT)); };
  const auto keys_of = [](const ImageCache& of) {
    KeptKeys keys;
    of.keys(keys);
    return keys;
  };
  const auto is_seen = [&](int i) { return keys_of(cache).seen.contains(key(i)); };
  const auto is_filled = [&](int i) { return keys_of(cache).filled.contains(key(i)); };
  EXPECT_FALSE(is_seen(1) || is_filled(1));
  cache.used(key(1), desc);
  EXPECT_TRUE(is_seen(1) && !is_filled(1));
  insert(1), insert(2);
  EXPECT_TRUE(is_filled(1) && !is_seen(1));
  cache.used(key(1), desc);
  const std::shared_ptr<KeptImage> held = cache.find(key(2));
  insert(3);
  EXPECT_EQ(cache.size(), 2u);
  EXPECT_LE(cache.used_bytes(), cache.budget_bytes());
  EXPECT_TRUE(cache.find(key(1)) && cache.find(key(3)));
  EXPECT_EQ(cache.find(key(2)), nullptr);
  EXPECT_NE(held->view({0, {0, 1, 0, 1}, ImageKind::d2, false}), VK_NULL_HANDLE);
  ImageCache small(*device, each - 1);
  small.insert(key(1), small.make(desc, VK_IMAGE_USAGE_TRANSFER_DST_BIT));
  EXPECT_EQ(small.size(), 0u);
  ImageDesc large = desc;
  large.width_px = 1024;
  small.used(key(9), large);
  EXPECT_TRUE(keys_of(small).seen.empty()) << "never fits";
}

}  // namespace candela::gpu::test::graph_subresources
