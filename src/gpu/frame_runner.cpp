#include "gpu/frame_runner.h"

#include <array>

#include "base/check.h"
#include "gpu/command_list_impl.h"
#include "gpu/frame_hash.h"
#include "gpu/frame_slot.h"
#include "gpu/physical.h"
#include "gpu/pipelines.h"
#include "gpu/queue_work.h"
#include "gpu/timing.h"

namespace candela::gpu {

namespace {

// Recognisable bytes for what no one wrote yet, while hashing: the same in every run, and wrong enough to be seen.
constexpr uint32_t poison = 0xcdcdcdcd;

// Where the frame begins (0) or ends (1) on the device.
void mark_span(const FrameSlot& slot, VkCommandBuffer commands, uint32_t end) {
  if (slot.pending->spans_at > 0) slot.timing.mark_end(commands, slot.pending->spans_at + end);
}

}  // namespace

struct FrameRunner::Hidden {
  Device& device;
  Bindless& bindless;
  Pipelines pipelines;
  std::shared_ptr<ReadbackPool> readbacks = std::make_shared<ReadbackPool>();
  OutputHasher hasher;
  // A plan with its pipelines, images and buffers.
  struct Prepared {
    std::optional<Hash128> plan;       // hash of the plan that all of it belongs to
    std::optional<Hash128> allocated;  // physical_key of what `physical` holds
    std::shared_ptr<Physical> physical;
    std::vector<const Pipeline*> pipelines;
    bool copyable = false;
  };
  Prepared now;                 // of the last frame; frames in flight own their `physical` too
  Prepared other;               // of the frames before, where they come again
  std::optional<Hash128> gone;  // the plan that `now` took the place of
  std::array<uint32_t, 3> max_groups{};
  FrameTicket last_ticket = 0;
  QueueTimelines timelines;
  std::vector<std::unique_ptr<FrameSlot>> slots;  // as many as frames were ever in flight at once

  Hidden(Device& d, Bindless& b, glsl::ShaderCompiler compiler, std::filesystem::path cache_folder)
      : device(d),
        bindless(b),
        pipelines(d, b, std::move(compiler), std::move(cache_folder)),
        hasher(d, b, pipelines),
        timelines(d) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(d.physical(), &properties);
    std::copy_n(properties.limits.maxComputeWorkGroupCount, 3, max_groups.begin());
  }

  void rebuild(const FramePlan& plan, bool to_copy, double timeout_s);
  bool in_flight() const;
  void finish_all(double timeout_s);
  FrameSlot& take_slot();
  FrameContext context(const FramePlan& plan, const Imports& imports, const RunOptions& options, FrameSlot& slot);
  void fill_buffers(const FrameContext& frame, VkCommandBuffer commands, bool hashing) const;
  void record_pass(const FrameContext& frame, const CompiledGraph& graph, size_t pass, VkCommandBuffer commands) const;
  void submit_whole(const FrameContext& frame, const CompiledGraph& graph, const RunOptions& options, FrameSlot& slot);
  void submit_batches(const FrameContext& frame, const CompiledGraph& graph, const RunOptions& options,
                      FrameSlot& slot);
  void read_times(const FramePlan& plan, const RunOptions& options, FrameSlot& slot) const;
  void run_isolated(const FrameContext& frame, const CompiledGraph& graph, const RunOptions& options, double timeout_s,
                    FrameSlot& slot);
};

FrameRunner::FrameRunner(Device& device, Bindless& bindless, glsl::ShaderCompiler compiler,
                         std::filesystem::path cache_folder)
    : hidden_(std::make_unique<Hidden>(device, bindless, std::move(compiler), std::move(cache_folder))) {}
FrameRunner::~FrameRunner() = default;

bool FrameRunner::is_compiled(const CompiledGraph& graph) const {
  const Hidden& h = *hidden_;
  return h.now.plan == graph.hash || h.other.plan == graph.hash || h.pipelines.hold(graph.plan.pipelines);
}

Expected<PrepareTimes> FrameRunner::compile(const CompiledGraph& graph) {
  PrepareTimes times;
  if (auto pipelines = hidden_->pipelines.get(graph.plan.pipelines, times); !pipelines)
    return std::unexpected(pipelines.error());
  return times;
}

bool FrameRunner::allocate(const CompiledGraph& graph) {
  Hidden& h = *hidden_;
  if (h.now.plan == graph.hash) return false;
  if (h.other.plan == graph.hash) {
    std::swap(h.now, h.other);
    return false;
  }
  if (h.now.allocated == physical_key(graph.plan)) return false;
  h.readbacks->trim();
  // A plan that comes again has another beside it from then on, until a third comes.
  const bool comes_again = h.gone == graph.hash && h.now.plan && !h.now.copyable;
  h.gone = h.now.plan;
  if (comes_again)
    std::swap(h.now, h.other);
  else
    h.other = {};
  h.rebuild(graph.plan, false, timeout_s);
  return true;
}

Expected<PrepareTimes> FrameRunner::prepare(const CompiledGraph& graph) {
  PrepareTimes times;
  Hidden& h = *hidden_;
  Stopwatch watch;
  times.allocated = allocate(graph);
  if (times.allocated) times.allocate_ms = watch.lap_ms();
  if (h.now.plan == graph.hash) return times;
  h.now.plan.reset();
  auto pipelines = h.pipelines.get(graph.plan.pipelines, times);
  if (!pipelines) return std::unexpected(pipelines.error());
  h.now.pipelines = std::move(*pipelines);
  h.now.plan = graph.hash;
  return times;
}

// Frames in flight keep what they use; without any, the old goes before the new is made. A rebuild that throws, for
// want of memory, leaves nothing allocated.
void FrameRunner::Hidden::rebuild(const FramePlan& plan, bool to_copy, double timeout_s) {
  now.plan.reset();
  now.allocated.reset();
  now.physical.reset();
  const auto make = [&] {
    auto made = std::make_shared<Physical>(device, bindless);
    made->rebuild(plan, to_copy);
    return made;
  };
  try {
    now.physical = make();
  } catch (const GpuError& error) {
    // Two plans' images do not fit beside each other: then one after the other.
    if (!error.out_of_memory() || !(in_flight() || other.physical)) throw;
    other = {};
    finish_all(timeout_s);
    now.physical = make();
  }
  now.copyable = to_copy;
  now.allocated = physical_key(plan);
}

bool FrameRunner::Hidden::in_flight() const {
  return std::any_of(slots.begin(), slots.end(), [](const auto& slot) { return slot->work.pending(); });
}

// What they left waits for collect.
void FrameRunner::Hidden::finish_all(double timeout_s) {
  for (const auto& slot : slots) {
    slot->wait_if_given_up();
    if (slot->pending) slot->finish(timeout_s);
  }
}

FrameSlot& FrameRunner::Hidden::take_slot() {
  for (const auto& slot : slots) slot->wait_if_given_up();
  for (const auto& slot : slots)
    if (!slot->pending) return *slot;
  slots.push_back(std::make_unique<FrameSlot>(device, timelines, slots.size()));
  return *slots.back();
}

FrameContext FrameRunner::Hidden::context(const FramePlan& plan, const Imports& imports, const RunOptions& options,
                                          FrameSlot& slot) {
  FrameContext frame{device,    bindless,      plan,          *now.physical, slot.buffers,
                     slot.kept, slot.barriers, now.pipelines, max_groups,    slot.index};
  frame.buffers.assign(plan.resources.size(), nullptr);
  frame.kept.assign(plan.resources.size(), nullptr);
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    const PlanResource& resource = plan.resources[i];
    if (resource.first_pass < 0) continue;
    if (resource.is_image()) {
      if (!resource.imported) continue;
      const KeptImage* const found = options.images.find(int(i));
      CHECK_MSG(found && (resource.image_usage &
                          ~(found->usage() | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT)) == 0,
                fmt::format("no image, or one of too few usages, is given for the import '{}'", resource.name()));
      frame.kept[i] = found;
      continue;
    }
    const auto& desc = std::get<BufferDesc>(resource.desc);
    if (resource.imported) {
      const Buffer* const found = imports.find(int(i));
      CHECK_MSG(found && found->size() >= desc.size_bytes,
                fmt::format("no buffer, or one too small, is given for the import '{}'", desc.name));
      frame.buffers[i] = found;
    } else if (resource.lifetime == Lifetime::readback) {
      const VkBufferUsageFlags usage =
          resource.buffer_usage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
      auto pooled = readbacks->take(device, desc.size_bytes, usage, desc.name);
      frame.buffers[i] = &pooled->buffer();
      slot.pending->readbacks.emplace_back(int(i), std::move(pooled));
    } else {
      frame.buffers[i] = &now.physical->buffer(int(i));
    }
  }
  return frame;
}

void FrameRunner::Hidden::fill_buffers(const FrameContext& frame, VkCommandBuffer commands, bool hashing) const {
  bool filled = false;
  for (size_t i = 0; i < frame.plan.resources.size(); ++i) {
    const PlanResource& resource = frame.plan.resources[i];
    if (!frame.buffers[i] || resource.imported) continue;
    const bool zeroed = std::get<BufferDesc>(resource.desc).zeroed;
    if (!zeroed && !hashing) continue;
    VkDeviceSize first = 0, bytes = VK_WHOLE_SIZE;
    if (frame.physical.has_pages(int(i))) {
      const uint64_t row = std::get<BufferDesc>(resource.desc).row_bytes;
      first = uint64_t(resource.resident->y) * row, bytes = uint64_t(resource.resident->height) * row;
    }
    vkCmdFillBuffer(commands, frame.buffers[i]->handle(), first, bytes, zeroed ? 0 : poison);
    filled = true;
  }
  if (filled) full_barrier(commands);
}

void FrameRunner::Hidden::record_pass(const FrameContext& frame, const CompiledGraph& graph, size_t pass,
                                      VkCommandBuffer commands) const {
  device.begin_label(commands, graph.plan.passes[pass].name);
  record_steps(frame, pass, graph.record[pass], commands);
  device.end_label(commands);
}

void FrameRunner::Hidden::submit_whole(const FrameContext& frame, const CompiledGraph& graph, const RunOptions& options,
                                       FrameSlot& slot) {
  const uint32_t passes = uint32_t(graph.plan.passes.size());
  FrameRun& result = slot.pending->result;
  Stopwatch watch;
  VkCommandBuffer commands = slot.work.begin();
  slot.timing.reset(passes + 3);
  if (options.spans && slot.timing.available()) slot.pending->spans_at = passes + 1;
  const auto stamp = [&](uint32_t index) {
    if (options.timed)
      slot.timing.post(commands, index);
    else if (slot.timing.available())
      slot.timing.mark(commands, index);
  };
  if (frame.after_another) full_barrier(commands);  // its images and buffers are the frame before's
  mark_span(slot, commands, 0);
  stamp(0);
  fill_buffers(frame, commands, false);
  for (uint32_t pass = 0; pass < passes; ++pass) {
    record_pass(frame, graph, pass, commands);
    if (pass + 1 < passes || options.timed) stamp(pass + 1);
  }
  record_barriers(frame, graph.plan.final_barriers, commands);
  mark_span(slot, commands, 1);
  result.record_ms = watch.lap_ms();
  slot.work.submit();
  result.submit_ms = watch.lap_ms();
}

// A command buffer for each batch, and around them one that fills buffers and one that ends the frame. The first waits
// for the frame before, and every other, by the order of its queue or by what it waits for, for the first.
void FrameRunner::Hidden::submit_batches(const FrameContext& frame, const CompiledGraph& graph,
                                         const RunOptions& options, FrameSlot& slot) {
  const FramePlan& plan = graph.plan;
  const uint32_t passes = uint32_t(plan.passes.size());
  FrameRun& result = slot.pending->result;
  Stopwatch watch;
  slot.work.restart();
  slot.timing.reset(passes + 4);
  if (options.spans && slot.timing.available()) slot.pending->spans_at = passes + 2;
  const bool whole = options.whole && slot.timing.available();
  QueueWork::Point filled, ended;
  VkCommandBuffer commands = slot.work.add(Queue::main, {}, filled);
  if (frame.after_another) full_barrier(commands);
  mark_span(slot, commands, 0);
  if (whole) slot.timing.post(commands, passes);
  fill_buffers(frame, commands, false);

  static const QueueBatch all_passes{};
  const bool whole_plan = plan.batches.empty();
  const size_t batches = whole_plan ? 1 : plan.batches.size();
  slot.reached.assign(batches, {});
  std::array<std::optional<QueueWork::Point>, 2> last;
  const auto record = [&](uint32_t pass, bool marks) {
    if (marks) slot.timing.mark(commands, pass);
    record_pass(frame, graph, pass, commands);
  };
  for (size_t i = 0; i < batches; ++i) {
    const size_t index = i < options.batch_order.size() ? size_t(options.batch_order[i]) : i;
    const QueueBatch& batch = whole_plan ? all_passes : plan.batches[index];
    slot.waits.clear();
    if (!last[size_t(batch.queue)]) slot.waits.push_back(filled);
    for (const int wait : batch.waits) slot.waits.push_back(slot.reached[size_t(wait)]);
    QueueWork::Point& point = slot.reached[index];
    commands = slot.work.add(options.one_queue ? Queue::main : batch.queue, slot.waits, point);
    last[size_t(batch.queue)] = point;
    const bool marks = slot.timing.available() && (point.queue == Queue::main || device.compute_timestamps());
    for (uint32_t pass = 0; whole_plan && pass < passes; ++pass) record(pass, marks);
    for (const int pass : batch.passes) record(uint32_t(pass), marks);
  }
  slot.waits.clear();
  for (const auto& point : last)
    if (point) slot.waits.push_back(*point);
  commands = slot.work.add(Queue::main, slot.waits, ended);
  record_barriers(frame, plan.final_barriers, commands);
  if (whole) slot.timing.post(commands, passes + 1);
  mark_span(slot, commands, 1);
  result.record_ms = watch.lap_ms();
  slot.work.submit();
  result.submit_ms = watch.lap_ms();
}

void FrameRunner::Hidden::read_times(const FramePlan& plan, const RunOptions& options, FrameSlot& slot) const {
  const uint32_t passes = uint32_t(plan.passes.size());
  FrameRun& result = slot.pending->result;
  for (uint32_t pass = 0; options.timed && pass < passes; ++pass)
    result.passes.push_back({plan.passes[pass].name, slot.timing.between_ms(pass, pass + 1)});
  if (options.whole)
    result.whole_ms = device.info().is_cpu || !slot.timing.available() ? result.submit_ms + result.wait_ms
                                                                       : slot.timing.between_ms(passes, passes + 1);
}

// Every pass is its own submission with two stamps of its own, waited for: what a CPU driver needs for honest times,
// and what hashing needs to look at each pass's outputs. Without timestamps the host's clock is read instead.
void FrameRunner::Hidden::run_isolated(const FrameContext& frame, const CompiledGraph& graph, const RunOptions& options,
                                       double timeout_s, FrameSlot& slot) {
  const size_t passes = graph.plan.passes.size();
  FrameRun& result = slot.pending->result;
  const Timing& timing = slot.timing;
  for (size_t pass = 0; pass < passes; ++pass) {
    Stopwatch watch;
    VkCommandBuffer commands = slot.work.begin();
    const bool stamps = options.timed && timing.available();
    if (!frame.plan.batches.empty()) full_barrier(commands);  // stands for what a batch waits for
    if (stamps) slot.timing.reset(2);
    if (stamps) timing.post(commands, 0);
    if (pass == 0) fill_buffers(frame, commands, options.hash_outputs);
    record_pass(frame, graph, pass, commands);
    if (pass + 1 == passes) record_barriers(frame, graph.plan.final_barriers, commands);
    if (stamps) timing.post(commands, 1);
    result.record_ms += watch.lap_ms();
    slot.work.submit();
    const double submit_ms = watch.lap_ms();
    result.submit_ms += submit_ms;
    slot.wait(pass, pass + 1, timeout_s);
    const double wait_ms = watch.lap_ms();
    result.wait_ms += wait_ms;
    if (options.timed)
      result.passes.push_back({graph.plan.passes[pass].name, stamps ? timing.between_ms(0, 1) : submit_ms + wait_ms});
    if (options.hash_outputs) hasher.hash_outputs(frame, pass, slot.work, result.hashes);
  }
}

FrameTicket FrameRunner::submit(const CompiledGraph& graph, const Imports& imports, const RunOptions& options,
                                const std::vector<std::shared_ptr<const void>>& keep) {
  Hidden& h = *hidden_;
  CHECK_MSG(h.now.plan == graph.hash, "a frame of a plan that was not prepared");
  CHECK(graph.record.size() == graph.plan.passes.size());
  const bool alone = options.timed || options.hash_outputs || options.whole;
  if (alone) h.finish_all(timeout_s);
  if (options.hash_outputs && !h.now.copyable) {
    h.rebuild(graph.plan, true, timeout_s);
    h.now.plan = graph.hash;  // its pipelines are there
  }
  FrameSlot& slot = h.take_slot();
  slot.begin(++h.last_ticket, graph.plan);
  slot.pending->physical = h.now.physical;
  slot.pending->keep.assign(keep.begin(), keep.end());
  if (graph.plan.passes.empty()) return slot.pending->ticket;
  try {
    FrameContext frame = h.context(graph.plan, imports, options, slot);
    frame.hashed = options.hash_outputs;
    frame.after_another = h.in_flight() || !graph.plan.batches.empty();
    h.now.physical->bind_uniforms(graph.plan, slot.index, frame.buffers);
    h.now.physical->bind_imports(graph.plan, slot.index, frame.kept);
    if (options.hash_outputs || (options.timed && (h.device.info().is_cpu || !slot.timing.available()))) {
      h.run_isolated(frame, graph, options, timeout_s, slot);
    } else {
      if (options.whole || (!options.timed && !graph.plan.batches.empty()))
        h.submit_batches(frame, graph, options, slot);
      else
        h.submit_whole(frame, graph, options, slot);
      if (alone) {
        slot.finish(timeout_s);
        h.read_times(graph.plan, options, slot);
      }
    }
  } catch (...) {
    slot.given_up = slot.work.pending();
    if (!slot.given_up) slot.end();
    throw;
  }
  return slot.pending->ticket;
}

FrameRun FrameRunner::collect(FrameTicket ticket) {
  Hidden& h = *hidden_;
  const auto found = std::find_if(h.slots.begin(), h.slots.end(), [&](const auto& slot) {
    return slot->pending && !slot->given_up && slot->pending->ticket == ticket;
  });
  CHECK_MSG(found != h.slots.end(), "collect of a frame that is not in flight");
  FrameSlot& slot = **found;
  slot.finish(timeout_s);
  FrameRun result = std::move(slot.pending->result);
  if (const uint32_t at = slot.pending->spans_at; at > 0)
    result.on_device = {slot.timing.at_ms(at), slot.timing.between_ms(at, at + 1)};
  for (auto& [resource, readback] : slot.pending->readbacks) {
    readback->buffer().invalidate();
    result.readbacks[resource] = std::move(readback);
  }
  slot.end();
  for (const PassTime& pass : result.passes) result.frame_gpu_ms += pass.gpu_ms;
  return result;
}

}  // namespace candela::gpu
