#include "graph/builder.h"
#include "graph/queues.h"

namespace candela {

// Interval colouring of the images' lifetimes: the largest first, each into the first block that no member uses at the
// same time: everything that is done with one must have ended before anything is done with the other begins, on
// whatever queues. Buffers keep their own memory: they are small, and zeroed ones are filled before the first pass.
void alias_memory(FramePlan& plan) {
  std::vector<int> images;
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    PlanResource& resource = plan.resources[i];
    resource.block = -1;
    if (resource.is_image() && resource.first_pass >= 0 && resource.lifetime == Lifetime::frame)
      images.push_back(int(i));
  }
  std::stable_sort(images.begin(), images.end(),
                   [&](int a, int b) { return plan.resources[a].bytes > plan.resources[b].bytes; });

  const PassOrder order(plan);
  std::vector<std::vector<int>> users(plan.resources.size());  // passes
  for (size_t pass = 0; pass < plan.passes.size(); ++pass)
    for (const PlanUse& use : plan.passes[pass].uses) users[size_t(use.resource)].push_back(int(pass));
  const auto before = [&](int a, int b) {
    if (plan.resources[a].last_pass >= plan.resources[b].first_pass) return false;
    return std::all_of(users[size_t(a)].begin(), users[size_t(a)].end(), [&](int first) {
      return std::all_of(users[size_t(b)].begin(), users[size_t(b)].end(),
                         [&](int second) { return order.before(first, second); });
    });
  };

  plan.block_bytes.clear();
  std::vector<std::vector<int>> members;
  for (const int index : images) {
    PlanResource& image = plan.resources[index];
    const auto disjoint = [&](int other) { return before(other, index) || before(index, other); };
    size_t block = 0;
    while (block < members.size() && !std::all_of(members[block].begin(), members[block].end(), disjoint)) ++block;
    if (block == members.size()) {
      members.emplace_back();
      plan.block_bytes.push_back(image.bytes);  // sorted, so the first member is the largest
    }
    members[block].push_back(index);
    image.block = int(block);
  }
}

uint64_t transient_bytes_unaliased(const FramePlan& plan) {
  uint64_t bytes = 0;
  for (const PlanResource& r : plan.resources)
    if (r.first_pass >= 0 && r.lifetime == Lifetime::frame) bytes += r.bytes;
  return bytes;
}

uint64_t transient_bytes(const FramePlan& plan) {
  uint64_t bytes = 0;
  for (const uint64_t block : plan.block_bytes) bytes += block;
  for (const PlanResource& r : plan.resources)
    if (r.first_pass >= 0 && r.lifetime == Lifetime::frame && r.block < 0) bytes += r.bytes;
  return bytes;
}

}  // namespace candela
