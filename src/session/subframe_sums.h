#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "gpu/resources.h"
#include "graph/plan.h"

namespace candela {

// The sums of a picture's frames (passes/post/subframes.h) from one frame to the next, by the names that plans have for
// them: a frame takes one buffer and leaves another.
class SubframeSums {
 public:
  explicit SubframeSums(gpu::Device& device) : device_(device) {}
  void begin_picture() {
    for (Sum& sum : sums_) sum.before.reset(), sum.after.reset();
  }
  // The buffers of a frame's plan, in the order in which frames are handed to the device. keep: lives until the device
  // is done with the frame. Throws GpuError.
  void import(const FramePlan& plan, gpu::Imports& imports, std::vector<std::shared_ptr<const void>>& keep);

 private:
  std::shared_ptr<gpu::Buffer> buffer_of(uint64_t bytes);
  gpu::Device& device_;
  struct Sum {
    std::string name;
    std::shared_ptr<gpu::Buffer> before, after;  // what the frame takes, and what it leaves
  };
  Sum& sum_of(std::string_view name);
  std::vector<Sum> sums_;                            // of all names that there were; few
  std::vector<std::shared_ptr<gpu::Buffer>> spare_;  // those that no frame holds are taken again
};

}  // namespace candela
