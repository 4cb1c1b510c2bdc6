#include "graph/queues.h"

#include <functional>

namespace candela {
namespace {

// The passes that touched a buffer or a subresource since it last changed, and the one that changed it: by a write, or
// by a change of layout, which is a write to whoever comes after.
struct Touched {
  int changed_by = -1;
  std::vector<int> read_by;
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
};

class Sources {
 public:
  explicit Sources(const FramePlan& plan) : plan_(plan), last_(plan.passes.size(), -1) {
    for (const PlanResource& resource : plan.resources) {
      const auto* image = std::get_if<ImageDesc>(&resource.desc);
      Touched found;
      if (image && resource.imported && !resource.to_fill)
        found.layout = image_layout(Access::sampled_fragment, image->format);
      touched_.emplace_back(image ? size_t(image->mips) * image->layers : 1, found);
    }
    for (size_t pass = 0; pass < plan.passes.size(); ++pass)
      for (const PlanUse& use : plan.passes[pass].uses) add(int(pass), use);
  }
  // For each pass, the last pass of the other queue that it must come after, or -1.
  const std::vector<int>& last() const { return last_; }

 private:
  void add(int pass, const PlanUse& use) {
    const auto* image = std::get_if<ImageDesc>(&plan_.resources[size_t(use.resource)].desc);
    const VkImageLayout layout = image ? image_layout(use.access, image->format) : VK_IMAGE_LAYOUT_UNDEFINED;
    for_subresources(use.range, image ? image->layers : 1, [&](size_t subresource) {
      Touched& touched = touched_[size_t(use.resource)][subresource];
      after(pass, touched.changed_by);
      if (use.writes || layout != touched.layout) {
        for (const int reader : touched.read_by) after(pass, reader);
        touched = {pass, {}, layout};
      } else {
        touched.read_by.push_back(pass);
      }
    });
  }
  void after(int pass, int source) {
    if (source >= 0 && plan_.passes[size_t(source)].queue != plan_.passes[size_t(pass)].queue)
      last_[size_t(pass)] = std::max(last_[size_t(pass)], source);
  }

  const FramePlan& plan_;
  std::vector<std::vector<Touched>> touched_;  // by resource and subresource
  std::vector<int> last_;
};

// What both queues use is made for both.
void mark_shared(FramePlan& plan) {
  std::vector<std::array<bool, queue_count>> used(plan.resources.size());
  for (const PlanPass& pass : plan.passes)
    for (const PlanUse& use : pass.uses) used[size_t(use.resource)][size_t(pass.queue)] = true;
  for (size_t i = 0; i < used.size(); ++i) plan.resources[i].both_queues = used[i][0] && used[i][1];
}

}  // namespace

VkPipelineStageFlags2 stages_of(Queue queue) {
  if (queue == Queue::main) return ~VkPipelineStageFlags2(0);
  return VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_TRANSFER_BIT |
         VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT;
}

void place_batches(FramePlan& plan) {
  plan.batches.clear();
  const auto on_compute = [](const PlanPass& pass) { return pass.queue == Queue::compute; };
  if (std::none_of(plan.passes.begin(), plan.passes.end(), on_compute)) return;

  mark_shared(plan);
  // A wait covers what is behind it on its queue, so a pass needs one only for a source later than those so far.
  std::vector<int> sources = Sources(plan).last();
  std::vector<bool> waited_for(plan.passes.size(), false);
  std::array<int, queue_count> covered{-1, -1};
  for (size_t p = 0; p < plan.passes.size(); ++p) {
    int& last = covered[size_t(plan.passes[p].queue)];
    if (sources[p] <= last) {
      sources[p] = -1;
    } else {
      last = sources[p];
      waited_for[size_t(last)] = true;
    }
  }
  // A batch ends behind a pass that another queue waits for, so that it waits for no more than that.
  std::vector<int> batch_of(plan.passes.size(), -1);
  std::array<int, queue_count> open{-1, -1};
  for (size_t p = 0; p < plan.passes.size(); ++p) {
    int& batch = open[size_t(plan.passes[p].queue)];
    if (sources[p] >= 0 || batch < 0) {
      batch = int(plan.batches.size());
      plan.batches.push_back({.queue = plan.passes[p].queue});
      if (sources[p] >= 0) plan.batches.back().waits.push_back(batch_of[size_t(sources[p])]);
    }
    plan.batches[size_t(batch)].passes.push_back(int(p));
    batch_of[p] = batch;
    if (waited_for[p]) batch = -1;
  }
}

PassOrder::PassOrder(const FramePlan& plan) : ended_(plan.passes.size(), {-1, -1}) {
  for (const PlanPass& pass : plan.passes) queue_.push_back(pass.queue);
  if (plan.batches.empty()) {
    std::fill(queue_.begin(), queue_.end(), Queue::main);
    return;
  }
  std::array<std::array<int, queue_count>, queue_count> known{{{-1, -1}, {-1, -1}}};  // by queue, so far
  for (const QueueBatch& batch : plan.batches) {
    auto& own = known[size_t(batch.queue)];
    for (const int wait : batch.waits) {
      const QueueBatch& other = plan.batches[size_t(wait)];
      const int end = other.passes.back();
      for (size_t q = 0; q < queue_count; ++q) own[q] = std::max(own[q], ended_[size_t(end)][q]);
      own[size_t(other.queue)] = std::max(own[size_t(other.queue)], end);
    }
    for (const int pass : batch.passes) {
      ended_[size_t(pass)] = own;
      own[size_t(batch.queue)] = pass;
    }
  }
}

bool PassOrder::before(int first, int second) const {
  if (queue_[size_t(first)] == queue_[size_t(second)]) return first < second;
  return first <= ended_[size_t(second)][size_t(queue_[size_t(first)])];
}

std::vector<std::vector<int>> batch_orders(const FramePlan& plan, size_t most) {
  std::vector<std::vector<int>> orders;
  std::vector<int> order;
  std::vector<bool> done(plan.batches.size(), false);
  const auto ready = [&](size_t b) {
    const QueueBatch& batch = plan.batches[b];
    for (size_t earlier = 0; earlier < b; ++earlier)
      if (plan.batches[earlier].queue == batch.queue && !done[earlier]) return false;
    return std::all_of(batch.waits.begin(), batch.waits.end(), [&](int wait) { return done[size_t(wait)]; });
  };
  const std::function<void()> extend = [&] {
    if (orders.size() >= most) return;
    if (order.size() == plan.batches.size()) {
      orders.push_back(order);
      return;
    }
    for (size_t b = 0; b < plan.batches.size(); ++b) {
      if (done[b] || !ready(b)) continue;
      done[b] = true;
      order.push_back(int(b));
      extend();
      order.pop_back();
      done[b] = false;
    }
  };
  extend();
  return orders;
}

}  // namespace candela
