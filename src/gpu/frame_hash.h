#pragma once
#include <vector>

#include "gpu/command_list_impl.h"
#include "gpu/frame_runner.h"
#include "gpu/queue_work.h"
#include "gpu/sample_reader.h"

namespace candela::gpu {

// Copies what passes wrote to the host and hashes it.
class OutputHasher {
 public:
  OutputHasher(Device& device, Bindless& bindless, Pipelines& pipelines) : samples_(device, bindless, pipelines) {}
  // Appends the hashes of what `pass`, which has just finished, wrote. A multisampled image that the device cannot
  // sample has no hash, and its entry says so in its name.
  void hash_outputs(const FrameContext& frame, size_t pass, QueueWork& work, std::vector<PassHash>& hashes);

 private:
  void copy_and_wait(const FrameContext& frame, const PlanPass& pass, const PlanUse& use, QueueWork& work,
                     uint64_t bytes);
  void record_image(const FrameContext& frame, const PlanPass& pass, const PlanUse& use, VkCommandBuffer commands);

  SampleReader samples_;
  Buffer staging_;
};

// How many infinities and NaNs there are among `bytes` of texels of a float or half format; 0 for other formats.
uint64_t count_nonfinite(VkFormat format, std::span<const std::byte> bytes);

}  // namespace candela::gpu
