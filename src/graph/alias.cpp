#include "graph/builder.h"
#include "graph/queues.h"

namespace candela {

namespace {
// A buffer whose memory was another's waits for that one's passes; below this it is not worth the wait.
constexpr uint64_t least_buffer_bytes = 64 << 10;

// Buffers that are filled with zeros are so before the first pass, and what the host reads outlives the last.
bool can_share(const PlanResource& resource) {
  if (resource.first_pass < 0 || resource.lifetime != Lifetime::frame) return false;
  const auto* buffer = std::get_if<BufferDesc>(&resource.desc);
  return !buffer || (!buffer->zeroed && resource.bytes >= least_buffer_bytes);
}
}  // namespace

// Interval colouring of lifetimes: the largest first, each into the first block of its kind that no member uses at the
// same time: everything that is done with one must have ended before anything is done with the other begins, on
// whatever queues. Images and buffers have blocks of their own: their memory may be of different types.
void alias_memory(FramePlan& plan) {
  std::vector<int> sharing;
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    plan.resources[i].block = -1;
    if (can_share(plan.resources[i])) sharing.push_back(int(i));
  }
  std::stable_sort(sharing.begin(), sharing.end(),
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
  for (const int index : sharing) {
    PlanResource& resource = plan.resources[index];
    const auto disjoint = [&](int other) {
      return plan.resources[other].is_image() == resource.is_image() && (before(other, index) || before(index, other));
    };
    size_t block = 0;
    while (block < members.size() && !std::all_of(members[block].begin(), members[block].end(), disjoint)) ++block;
    if (block == members.size()) {
      members.emplace_back();
      plan.block_bytes.push_back(resource.bytes);  // sorted, so the first member is the largest
    }
    members[block].push_back(index);
    resource.block = int(block);
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

uint64_t transient_bytes_whole(const FramePlan& plan) {
  FramePlan whole;
  whole.resources = plan.resources;
  whole.block_bytes.resize(plan.block_bytes.size());
  for (PlanResource& r : whole.resources) {
    if (r.first_pass >= 0) r.bytes = whole_bytes(r);
    if (r.first_pass >= 0 && r.block >= 0)
      whole.block_bytes[size_t(r.block)] = std::max(whole.block_bytes[size_t(r.block)], r.bytes);
  }
  return transient_bytes(whole);
}

}  // namespace candela
