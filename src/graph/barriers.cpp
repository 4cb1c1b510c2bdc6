#include "graph/builder.h"

// One walk over the ordered passes with the state of every resource (DESIGN section 5): the last write, who can see it,
// and the reads since. A change of layout counts as a write that happens between the stages of its own barrier.
namespace candela {
namespace {

constexpr VkAccessFlags2 write_bits = VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT |
                                      VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT |
                                      VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;

constexpr bool holds(uint64_t set, uint64_t part) { return (part & ~set) == 0; }

struct Scope {
  VkPipelineStageFlags2 stages = 0;
  VkAccessFlags2 access = 0;
};

// What one pass does to one resource, all its uses together.
struct Need {
  int resource = -1;
  std::vector<Scope> scopes;
  Scope all;
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
  bool writes = false;
};

struct State {
  struct Read {
    VkPipelineStageFlags2 stages, ordered_before;  // later stages that already wait for it
  };
  Scope write;                 // stages 0: nothing was written inside the frame
  std::vector<Scope> visible;  // to whom the write already is
  std::vector<Read> reads;     // since the write
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;

  bool sees(const Scope& reader) const {
    VkPipelineStageFlags2 blind = reader.stages;
    for (const Scope& scope : visible)
      if (holds(scope.access, reader.access)) blind &= ~scope.stages;
    return blind == 0;
  }
  // What must be over before the memory may change hands. Reads come after the write and after it was made available,
  // so waiting for them is enough, and execution alone.
  Scope last() const {
    if (reads.empty()) return write;
    Scope scope;
    for (const Read& read : reads) scope.stages |= read.stages;
    return scope;
  }
};

struct Dependency {
  Scope source, destination;
};

std::vector<Need> needs_of(const PlanPass& pass, const FramePlan& plan) {
  std::vector<Need> needs;
  for (const PlanUse& use : pass.uses) {
    auto need = std::find_if(needs.begin(), needs.end(), [&](const Need& n) { return n.resource == use.resource; });
    if (need == needs.end()) need = needs.insert(need, {.resource = use.resource});
    const AccessInfo& info = access_info(use.access);
    need->scopes.push_back({info.stages, info.mask});
    need->all.stages |= info.stages;
    need->all.access |= info.mask;
    need->writes |= use.writes;
    if (const auto* image = std::get_if<ImageDesc>(&plan.resources[use.resource].desc))
      need->layout = image_layout(use.access, image->format);
  }
  return needs;
}

// Read after write, write after write, write after read, with the layout unchanged. Empty where all is ordered and
// visible.
Dependency hazard(const State& state, const Need& need) {
  Dependency result;
  bool wait_for_write = false;
  for (const Scope& scope : need.scopes) {
    const Scope reader{scope.stages, scope.access & ~write_bits};
    wait_for_write |= reader.access != 0 && !state.sees(reader);
  }
  // Reads in between already waited for the write; then it is enough to wait for them.
  if (need.writes && state.reads.empty()) wait_for_write |= !state.sees(need.all);
  if (wait_for_write && state.write.stages != 0) result = {state.write, need.all};
  if (!need.writes) return result;
  for (const State::Read& read : state.reads) {
    if (holds(read.ordered_before, need.all.stages)) continue;
    result.source.stages |= read.stages;
    result.destination.stages |= need.all.stages;
  }
  return result;
}

// A memory barrier holds for every resource, so one placed for another's sake may spare this one its own.
void profit(State& state, const PassBarriers& barrier) {
  if (barrier.source_stages == 0) return;
  if (state.write.stages != 0 && holds(barrier.source_stages, state.write.stages) &&
      holds(barrier.source_access, state.write.access))
    state.visible.push_back({barrier.destination_stages, barrier.destination_access});
  for (State::Read& read : state.reads)
    if (holds(barrier.source_stages, read.stages)) read.ordered_before |= barrier.destination_stages;
}

void update(State& state, const Need& need, bool changed_layout) {
  if (need.writes || changed_layout) {
    state.write = {need.all.stages, need.all.access & write_bits};
    state.visible.clear();
    state.reads.clear();
    if (!need.writes) state.visible.push_back(need.all);
  }
  if (!need.writes) state.reads.push_back({need.all.stages, 0});
  state.layout = need.layout;
}

// The images that had the memory block before, newest first, back to one that is as large: a smaller one took over only
// its part of the memory, and the rest is still as an older one left it.
std::vector<int> predecessors_in_block(const FramePlan& plan, int resource) {
  const PlanResource& image = plan.resources[resource];
  std::vector<int> before;
  if (image.block < 0) return before;
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    const PlanResource& other = plan.resources[i];
    if (other.block == image.block && other.first_pass >= 0 && other.last_pass < image.first_pass)
      before.push_back(int(i));
  }
  std::sort(before.begin(), before.end(),
            [&](int a, int b) { return plan.resources[a].last_pass > plan.resources[b].last_pass; });
  const auto covers = [&](int other) { return plan.resources[other].bytes >= image.bytes; };
  const auto last = std::find_if(before.begin(), before.end(), covers);
  if (last != before.end()) before.erase(last + 1, before.end());
  return before;
}

void place_before(PlanPass& pass, const FramePlan& plan, std::vector<State>& states) {
  PassBarriers& barriers = pass.barriers;
  barriers = {};
  const std::vector<Need> needs = needs_of(pass, plan);
  for (const Need& need : needs) {
    const State& state = states[need.resource];
    if (plan.resources[need.resource].is_image() && state.layout != need.layout) {
      Scope source = state.last();
      if (state.layout == VK_IMAGE_LAYOUT_UNDEFINED)
        for (const int before : predecessors_in_block(plan, need.resource)) {
          const Scope other = states[before].last();
          source.stages |= other.stages;
          source.access |= other.access;
        }
      barriers.images.push_back(
          {need.resource, source.stages, need.all.stages, source.access, need.all.access, state.layout, need.layout});
    } else {
      const Dependency dependency = hazard(state, need);
      barriers.source_stages |= dependency.source.stages;
      barriers.source_access |= dependency.source.access;
      barriers.destination_stages |= dependency.destination.stages;
      barriers.destination_access |= dependency.destination.access;
    }
  }
  for (State& state : states) profit(state, barriers);
  for (const Need& need : needs) update(states[need.resource], need, states[need.resource].layout != need.layout);
}

}  // namespace

void place_barriers(FramePlan& plan) {
  std::vector<State> states(plan.resources.size());
  for (size_t i = 0; i < states.size(); ++i) {
    const auto* buffer = std::get_if<BufferDesc>(&plan.resources[i].desc);
    if (buffer && buffer->zeroed && !plan.resources[i].imported)  // filled by the executor before the first pass
      states[i].write = {VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};
  }
  for (PlanPass& pass : plan.passes) place_before(pass, plan, states);

  plan.final_barriers = {};
  const AccessInfo& host = access_info(Access::host_read);
  for (size_t i = 0; i < states.size(); ++i) {
    if (plan.resources[i].lifetime != Lifetime::readback || plan.resources[i].first_pass < 0) continue;
    plan.final_barriers.source_stages |= states[i].write.stages;
    plan.final_barriers.source_access |= states[i].write.access;
    plan.final_barriers.destination_stages |= host.stages;
    plan.final_barriers.destination_access |= host.mask;
  }
}

}  // namespace candela
