#include "graph_hazards.h"

#include <fmt/format.h>

#include <map>
#include <tuple>

namespace candela::test {
namespace {

using Stages = VkPipelineStageFlags2;
using Mask = VkAccessFlags2;

constexpr Mask all_writes = VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT |
                            VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;

struct Barrier {
  Stages source, destination;
  Mask source_access, destination_access;
  int image = -1;  // -1: all memory
  bool transition = false;
  ImageRange range{};
};

// One subresource of an image; of a buffer always {0, 0}.
struct Part {
  uint32_t mip = 0, layer = 0;
  bool operator==(const Part&) const = default;
};
bool holds(const ImageRange& range, const Part& part) {
  return part.mip >= range.first_mip && part.mip - range.first_mip < range.mip_count &&
         part.layer >= range.first_layer && part.layer - range.first_layer < range.layer_count;
}
std::vector<Part> parts_of(const ImageRange& range) {
  std::vector<Part> parts;
  for (uint32_t mip = 0; mip < range.mip_count; ++mip)
    for (uint32_t layer = 0; layer < range.layer_count; ++layer)
      parts.push_back({range.first_mip + mip, range.first_layer + layer});
  return parts;
}

// The frame as a list: barrier calls at even places, accesses at odd ones. A step of a pass is a place of its own. An
// access of a range is one event for each subresource. A transition is a write inside its barrier.
struct Event {
  int time;
  int batch;  // of its queue; see Queues
  int memory;
  int resource;
  Part part;
  Stages stages;
  Mask access;
  const Barrier* transition = nullptr;
  std::string name;
  bool writes() const { return transition || (access & all_writes); }
};

// Two queues as a graph of batches, with one on the main queue before all and one behind all: a batch has ended when
// one that comes after it on its queue begins to be waited for, and what waits begins after that. A plan without
// batches is one batch of the main queue.
struct Queues {
  std::vector<Queue> queue;             // by batch
  std::vector<std::vector<int>> waits;  // by batch: for batches of whatever queue
  std::vector<int> of_pass;             // batch by pass
  std::vector<std::vector<bool>>
      crosses;  // [from][to]: a semaphore lies between the end of `from` and the begin of `to`
  int first() const { return 0; }
  int last() const { return int(queue.size()) - 1; }
};

Queues queues_of(const FramePlan& plan) {
  Queues q;
  std::vector<QueueBatch> batches = plan.batches;
  if (batches.empty()) {
    q.queue = {Queue::main};
    q.waits = {{}};
    q.of_pass.assign(plan.passes.size(), 0);
    q.crosses = {{false}};
    return q;
  }
  q.of_pass.assign(plan.passes.size(), -1);
  q.queue.push_back(Queue::main);
  q.waits.push_back({});
  std::map<Queue, int> newest;
  for (const QueueBatch& batch : batches) {
    const int index = int(q.queue.size());
    q.queue.push_back(batch.queue);
    q.waits.emplace_back();
    if (!newest.contains(batch.queue) && batch.queue == Queue::compute) q.waits.back().push_back(q.first());
    for (const int wait : batch.waits) q.waits.back().push_back(wait + 1);
    for (const int pass : batch.passes) q.of_pass[size_t(pass)] = index;
    newest[batch.queue] = index;
  }
  q.queue.push_back(Queue::main);
  q.waits.emplace_back();
  for (const auto& [queue, batch] : newest) q.waits.back().push_back(batch);
  // reached[a][b]: b begins after the end of a, by a path that holds a semaphore or not.
  const size_t n = q.queue.size();
  q.crosses.assign(n, std::vector<bool>(n, false));
  for (size_t from = 0; from < n; ++from) {
    std::vector<bool> after(n, false);  // begins after the end of `from` on the same queue
    for (size_t to = from + 1; to < n; ++to) {
      after[to] = q.queue[to] == q.queue[from];
      for (const int wait : q.waits[to])
        if (wait == int(from) || after[size_t(wait)] || q.crosses[from][size_t(wait)]) q.crosses[from][to] = true;
      for (size_t between = from + 1; between < to; ++between)  // what its queue waited for, it waited for
        if (q.queue[between] == q.queue[to] && q.crosses[from][between]) q.crosses[from][to] = true;
    }
  }
  return q;
}

struct Timeline {
  Queues queues;
  std::vector<int> call_batch;              // by call
  std::vector<std::vector<Barrier>> calls;  // call i lies before step i of the frame; the last one before the host
  std::vector<Event> events;
  std::vector<int> memory;  // of each resource
};

VkImageLayout expected_layout(Access access, VkFormat format) {
  const bool depth = format == VK_FORMAT_D32_SFLOAT;
  switch (access) {
    case Access::color_attachment:
    case Access::resolve_attachment:
      return VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    case Access::depth_attachment:
      return VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    case Access::depth_test:
      return VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL;
    case Access::sampled_fragment:
    case Access::sampled_compute:
    case Access::sampled_graphics:
      return depth ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL : VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    case Access::storage_image_write:
    case Access::storage_image_read:
    case Access::storage_image_read_write:
      return VK_IMAGE_LAYOUT_GENERAL;
    case Access::transfer_source:
      return VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    case Access::transfer_destination:
      return VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    default:
      return VK_IMAGE_LAYOUT_MAX_ENUM;
  }
}

std::vector<Barrier> barriers_of(const PassBarriers& barriers) {
  std::vector<Barrier> result;
  if (barriers.source_stages)
    result.push_back(
        {barriers.source_stages, barriers.destination_stages, barriers.source_access, barriers.destination_access});
  for (const ImageBarrier& image : barriers.images)
    result.push_back({image.source_stages, image.destination_stages, image.source_access, image.destination_access,
                      image.resource, image.old_layout != image.new_layout, image.range});
  return result;
}

// A pass without steps is one. What it declared for every step happens in each.
struct Step {
  const PlanPass* pass;
  size_t pass_index;
  size_t index;
  const PassBarriers* barriers;
  std::vector<const PlanUse*> uses;
};
std::vector<Step> steps_of(const FramePlan& plan) {
  std::vector<Step> steps;
  for (const PlanPass& pass : plan.passes)
    for (size_t i = 0; i <= pass.step_barriers.size(); ++i) {
      steps.push_back(
          {&pass, size_t(&pass - plan.passes.data()), i, i == 0 ? &pass.barriers : &pass.step_barriers[i - 1], {}});
      for (const PlanUse& use : pass.uses)
        if (use.step < 0 || use.step == int(i)) steps.back().uses.push_back(&use);
    }
  return steps;
}

Timeline timeline_of(const FramePlan& plan) {
  Timeline line;
  for (size_t i = 0; i < plan.resources.size(); ++i)
    line.memory.push_back(plan.resources[i].block >= 0 ? plan.resources[i].block : int(1000 + i));
  const std::vector<Step> steps = steps_of(plan);
  line.queues = queues_of(plan);
  for (const Step& step : steps) {
    line.calls.push_back(barriers_of(*step.barriers));
    line.call_batch.push_back(line.queues.of_pass[step.pass_index]);
  }
  line.calls.push_back(barriers_of(plan.final_barriers));
  line.call_batch.push_back(line.queues.last());

  const auto add = [&](int time, int batch, int resource, const ImageRange& range, Stages stages, Mask access,
                       std::string name, const Barrier* transition) {
    for (const Part& part : parts_of(range))
      line.events.push_back(
          {time, batch, line.memory[resource], resource, part, stages, access, transition,
           fmt::format("{} of {} ({} {})", name, plan.resources[resource].name(), part.mip, part.layer)});
  };
  constexpr ImageRange buffer_range{0, 1, 0, 1};
  for (size_t i = 0; i < plan.resources.size(); ++i)
    if (const auto* buffer = std::get_if<BufferDesc>(&plan.resources[i].desc); buffer && buffer->zeroed)
      add(-1, line.queues.first(), int(i), buffer_range, VK_PIPELINE_STAGE_2_TRANSFER_BIT,
          VK_ACCESS_2_TRANSFER_WRITE_BIT, "fill", nullptr);
  for (size_t s = 0; s < steps.size(); ++s) {
    const int batch = line.call_batch[s];
    const std::string where = fmt::format("{} {}", steps[s].pass->name, steps[s].index);
    for (const Barrier& barrier : line.calls[s])
      if (barrier.transition)
        add(int(2 * s), batch, barrier.image, barrier.range, 0, 0, "transition before " + where, &barrier);
    for (const PlanUse* use : steps[s].uses) {
      const AccessInfo& info = access_info(use->access);
      add(int(2 * s + 1), batch, use->resource, use->range, info.stages, info.mask,
          fmt::format("{} in {}", info.name, where), nullptr);
    }
  }
  for (size_t i = 0; i < plan.resources.size(); ++i)
    if (plan.resources[i].lifetime == Lifetime::readback && plan.resources[i].first_pass >= 0)
      add(int(2 * steps.size() + 1), line.queues.last(), int(i), buffer_range, VK_PIPELINE_STAGE_2_HOST_BIT,
          VK_ACCESS_2_HOST_READ_BIT, "host_read", nullptr);
  // What the frame leaves in an imported image, the next one samples without a barrier of its own.
  for (const Barrier& barrier : line.calls.back())
    if (barrier.transition)
      add(int(2 * steps.size()), line.queues.last(), barrier.image, barrier.range, 0, 0, "transition at the end",
          &barrier);
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    const auto* image = std::get_if<ImageDesc>(&plan.resources[i].desc);
    if (!image || !plan.resources[i].imported || plan.resources[i].first_pass < 0) continue;
    const auto next = [&](Stages stages, Mask access) {
      add(int(2 * steps.size() + 1), line.queues.last(), int(i), {0, image->mips, 0, image->layers}, stages, access,
          "read by the next frame", nullptr);
    };
    next(VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
         VK_ACCESS_2_SHADER_SAMPLED_READ_BIT);
    if (image->format == VK_FORMAT_D32_SFLOAT)
      next(VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
           VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT);
  }
  return line;
}

// What has happened to one stage of one access by the time of another: who waits for it, where its write is available,
// and to which (stage, access) pairs it is visible.
struct Progress {
  Stages waiting = 0, available = 0;
  std::vector<std::pair<Stages, Mask>> visible;
  bool sees(Stages stage, Mask access) const {
    for (const auto& [stages, mask] : visible)
      if ((stages & stage) && (access & ~mask) == 0) return true;
    return false;
  }
};

// An image barrier reaches the subresources it names, and an access to the same memory as another image.
bool reaches(const Barrier& b, const Timeline& line, const Event& from, const Event& to) {
  if (b.image < 0) return true;
  if (line.memory[b.image] != from.memory) return false;
  if (b.image == from.resource) return holds(b.range, from.part);
  return b.image != to.resource || holds(b.range, to.part);
}

void pass_call(Progress& progress, const std::vector<Barrier>& call, const Timeline& line, const Event& from,
               const Event& to, Stages stage) {
  const Progress before = progress;
  for (const Barrier& b : call) {
    if (&b == from.transition) continue;
    const bool covers = reaches(b, line, from, to);
    const bool direct = stage && (b.source & stage);
    if (direct || (b.source & before.waiting)) progress.waiting |= b.destination;
    const bool flushes = covers && direct && (from.access & all_writes & ~b.source_access) == 0;
    if (flushes || (b.source & before.available)) {
      progress.available |= b.destination;
      if (covers) progress.visible.emplace_back(b.destination, b.destination_access);
    }
  }
}

std::vector<Stages> bits(Stages stages) {
  std::vector<Stages> result;
  for (int i = 0; i < 64; ++i)
    if (stages >> i & 1) result.push_back(Stages(1) << i);
  return result;
}

// A semaphore makes all that came before it available, and visible to all that the device does after it.
void pass_semaphore(Progress& progress) {
  constexpr Stages device = ~Stages(VK_PIPELINE_STAGE_2_HOST_BIT);
  progress.waiting |= device;
  progress.available |= device;
  progress.visible.emplace_back(device, ~Mask(VK_ACCESS_2_HOST_READ_BIT));
}

bool ordered(const Timeline& line, const Event& from, const Event& to) {
  const Queues& q = line.queues;
  const bool crosses = q.crosses[size_t(from.batch)][size_t(to.batch)];
  const bool same_queue = q.queue[size_t(from.batch)] == q.queue[size_t(to.batch)];
  if (!same_queue && !crosses) return false;
  // Barriers count on the queue of `to`: behind `from`, or behind the semaphore that stands between.
  const auto counts = [&](size_t call) {
    const size_t batch = size_t(line.call_batch[call]);
    if (q.queue[batch] != q.queue[size_t(to.batch)]) return false;
    return same_queue || q.crosses[size_t(from.batch)][batch];
  };
  std::vector<Stages> starts = bits(from.stages);
  if (from.transition) starts = {0};
  for (const Stages stage : starts) {
    Progress progress;
    if (from.transition) {
      progress.waiting = progress.available = from.transition->destination;
      progress.visible.emplace_back(from.transition->destination, from.transition->destination_access);
    }
    if (crosses) pass_semaphore(progress);
    // Calls strictly after `from` and strictly before `to`; the call that holds a transition is judged below.
    for (int call = (from.time + 2) / 2; 2 * call < to.time; ++call)
      if (2 * call > from.time && counts(size_t(call))) pass_call(progress, line.calls[call], line, from, to, stage);
    if (to.transition) {
      const Barrier& b = *to.transition;
      const bool direct = stage && (b.source & stage);
      if (!direct && !(b.source & progress.waiting)) return false;
      const bool flushes = direct && (from.access & all_writes & ~b.source_access) == 0;
      if (from.writes() && !flushes && !(b.source & progress.available)) return false;
      continue;
    }
    for (const Stages target : bits(to.stages)) {
      if (!(progress.waiting & target)) return false;
      if (from.writes() && !(progress.available & target)) return false;
      if (from.writes() && (to.access & ~all_writes) && !progress.sees(target, to.access & ~all_writes)) return false;
    }
  }
  return true;
}

// Layouts by subresource; also that what is read was written, and that a write knows whether it is the first.
void check_contents(const FramePlan& plan, std::vector<std::string>& found) {
  struct Content {
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
    bool written = false;
  };
  std::map<std::tuple<int, uint32_t, uint32_t>, Content> contents;
  const auto content = [&](int resource, const Part& part) -> Content& {
    return contents[{resource, part.mip, part.layer}];
  };
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    const auto* image = std::get_if<ImageDesc>(&plan.resources[i].desc);
    if (!image || !plan.resources[i].imported || plan.resources[i].to_fill) continue;
    for (const Part& part : parts_of({0, image->mips, 0, image->layers}))
      content(int(i), part) = {expected_layout(Access::sampled_compute, image->format), true};
  }
  for (const Step& step : steps_of(plan)) {
    for (const ImageBarrier& b : step.barriers->images)
      for (const Part& part : parts_of(b.range)) {
        Content& of = content(b.resource, part);
        if (b.old_layout != of.layout)
          found.push_back(fmt::format("{}: barrier from a layout that {} does not have", step.pass->name,
                                      plan.resources[b.resource].name()));
        of.layout = b.new_layout;
      }
    for (const PlanUse* use : step.uses) {
      const auto* image = std::get_if<ImageDesc>(&plan.resources[use->resource].desc);
      if (!image) continue;
      bool any_written = false;
      for (const Part& part : parts_of(use->range)) {
        Content& of = content(use->resource, part);
        if (of.layout != expected_layout(use->access, image->format))
          found.push_back(fmt::format("{}: {} in the wrong layout", step.pass->name, image->name));
        if (!use->writes && !of.written)
          found.push_back(fmt::format("{}: {} is read and was not written", step.pass->name, image->name));
        any_written |= of.written;
      }
      if (use->writes && use->step != PlanUse::every_step && use->first == any_written)
        found.push_back(fmt::format("{}: {} is wrong about its first write", step.pass->name, image->name));
    }
    for (const PlanUse* use : step.uses)
      if (use->writes)
        for (const Part& part : parts_of(use->range)) content(use->resource, part).written = true;
  }
  for (const ImageBarrier& b : plan.final_barriers.images)
    for (const Part& part : parts_of(b.range)) {
      Content& of = content(b.resource, part);
      if (b.old_layout != of.layout)
        found.push_back(
            fmt::format("the end: barrier from a layout that {} does not have", plan.resources[b.resource].name()));
      of.layout = b.new_layout;
    }
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    const auto* image = std::get_if<ImageDesc>(&plan.resources[i].desc);
    if (!image || !plan.resources[i].imported || plan.resources[i].first_pass < 0) continue;
    for (const Part& part : parts_of({0, image->mips, 0, image->layers})) {
      if (content(int(i), part).layout != expected_layout(Access::sampled_compute, image->format))
        found.push_back(fmt::format("the end: {} is not left as it is sampled", image->name));
      if (!content(int(i), part).written) found.push_back(fmt::format("the end: {} is not whole", image->name));
    }
  }
}

// Images and buffers share no memory with each other, and nothing shares that of a buffer which is filled before the
// first pass, or which the host reads.
void check_sharing(const FramePlan& plan, std::vector<std::string>& found) {
  std::map<int, bool> images;  // by block
  for (const PlanResource& resource : plan.resources) {
    if (resource.block < 0) continue;
    if (!images.emplace(resource.block, resource.is_image()).second && images[resource.block] != resource.is_image())
      found.push_back(fmt::format("{} shares memory of another kind", resource.name()));
    const auto* buffer = std::get_if<BufferDesc>(&resource.desc);
    if (resource.imported || (buffer && (buffer->zeroed || buffer->memory != BufferMemory::device)))
      found.push_back(fmt::format("{} shares memory", resource.name()));
  }
}

// A queue without graphics has fewer stages; barriers may name no others there.
void check_stages(const FramePlan& plan, std::vector<std::string>& found) {
  constexpr Stages compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_TRANSFER_BIT |
                             VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  for (const Step& step : steps_of(plan))
    for (const Barrier& b : barriers_of(*step.barriers))
      if (step.pass->queue == Queue::compute && ((b.source | b.destination) & ~compute))
        found.push_back(fmt::format("{}: a barrier with stages that the compute queue lacks", step.pass->name));
}

}  // namespace

std::vector<std::string> find_hazards(const FramePlan& plan) {
  const Timeline line = timeline_of(plan);
  std::vector<std::string> found;
  std::map<int, std::vector<const Event*>> by_memory;
  for (const Event& event : line.events) by_memory[event.memory].push_back(&event);
  const auto check = [&](const Event& from, const Event& to) {
    const bool other_owner = from.resource != to.resource;  // aliased: contents change hands, even between reads
    if (!other_owner && (from.part != to.part || (!from.writes() && !to.writes()))) return;
    if (!ordered(line, from, to)) found.push_back(from.name + " | " + to.name);
  };
  for (const auto& [memory, events] : by_memory)
    for (const Event* from : events)
      for (const Event* to : events)
        if (from->time < to->time) check(*from, *to);
  check_contents(plan, found);
  check_stages(plan, found);
  check_sharing(plan, found);
  return found;
}

}  // namespace candela::test
