#pragma once
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "gpu/device_select.h"
#include "graph/pipeline_desc.h"

namespace candela::gpu {

// Compute shaders in the order of their passes, as the driver is given them.
struct ShaderAhead {
  std::vector<uint32_t> spirv;
  std::vector<SpecConstant> constants;
};

// A CPU device's driver makes machine code when a dispatch first asks for it, in the one thread of its one queue: with
// the driver's own cache empty the first frame waits for one core while the others have nothing to do (llvmpipe 25.0.7:
// 0.5 of 1.2 s for the compute passes of a frame without effects). This opens the device once more and has it dispatch
// no groups of the same shaders, the last pass first, while the frame begins with its first. What that makes goes to
// the driver's cache on disk, where the frame finds it. Whatever fails in it ends it, and nothing else.
class CompileAhead {
 public:
  CompileAhead(const Candidate& device, uint32_t textures, uint32_t samplers, std::vector<ShaderAhead> shaders);
  ~CompileAhead();    // ends it after the shader that it is at
  size_t finished();  // waits until it has ended; how many shaders it has compiled
  CompileAhead(const CompileAhead&) = delete;
  CompileAhead& operator=(const CompileAhead&) = delete;

 private:
  std::atomic<bool> ends_ = false;
  std::atomic<size_t> compiled_ = 0;
  std::thread thread_;
};

}  // namespace candela::gpu
