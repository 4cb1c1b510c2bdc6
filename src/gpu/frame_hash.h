#pragma once
#include <vector>

#include "gpu/command_list_impl.h"
#include "gpu/frame_runner.h"
#include "gpu/queue_work.h"

namespace candela::gpu {

// Copies what `pass`, which has just finished, wrote to the host and appends its hashes. Multisampled images cannot be
// copied: their entry says so in its name and has no hash.
void hash_outputs(const FrameContext& frame, size_t pass, QueueWork& work, Buffer& staging,
                  std::vector<PassHash>& hashes);

// How many infinities and NaNs there are among `bytes` of texels of a float or half format; 0 for other formats.
uint64_t count_nonfinite(VkFormat format, std::span<const std::byte> bytes);

}  // namespace candela::gpu
