#include "graph_hazards.h"

#include <fmt/format.h>

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
};

// The frame as a list: barrier calls at even places, accesses at odd ones. A transition is a write inside its barrier.
struct Event {
  int time;
  int memory;
  int resource;
  Stages stages;
  Mask access;
  const Barrier* transition = nullptr;
  std::string name;
  bool writes() const { return transition || (access & all_writes); }
};

struct Timeline {
  std::vector<std::vector<Barrier>> calls;  // call i lies before pass i; the last one before the host
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
      return depth ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL : VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    case Access::storage_image_write:
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
                      image.resource, image.old_layout != image.new_layout});
  return result;
}

Timeline timeline_of(const FramePlan& plan) {
  Timeline line;
  for (size_t i = 0; i < plan.resources.size(); ++i)
    line.memory.push_back(plan.resources[i].block >= 0 ? plan.resources[i].block : int(1000 + i));
  for (const PlanPass& pass : plan.passes) line.calls.push_back(barriers_of(pass.barriers));
  line.calls.push_back(barriers_of(plan.final_barriers));

  const auto add = [&](int time, int resource, Stages stages, Mask access, std::string name,
                       const Barrier* transition) {
    line.events.push_back({time, line.memory[resource], resource, stages, access, transition,
                           name + " of " + plan.resources[resource].name()});
  };
  for (size_t i = 0; i < plan.resources.size(); ++i)
    if (const auto* buffer = std::get_if<BufferDesc>(&plan.resources[i].desc); buffer && buffer->zeroed)
      add(-1, int(i), VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, "fill", nullptr);
  for (size_t p = 0; p < plan.passes.size(); ++p) {
    for (const Barrier& barrier : line.calls[p])
      if (barrier.transition)
        add(int(2 * p), barrier.image, 0, 0, fmt::format("transition before {}", plan.passes[p].name), &barrier);
    for (const PlanUse& use : plan.passes[p].uses) {
      const AccessInfo& info = access_info(use.access);
      add(int(2 * p + 1), use.resource, info.stages, info.mask, fmt::format("{} in {}", info.name, plan.passes[p].name),
          nullptr);
    }
  }
  for (size_t i = 0; i < plan.resources.size(); ++i)
    if (plan.resources[i].lifetime == Lifetime::readback && plan.resources[i].first_pass >= 0)
      add(int(2 * plan.passes.size() + 1), int(i), VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT, "host_read",
          nullptr);
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

void pass_call(Progress& progress, const std::vector<Barrier>& call, const Timeline& line, const Event& from,
               Stages stage) {
  const Progress before = progress;
  for (const Barrier& b : call) {
    if (&b == from.transition) continue;
    const bool covers = b.image < 0 || line.memory[b.image] == from.memory;
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

bool ordered(const Timeline& line, const Event& from, const Event& to) {
  std::vector<Stages> starts = bits(from.stages);
  if (from.transition) starts = {0};
  for (const Stages stage : starts) {
    Progress progress;
    if (from.transition) {
      progress.waiting = progress.available = from.transition->destination;
      progress.visible.emplace_back(from.transition->destination, from.transition->destination_access);
    }
    // Calls strictly after `from` and strictly before `to`; the call that holds a transition is judged below.
    for (int call = (from.time + 2) / 2; 2 * call < to.time; ++call)
      if (2 * call > from.time) pass_call(progress, line.calls[call], line, from, stage);
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

void check_layouts(const FramePlan& plan, std::vector<std::string>& found) {
  std::vector<VkImageLayout> layout(plan.resources.size(), VK_IMAGE_LAYOUT_UNDEFINED);
  for (const PlanPass& pass : plan.passes) {
    for (const ImageBarrier& b : pass.barriers.images) {
      if (b.old_layout != layout[b.resource])
        found.push_back(fmt::format("{}: barrier from a layout that {} does not have", pass.name,
                                    plan.resources[b.resource].name()));
      layout[b.resource] = b.new_layout;
    }
    for (const PlanUse& use : pass.uses)
      if (const auto* image = std::get_if<ImageDesc>(&plan.resources[use.resource].desc))
        if (layout[use.resource] != expected_layout(use.access, image->format))
          found.push_back(fmt::format("{}: {} in the wrong layout", pass.name, image->name));
  }
}

}  // namespace

std::vector<std::string> find_hazards(const FramePlan& plan) {
  const Timeline line = timeline_of(plan);
  std::vector<std::string> found;
  for (const Event& from : line.events)
    for (const Event& to : line.events) {
      if (from.time >= to.time || from.memory != to.memory) continue;
      const bool other_owner = from.resource != to.resource;  // aliased: contents change hands, even between reads
      if (!from.writes() && !to.writes() && !other_owner) continue;
      if (!ordered(line, from, to)) found.push_back(from.name + " | " + to.name);
    }
  check_layouts(plan, found);
  return found;
}

}  // namespace candela::test
