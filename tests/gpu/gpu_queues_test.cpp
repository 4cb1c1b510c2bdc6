#include "gpu/device_select.h"
#include "gpu_fixture.h"
#include "graph/queues.h"

namespace candela::gpu::test::gpu_queues {
namespace {

constexpr uint32_t width = 32, height = 8, threads = 1 << 14;

// Copies the first channel of an image into a new one.
ImageHandle add_copy(GraphBuilder& builder, const std::string& name, Queue queue, ImageHandle source) {
  builder.begin_pass(name, queue);
  builder.read(source, Access::sampled_compute, "source");
  ImageHandle image = builder.create(
      ImageDesc{.name = name, .format = VK_FORMAT_R32G32B32A32_SFLOAT, .width_px = width, .height_px = height});
  image = builder.write(image, Access::storage_image_write);
  const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "depth_to_image.comp"});
  builder.end_pass([=](CommandList& commands) {
    struct {
      uint32_t source, image, width, height;
    } const push{commands.sampled(source), commands.storage(image), width, height};
    commands.bind(pipeline);
    commands.push(push);
    commands.dispatch(width, height);
  });
  return image;
}

BufferHandle add_copy_back(GraphBuilder& builder, const std::string& name, Queue queue, BufferHandle source) {
  builder.begin_pass("copy " + name, queue);
  builder.read(source, Access::compute_read, name);
  BufferHandle target = builder.create(
      BufferDesc{.name = name + " copied", .size_bytes = threads * 4, .memory = BufferMemory::host_read});
  target = builder.write(target, Access::compute_write);
  const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "copy_words.comp"});
  builder.end_pass([=](CommandList& commands) {
    struct {
      uint64_t source, target;
      uint32_t count, unused;
    } const push{commands.address(source), commands.address(target), threads, 0};
    commands.bind(pipeline);
    commands.push(push);
    commands.dispatch(threads);
  });
  builder.sink(target);
  return target;
}

struct Mixed {
  CompiledGraph graph;
  std::vector<BufferHandle> results;
};
// Images and buffers that cross from queue to queue and back, images of one queue alone that share memory, and a
// zeroed buffer; `other` is the second queue, or the main one.
Mixed mixed_frame(Queue other, float value, uint32_t rounds = 50) {
  GraphBuilder builder;
  const ImageHandle seed = add_fill(builder, "seed", width, height, value);
  const ImageHandle left = add_copy(builder, "left", other, seed);
  ImageHandle right = add_copy(builder, "right", Queue::main, seed);
  const BufferHandle words = add_hash(builder, "hash", threads, rounds, other);
  const ImageHandle crossed = add_copy(builder, "crossed", other, right);
  right = add_copy(builder, "right again", Queue::main, right);
  const ImageHandle back = add_copy(builder, "back", Queue::main, add_copy(builder, "left again", other, left));
  Mixed mixed;
  for (const auto& [name, image] : {std::pair("crossed", crossed), std::pair("right", right), std::pair("back", back)})
    mixed.results.push_back(add_readback(builder, name, image, width * height * 16));
  mixed.results.push_back(add_copy_back(builder, "words", Queue::main, words));
  const BufferHandle own = add_hash(builder, "main hash", threads, rounds);
  mixed.results.push_back(add_copy_back(builder, "main words", other, own));
  mixed.graph = compile_graph(builder);
  return mixed;
}

std::vector<std::vector<std::byte>> bytes_of(const Mixed& mixed, const FrameRun& run) {
  std::vector<std::vector<std::byte>> bytes;
  for (const BufferHandle result : mixed.results) {
    const auto found = run.readbacks.at(result.resource)->bytes();
    bytes.emplace_back(found.begin(), found.end());
  }
  return bytes;
}

VkQueueFamilyProperties family(VkQueueFlags flags, uint32_t count) {
  VkQueueFamilyProperties properties{};
  properties.queueFlags = flags;
  properties.queueCount = count;
  properties.timestampValidBits = 64;
  return properties;
}

}  // namespace

TEST(ChooseQueues, TakesAFamilyWithoutGraphicsThenASecondQueueOfTheSame) {
  constexpr VkQueueFlags all = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT | VK_QUEUE_TRANSFER_BIT;
  const auto chosen = [](std::vector<VkQueueFamilyProperties> families) {
    Candidate candidate;
    EXPECT_TRUE(choose_queues(families, candidate));
    return candidate;
  };
  const Candidate lone = chosen({family(all, 1)});
  EXPECT_FALSE(lone.second_queue);
  EXPECT_EQ(lone.compute_family, lone.queue_family);
  EXPECT_EQ(lone.compute_index, 0u);
  const Candidate twin = chosen({family(VK_QUEUE_TRANSFER_BIT, 2), family(all, 16)});
  EXPECT_TRUE(twin.second_queue);
  EXPECT_EQ(twin.queue_family, 1u);
  EXPECT_EQ(twin.compute_family, 1u);
  EXPECT_EQ(twin.compute_index, 1u);
  const Candidate apart = chosen(
      {family(all, 16), family(VK_QUEUE_TRANSFER_BIT, 2), family(VK_QUEUE_COMPUTE_BIT | VK_QUEUE_TRANSFER_BIT, 8)});
  EXPECT_TRUE(apart.second_queue);
  EXPECT_EQ(apart.queue_family, 0u);
  EXPECT_EQ(apart.compute_family, 2u);
  EXPECT_EQ(apart.compute_index, 0u);
  Candidate none;
  const VkQueueFamilyProperties transfer = family(VK_QUEUE_TRANSFER_BIT, 1);
  EXPECT_FALSE(choose_queues({&transfer, 1}, none));
}

class Queues : public GpuTest {};

// lavapipe has one queue: the partial order of the batches is every order in which they may be submitted to it.
TEST_F(Queues, EveryAllowedOrderOfSubmissionsGivesTheSameBytes) {
  const Mixed alone = mixed_frame(Queue::main, 2);
  ASSERT_TRUE(alone.graph.plan.batches.empty());
  const auto wanted = bytes_of(alone, run(alone.graph));
  const Mixed mixed = mixed_frame(Queue::compute, 2);
  ASSERT_GE(mixed.graph.plan.batches.size(), 4u);
  const auto orders = batch_orders(mixed.graph.plan, 40);
  ASSERT_GE(orders.size(), 3u);
  for (const std::vector<int>& order : orders)
    EXPECT_EQ(bytes_of(mixed, run(mixed.graph, {.batch_order = order})), wanted) << ::testing::PrintToString(order);
  EXPECT_EQ(bytes_of(mixed, run(mixed.graph, {.one_queue = true})), wanted);
}

TEST_F(Queues, TimedAndHashedRunsAreSerialAndGiveTheSameBytes) {
  const Mixed alone = mixed_frame(Queue::main, 3), mixed = mixed_frame(Queue::compute, 3);
  const FrameRun wanted = run(alone.graph, {.hash_outputs = true});
  const FrameRun timed = run(mixed.graph, {.timed = true}), hashed = run(mixed.graph, {.hash_outputs = true});
  EXPECT_EQ(timed.passes.size(), mixed.graph.plan.passes.size());
  EXPECT_EQ(bytes_of(mixed, timed), bytes_of(alone, wanted));
  EXPECT_EQ(bytes_of(mixed, hashed), bytes_of(alone, wanted));
  ASSERT_EQ(hashed.hashes.size(), wanted.hashes.size());
  for (size_t i = 0; i < hashed.hashes.size(); ++i) {
    EXPECT_EQ(hashed.hashes[i].pass, wanted.hashes[i].pass);
    EXPECT_EQ(hashed.hashes[i].hash, wanted.hashes[i].hash) << hashed.hashes[i].pass;
  }
}

TEST_F(Queues, FramesInFlightKeepTheirOrder) {
  std::vector<std::vector<std::vector<std::byte>>> wanted;
  std::vector<Mixed> frames;
  for (int frame = 0; frame < 4; ++frame) {
    frames.push_back(mixed_frame(Queue::compute, float(frame)));
    wanted.push_back(bytes_of(frames.back(), run(frames.back().graph)));
  }
  std::vector<FrameTicket> tickets;
  for (const Mixed& frame : frames) {
    ASSERT_TRUE(runner->prepare(frame.graph));
    tickets.push_back(runner->submit(frame.graph, {}, {}));
  }
  for (size_t frame = 0; frame < frames.size(); ++frame)
    EXPECT_EQ(bytes_of(frames[frame], runner->collect(tickets[frame])), wanted[frame]);
}

TEST_F(Queues, TheWholeFrameIsTimed) {
  for (const Mixed& frame : {mixed_frame(Queue::main, 1), mixed_frame(Queue::compute, 1)}) {
    const FrameRun result = run(frame.graph, {.whole = true});
    EXPECT_GT(result.whole_ms, 0);
    EXPECT_TRUE(result.passes.empty());
  }
}

// On a device that has a second queue: work of both at once gives what one queue gives. What it saves is told, not
// judged.
TEST_F(Queues, ASecondQueueGivesTheSameBytes) {
  if (!device->has_second_queue()) GTEST_SKIP() << device->info().name << " has one queue";
  const uint32_t rounds = 200000;
  const Mixed alone = mixed_frame(Queue::main, 5, rounds), mixed = mixed_frame(Queue::compute, 5, rounds);
  const auto wanted = bytes_of(alone, run(alone.graph));
  double both_ms = 0, one_ms = 0;
  for (int round = 0; round < 20; ++round) {
    const FrameRun both = run(mixed.graph, {.whole = true}), one = run(mixed.graph, {.whole = true, .one_queue = true});
    ASSERT_EQ(bytes_of(mixed, both), wanted) << "round " << round;
    ASSERT_EQ(bytes_of(mixed, one), wanted) << "round " << round;
    both_ms += both.whole_ms / 20;
    one_ms += one.whole_ms / 20;
  }
  RecordProperty("both_queues_ms", fmt::format("{:.3f}", both_ms));
  RecordProperty("one_queue_ms", fmt::format("{:.3f}", one_ms));
  fmt::print("both queues {:.3f} ms, one queue {:.3f} ms\n", both_ms, one_ms);

  auto single = Device::open({.which = "", .validate = true, .queues = 1});
  ASSERT_TRUE(single) << single.error().text();
  EXPECT_FALSE((*single)->has_second_queue());
}

}  // namespace candela::gpu::test::gpu_queues
