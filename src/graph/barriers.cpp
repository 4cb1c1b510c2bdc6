#include "graph/builder.h"
#include "graph/queues.h"

// One walk over the ordered passes and their steps with the state of every buffer and subresource:
// the last write, who can see it, and the reads since. A change of layout counts as a write that happens between the
// stages of its own barrier.
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

// What one step of a pass does to one buffer, or to one subresource of an image, all its uses together.
struct Need {
  int resource = -1;
  size_t subresource = 0;
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
  bool changed = false;    // written, or its layout changed, in this frame
  bool elsewhere = false;  // since this queue's last write, the other one used it: a semaphore stands between

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
    state.elsewhere = false;
    state.changed = true;
  }
  if (!need.writes) state.reads.push_back({need.all.stages, 0});
  state.layout = need.layout;
}

// What the other queue did is ordered by semaphores, which make every write available and visible.
void update_from_other_queue(State& state, const Need& need) {
  if (need.writes || state.layout != need.layout) state = {.layout = need.layout, .changed = true};
  state.elsewhere = true;
}

uint32_t layers_of(const PlanResource& resource) {
  const auto* image = std::get_if<ImageDesc>(&resource.desc);
  return image ? image->layers : 1;
}
size_t subresources_of(const PlanResource& resource) {
  const auto* image = std::get_if<ImageDesc>(&resource.desc);
  return image ? size_t(image->mips) * image->layers : 1;
}

bool same_transition(const ImageBarrier& a, const ImageBarrier& b) {
  return a.resource == b.resource && a.source_stages == b.source_stages && a.source_access == b.source_access &&
         a.destination_stages == b.destination_stages && a.destination_access == b.destination_access &&
         a.old_layout == b.old_layout && a.new_layout == b.new_layout;
}

// Equal neighbours are one barrier: `fresh` holds one for each subresource, mip by mip. Layers that follow one another
// join first, then equal rows of mips that do.
void add_merged(const std::vector<ImageBarrier>& fresh, std::vector<ImageBarrier>& barriers) {
  std::vector<ImageBarrier> rows;
  for (const ImageBarrier& b : fresh) {
    const bool joins = !rows.empty() && same_transition(rows.back(), b) &&
                       rows.back().range.first_mip == b.range.first_mip &&
                       rows.back().range.first_layer + rows.back().range.layer_count == b.range.first_layer;
    if (joins)
      ++rows.back().range.layer_count;
    else
      rows.push_back(b);
  }
  const size_t begin = barriers.size();
  for (const ImageBarrier& row : rows) {
    const auto above = std::find_if(barriers.begin() + long(begin), barriers.end(), [&](const ImageBarrier& b) {
      return same_transition(b, row) && b.range.first_mip + b.range.mip_count == row.range.first_mip &&
             b.range.first_layer == row.range.first_layer && b.range.layer_count == row.range.layer_count;
    });
    if (above != barriers.end())
      ++above->range.mip_count;
    else
      barriers.push_back(row);
  }
}

// The validation layer 1.3.239 takes an image for as large as one of its samples.
uint64_t bytes_a_sample(const PlanResource& resource) {
  const auto* image = std::get_if<ImageDesc>(&resource.desc);
  return image ? resource.bytes / image->samples : resource.bytes;
}

// The walk of one queue: over its own passes with barriers, and over the other's for what they leave behind.
class Walk {
 public:
  Walk(const FramePlan& plan, Queue queue) : plan_(plan), queue_(queue), states_(plan.resources.size()) {
    for (size_t i = 0; i < states_.size(); ++i) {
      states_[i].resize(subresources_of(plan.resources[i]));
      const auto* buffer = std::get_if<BufferDesc>(&plan.resources[i].desc);
      const auto* image = std::get_if<ImageDesc>(&plan.resources[i].desc);
      for (State& state : states_[i])
        if (image && plan.resources[i].imported && !plan.resources[i].to_fill)
          state.layout = image_layout(Access::sampled_fragment, image->format);
      const bool filled = buffer && buffer->zeroed && !plan.resources[i].imported;  // on the main queue, before all
      if (filled && queue == Queue::main)
        states_[i][0].write = {VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};
    }
  }
  const State& buffer(size_t resource) const { return states_[resource][0]; }

  // Of the main queue, behind all passes: leaves an imported image as later frames expect it. What this frame wrote
  // becomes visible to whatever reads it there.
  void leave(size_t resource, std::vector<ImageBarrier>& barriers) const {
    const PlanResource& of = plan_.resources[resource];
    const auto& desc = std::get<ImageDesc>(of.desc);
    const VkImageLayout sampled = image_layout(Access::sampled_fragment, desc.format);
    std::vector<ImageBarrier> fresh;
    for (size_t i = 0; i < states_[resource].size(); ++i) {
      const State& state = states_[resource][i];
      const Scope last = state.last();
      ImageBarrier barrier{.resource = int(resource)};
      barrier.source_stages = last.stages | state.write.stages;
      barrier.source_access = last.access | state.write.access;
      // Whoever reads it in that layout later; others change the layout first.
      bool seen = !state.elsewhere;
      for (const Access access : {Access::sampled_fragment, Access::sampled_compute, Access::depth_test}) {
        if (image_layout(access, desc.format) != sampled) continue;
        const Scope reader{access_info(access).stages, access_info(access).mask};
        barrier.destination_stages |= reader.stages;
        barrier.destination_access |= reader.access;
        seen = seen && state.sees(reader);
      }
      if (state.layout == sampled && (!state.changed || seen)) continue;
      if (state.elsewhere) barrier.source_stages |= barrier.destination_stages;  // as in transition()
      barrier.old_layout = state.layout;
      barrier.new_layout = sampled;
      barrier.range = {uint32_t(i) / desc.layers, 1, uint32_t(i) % desc.layers, 1};
      fresh.push_back(barrier);
    }
    add_merged(fresh, barriers);
  }

  void other_queue(const PlanPass& pass) {
    for (uint32_t step = 0; step < pass.steps(); ++step)
      for (const Need& need : needs_of(pass, step))
        update_from_other_queue(states_[need.resource][need.subresource], need);
  }

  PassBarriers before_step(const PlanPass& pass, uint32_t step) {
    PassBarriers barriers;
    const std::vector<Need> needs = needs_of(pass, step);
    std::vector<ImageBarrier> fresh;
    for (size_t i = 0; i < needs.size(); ++i) {
      const Need& need = needs[i];
      const State& state = states_[need.resource][need.subresource];
      if (plan_.resources[need.resource].is_image() && state.layout != need.layout) {
        fresh.push_back(transition(need, state));
      } else {
        Dependency dependency = hazard(state, need);
        if (!plan_.resources[need.resource].is_image() && untouched(state)) take_over(need, dependency);
        barriers.source_stages |= dependency.source.stages;
        barriers.source_access |= dependency.source.access;
        barriers.destination_stages |= dependency.destination.stages;
        barriers.destination_access |= dependency.destination.access;
      }
      if (i + 1 < needs.size() && needs[i + 1].resource == need.resource) continue;
      add_merged(fresh, barriers.images);
      fresh.clear();
    }
    for (std::vector<State>& states : states_)
      for (State& state : states) profit(state, barriers);
    for (const Need& need : needs) {
      State& state = states_[need.resource][need.subresource];
      update(state, need, state.layout != need.layout);
    }
    return barriers;
  }

 private:
  // In the order in which the pass declares the resources, the subresources of each in theirs.
  std::vector<Need> needs_of(const PlanPass& pass, uint32_t step) const {
    std::vector<Need> needs;
    for (size_t u = 0; u < pass.uses.size(); ++u) {
      const int resource = pass.uses[u].resource;
      const auto same = [&](const PlanUse& use) { return use.resource == resource && use.in_step(step); };
      if (!pass.uses[u].in_step(step) || std::any_of(pass.uses.begin(), pass.uses.begin() + long(u), same)) continue;
      std::vector<Need> own(states_[resource].size());
      for (size_t later = u; later < pass.uses.size(); ++later)
        if (same(pass.uses[later])) add_use(pass.uses[later], own);
      for (Need& need : own)
        if (!need.scopes.empty()) needs.push_back(std::move(need));
    }
    return needs;
  }

  void add_use(const PlanUse& use, std::vector<Need>& needs) const {
    const PlanResource& resource = plan_.resources[use.resource];
    const AccessInfo& info = access_info(use.access);
    for_subresources(use.range, layers_of(resource), [&](size_t subresource) {
      Need& need = needs[subresource];
      need.resource = use.resource;
      need.subresource = subresource;
      const VkPipelineStageFlags2 stages = info.stages & stages_of(queue_);
      need.scopes.push_back({stages, info.mask});
      need.all.stages |= stages;
      need.all.access |= info.mask;
      need.writes |= use.writes;
      if (const auto* image = std::get_if<ImageDesc>(&resource.desc))
        need.layout = image_layout(use.access, image->format);
    });
  }

  ImageBarrier transition(const Need& need, const State& state) const {
    Scope source = state.last();
    bool elsewhere = state.elsewhere;
    if (state.layout == VK_IMAGE_LAYOUT_UNDEFINED) {
      for (const int before : predecessors_in_block(need.resource))
        for (const State& part : states_[before]) {
          const Scope other = part.last();
          source.stages |= other.stages;
          source.access |= other.access;
          elsewhere |= part.elsewhere;
        }
    }
    // The semaphore's wait covers every stage; a chain from it to the change of layout needs one of them.
    if (elsewhere) source.stages |= need.all.stages;
    const uint32_t layers = layers_of(plan_.resources[need.resource]);
    const ImageRange range{uint32_t(need.subresource) / layers, 1, uint32_t(need.subresource) % layers, 1};
    return {need.resource,   source.stages, need.all.stages, source.access,
            need.all.access, state.layout,  need.layout,     range};
  }

  static bool untouched(const State& state) { return state.write.stages == 0 && state.reads.empty() && !state.changed; }

  // A buffer's memory was another's: whatever was done with that is over, and its writes come before the new ones.
  void take_over(const Need& need, Dependency& dependency) const {
    for (const int before : predecessors_in_block(need.resource)) {
      const Scope last = states_[size_t(before)][0].last();  // of the other queue: a semaphore stands between
      dependency.source.stages |= last.stages;
      dependency.source.access |= last.access;
      if (last.stages)
        dependency.destination.stages |= need.all.stages, dependency.destination.access |= need.all.access;
    }
  }

  // What had the memory block before, newest first, back to one that is as large and was used whole: a
  // smaller one took over only its part of the memory, and the rest is still as an older one left it.
  std::vector<int> predecessors_in_block(int resource) const {
    const PlanResource& image = plan_.resources[resource];
    std::vector<int> before;
    if (image.block < 0) return before;
    for (size_t i = 0; i < plan_.resources.size(); ++i) {
      const PlanResource& other = plan_.resources[i];
      if (other.block == image.block && other.first_pass >= 0 && other.last_pass < image.first_pass)
        before.push_back(int(i));
    }
    std::sort(before.begin(), before.end(),
              [&](int a, int b) { return plan_.resources[a].last_pass > plan_.resources[b].last_pass; });
    const auto covers = [&](int other) {
      return plan_.resources[other].is_image() && plan_.resources[other].bytes >= image.bytes &&
             bytes_a_sample(plan_.resources[other]) >= bytes_a_sample(image) &&
             std::all_of(states_[other].begin(), states_[other].end(),
                         [](const State& part) { return part.layout != VK_IMAGE_LAYOUT_UNDEFINED; });
    };
    const auto last = std::find_if(before.begin(), before.end(), covers);
    if (last != before.end()) before.erase(last + 1, before.end());
    return before;
  }

  const FramePlan& plan_;
  Queue queue_;
  std::vector<std::vector<State>> states_;  // by resource and subresource
};

}  // namespace

void place_barriers(FramePlan& plan) {
  std::array<Walk, queue_count> walks{Walk(plan, Queue::main), Walk(plan, Queue::compute)};
  for (PlanPass& pass : plan.passes) {
    Walk& own = walks[size_t(pass.queue)];
    pass.barriers = own.before_step(pass, 0);
    for (uint32_t step = 1; step < pass.steps(); ++step) pass.step_barriers[step - 1] = own.before_step(pass, step);
    if (!plan.batches.empty()) walks[1 - size_t(pass.queue)].other_queue(pass);
  }

  plan.final_barriers = {};
  const AccessInfo& host = access_info(Access::host_read);
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    if (plan.resources[i].lifetime != Lifetime::readback || plan.resources[i].first_pass < 0) continue;
    for (const Walk& walk : walks) {
      plan.final_barriers.source_stages |= walk.buffer(i).write.stages;
      plan.final_barriers.source_access |= walk.buffer(i).write.access;
    }
    plan.final_barriers.destination_stages |= host.stages;
    plan.final_barriers.destination_access |= host.mask;
  }
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    const PlanResource& resource = plan.resources[i];
    if (resource.is_image() && resource.imported && resource.first_pass >= 0)
      walks[size_t(Queue::main)].leave(i, plan.final_barriers.images);
  }
}

}  // namespace candela
