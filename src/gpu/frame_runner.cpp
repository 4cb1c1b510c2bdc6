#include "gpu/frame_runner.h"

#include <chrono>

#include "base/check.h"
#include "gpu/command_list_impl.h"
#include "gpu/frame_hash.h"
#include "gpu/physical.h"
#include "gpu/pipelines.h"
#include "gpu/queue_work.h"
#include "gpu/timing.h"

namespace candela::gpu {

namespace {

// Recognisable bytes for what no one wrote yet, while hashing: the same in every run, and wrong enough to be seen.
constexpr uint32_t poison = 0xcdcdcdcd;

class Stopwatch {
 public:
  double lap_ms() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - start_).count();
    start_ = now;
    return ms;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

struct FrameRunner::Hidden {
  Device& device;
  Bindless& bindless;
  Pipelines pipelines;
  Physical physical;
  std::shared_ptr<ReadbackPool> readbacks = std::make_shared<ReadbackPool>();
  Timing timing;
  OutputHasher hasher;
  QueueWork work;  // last: its end waits for the device, before what the device uses goes
  std::vector<const Pipeline*> of_plan;
  std::optional<Hash128> prepared;   // hash of the plan that `physical` and `of_plan` belong to
  std::optional<Hash128> allocated;  // physical_key of what `physical` holds
  bool copyable = false;
  std::array<uint32_t, 3> max_groups{};

  Hidden(Device& d, Bindless& b, ShaderCompiler compiler, std::filesystem::path cache_folder)
      : device(d),
        bindless(b),
        pipelines(d, b, std::move(compiler), std::move(cache_folder)),
        physical(d, b),
        timing(d),
        hasher(d, b, pipelines),
        work(d) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(d.physical(), &properties);
    std::copy_n(properties.limits.maxComputeWorkGroupCount, 3, max_groups.begin());
  }

  void rebuild(const FramePlan& plan, bool to_copy);
  FrameContext context(const FramePlan& plan, const std::map<int, const Buffer*>& imports, FrameRun& result);
  void fill_buffers(const FrameContext& frame, VkCommandBuffer commands, bool hashing) const;
  void record_pass(const FrameContext& frame, const CompiledGraph& graph, size_t pass, VkCommandBuffer commands) const;
  void wait(const FramePlan& plan, size_t first, size_t last, double timeout_s);
  void run_whole(const FrameContext& frame, const CompiledGraph& graph, bool timed, double timeout_s, FrameRun& result);
  void run_isolated(const FrameContext& frame, const CompiledGraph& graph, const RunOptions& options, double timeout_s,
                    FrameRun& result);
};

FrameRunner::FrameRunner(Device& device, Bindless& bindless, ShaderCompiler compiler,
                         std::filesystem::path cache_folder)
    : hidden_(std::make_unique<Hidden>(device, bindless, std::move(compiler), std::move(cache_folder))) {}
FrameRunner::~FrameRunner() = default;

Expected<PrepareTimes> FrameRunner::prepare(const CompiledGraph& graph) {
  PrepareTimes times;
  Hidden& h = *hidden_;
  const Hash128 hash = plan_hash(graph.plan);
  if (h.prepared == hash) return times;
  h.prepared.reset();
  auto pipelines = h.pipelines.get(graph.plan.pipelines, times);
  if (!pipelines) return std::unexpected(pipelines.error());
  h.of_plan = std::move(*pipelines);
  if (const Hash128 key = physical_key(graph.plan); h.allocated != key) {
    VK_CHECK(vkQueueWaitIdle(h.device.queue()));  // a frame that was given up on may still use the old images
    Stopwatch watch;
    h.readbacks->trim();
    h.rebuild(graph.plan, false);
    times.allocated = true;
    times.allocate_ms = watch.lap_ms();
  }
  h.prepared = hash;
  return times;
}

// A rebuild that throws, for want of memory, leaves nothing prepared.
void FrameRunner::Hidden::rebuild(const FramePlan& plan, bool to_copy) {
  prepared.reset();
  allocated.reset();
  physical.rebuild(plan, to_copy);
  copyable = to_copy;
  allocated = physical_key(plan);
  prepared = plan_hash(plan);
}

FrameContext FrameRunner::Hidden::context(const FramePlan& plan, const std::map<int, const Buffer*>& imports,
                                          FrameRun& result) {
  FrameContext frame{device, bindless, plan, physical, {}, of_plan, max_groups};
  frame.buffers.resize(plan.resources.size(), nullptr);
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    const PlanResource& resource = plan.resources[i];
    if (resource.is_image() || resource.first_pass < 0) continue;
    const auto& desc = std::get<BufferDesc>(resource.desc);
    if (resource.imported) {
      const auto found = imports.find(int(i));
      CHECK_MSG(found != imports.end() && found->second && found->second->size() >= desc.size_bytes,
                fmt::format("no buffer, or one too small, is given for the import '{}'", desc.name));
      frame.buffers[i] = found->second;
    } else if (resource.lifetime == Lifetime::readback) {
      const VkBufferUsageFlags usage =
          resource.buffer_usage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
      auto pooled = readbacks->take(device, desc.size_bytes, usage, desc.name);
      frame.buffers[i] = &pooled->buffer();
      result.readbacks[int(i)] = std::move(pooled);
    } else {
      frame.buffers[i] = &physical.buffer(int(i));
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
    vkCmdFillBuffer(commands, frame.buffers[i]->handle(), 0, VK_WHOLE_SIZE, zeroed ? 0 : poison);
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

// Waits for the passes [first, last) of one submission. Their marks or posts tell how far the device came.
void FrameRunner::Hidden::wait(const FramePlan& plan, size_t first, size_t last, double timeout_s) {
  const auto names_from = [&](size_t from) {
    std::string names;
    for (size_t i = from; i < last; ++i) names += (names.empty() ? "" : ", ") + plan.passes[i].name;
    return names;
  };
  try {
    if (work.wait(timeout_s)) return;
  } catch (const GpuError& error) {
    throw GpuError(error.result, fmt::format("waiting for the passes {}", names_from(first)));
  }
  size_t begun = first;
  for (size_t i = first; i < last && last - first > 1; ++i)
    if (timing.reached(uint32_t(i))) begun = i;
  throw GpuError(VK_TIMEOUT,
                 fmt::format("the frame did not end within {} s; not finished: {}", timeout_s, names_from(begun)));
}

void FrameRunner::Hidden::run_whole(const FrameContext& frame, const CompiledGraph& graph, bool timed, double timeout_s,
                                    FrameRun& result) {
  const uint32_t passes = uint32_t(graph.plan.passes.size());
  Stopwatch watch;
  VkCommandBuffer commands = work.begin();
  timing.reset(passes + 1);
  const auto stamp = [&](uint32_t index) {
    if (timed)
      timing.post(commands, index);
    else if (timing.available())
      timing.mark(commands, index);
  };
  stamp(0);
  fill_buffers(frame, commands, false);
  for (uint32_t pass = 0; pass < passes; ++pass) {
    record_pass(frame, graph, pass, commands);
    if (pass + 1 < passes || timed) stamp(pass + 1);
  }
  record_barriers(frame, graph.plan.final_barriers, commands);
  result.record_ms = watch.lap_ms();
  work.submit();
  result.submit_ms = watch.lap_ms();
  wait(graph.plan, 0, passes, timeout_s);
  result.wait_ms = watch.lap_ms();
  for (uint32_t pass = 0; timed && pass < passes; ++pass)
    result.passes.push_back({graph.plan.passes[pass].name, timing.between_ms(pass, pass + 1)});
}

// Every pass is its own submission with two stamps of its own, waited for: what a CPU driver needs for honest times
// (DESIGN section 6), and what hashing needs to look at each pass's outputs. Without timestamps the host's clock is
// read instead.
void FrameRunner::Hidden::run_isolated(const FrameContext& frame, const CompiledGraph& graph, const RunOptions& options,
                                       double timeout_s, FrameRun& result) {
  const size_t passes = graph.plan.passes.size();
  for (size_t pass = 0; pass < passes; ++pass) {
    Stopwatch watch;
    VkCommandBuffer commands = work.begin();
    const bool stamps = options.timed && timing.available();
    if (stamps) timing.reset(2);
    if (stamps) timing.post(commands, 0);
    if (pass == 0) fill_buffers(frame, commands, options.hash_outputs);
    record_pass(frame, graph, pass, commands);
    if (pass + 1 == passes) record_barriers(frame, graph.plan.final_barriers, commands);
    if (stamps) timing.post(commands, 1);
    result.record_ms += watch.lap_ms();
    work.submit();
    const double submit_ms = watch.lap_ms();
    result.submit_ms += submit_ms;
    wait(graph.plan, pass, pass + 1, timeout_s);
    const double wait_ms = watch.lap_ms();
    result.wait_ms += wait_ms;
    if (options.timed)
      result.passes.push_back({graph.plan.passes[pass].name, stamps ? timing.between_ms(0, 1) : submit_ms + wait_ms});
    if (options.hash_outputs) hasher.hash_outputs(frame, pass, work, result.hashes);
  }
}

FrameRun FrameRunner::run(const CompiledGraph& graph, const std::map<int, const Buffer*>& imports,
                          const RunOptions& options) {
  Hidden& h = *hidden_;
  CHECK_MSG(h.prepared == plan_hash(graph.plan), "run() of a plan that was not prepared");
  CHECK(graph.record.size() == graph.plan.passes.size());
  FrameRun result;
  if (graph.plan.passes.empty()) return result;
  if (options.hash_outputs && !h.copyable) h.rebuild(graph.plan, true);
  FrameContext frame = h.context(graph.plan, imports, result);
  frame.hashed = options.hash_outputs;
  h.physical.bind_uniforms(graph.plan, frame.buffers);
  const bool isolated = options.hash_outputs || (options.timed && (h.device.info().is_cpu || !h.timing.available()));
  if (isolated)
    h.run_isolated(frame, graph, options, timeout_s, result);
  else
    h.run_whole(frame, graph, options.timed, timeout_s, result);
  for (const PassTime& pass : result.passes) result.frame_gpu_ms += pass.gpu_ms;
  for (const auto& [resource, readback] : result.readbacks) frame.buffers[size_t(resource)]->invalidate();
  return result;
}

}  // namespace candela::gpu
