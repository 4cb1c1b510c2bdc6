#pragma once
#include <array>
#include <vector>

#include "graph/plan.h"

// Passes on two queues: who waits for whom. Pure; plans know nothing of what queues a device has.
namespace candela {

constexpr int queue_count = 2;

// The stages that a queue's passes may have.
VkPipelineStageFlags2 stages_of(Queue queue);

// Divides the passes into batches (FramePlan::batches). A pass that uses what a pass of the other queue wrote, or
// writes or changes the layout of what it used, begins a batch that waits for the end of that pass's batch. Without a
// pass for the compute queue there are no batches.
void place_batches(FramePlan& plan);

// Which passes are over before which others begin, on whatever queues the batches run: by the order within a queue and
// by what the batches wait for.
class PassOrder {
 public:
  explicit PassOrder(const FramePlan& plan);
  bool before(int first, int second) const;

 private:
  std::vector<Queue> queue_;                         // by pass
  std::vector<std::array<int, queue_count>> ended_;  // by pass: the last pass of each queue that has ended before it
};

// Each order in which the batches may be submitted one after another: every one after those it waits for and after the
// earlier ones of its queue. At most `most` of them, the plan's own first.
std::vector<std::vector<int>> batch_orders(const FramePlan& plan, size_t most);

}  // namespace candela
