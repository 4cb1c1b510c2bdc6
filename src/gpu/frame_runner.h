#pragma once
#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/hash.h"
#include "glsl/shader_compiler.h"
#include "gpu/bindless.h"
#include "gpu/device.h"
#include "gpu/resources.h"
#include "graph/builder.h"

namespace candela::gpu {

class KeptImage;

struct PassTime {
  std::string name;
  double gpu_ms = 0;
};

// Bytes a frame left for the host. Mapped device memory, given back to the runner's pool when the last owner lets go,
// so an encoder thread reads them while the next frame renders. They must not outlive the device.
class Readback {
 public:
  virtual ~Readback() = default;
  virtual std::span<const std::byte> bytes() const = 0;
};

// What a frame takes from outside, by resource of its plan.
template <class T>
class ByResource {
 public:
  ByResource() = default;
  ByResource(std::initializer_list<std::pair<int, const T*>> all) {
    for (const auto& [resource, of] : all) (*this)[resource] = of;
  }
  const T*& operator[](int resource) {
    if (size_t(resource) >= of_.size()) of_.resize(size_t(resource) + 1, nullptr);
    return of_[size_t(resource)];
  }
  const T* find(int resource) const { return size_t(resource) < of_.size() ? of_[size_t(resource)] : nullptr; }
  void clear() { of_.clear(); }

 private:
  std::vector<const T*> of_;
};
using Imports = ByResource<Buffer>;

struct RunOptions {
  bool timed = false;         // stamps per pass; on a CPU device every pass is then its own submission
  bool hash_outputs = false;  // after each pass, hash everything it wrote and count non-finite values (debugging; slow)
  // The frame's time as a whole (FrameRun::whole_ms), whatever runs side by side in it.
  bool whole = false;
  bool spans = false;            // when it began and ended on the device; frames stay in flight
  bool one_queue = false;        // passes of the compute queue run on the main one
  std::vector<int> batch_order;  // of the plan's batches; empty: the plan's own
  ByResource<KeptImage> images;  // the plan's imported images
};
struct PassHash {
  std::string pass, resource;
  Hash128 hash;
  uint64_t nonfinite = 0;  // float and half images only
};
struct FrameRun {
  std::vector<PassTime> passes;                      // when timed; they sum to frame_gpu_ms
  double frame_gpu_ms = 0;                           // the sum of passes: isolated timing, nothing overlaps
  double whole_ms = 0;                               // on the device, or the host's wait for it where that is a CPU
  double record_ms = 0, submit_ms = 0, wait_ms = 0;  // CPU
  // By the device's clock: asked for, and where it has one.
  struct OnDevice {
    double began_ms = 0, length_ms = 0;
  };
  std::optional<OnDevice> on_device;
  std::map<int, std::shared_ptr<Readback>> readbacks;  // by resource of sink buffers with memory host_read
  std::vector<PassHash> hashes;
};
struct PrepareTimes {
  double compile_ms = 0;   // GLSL to SPIR-V, wall time of the parallel step
  double pipeline_ms = 0;  // SPIR-V to pipelines, likewise
  double allocate_ms = 0;
  bool allocated = false;  // images and buffers were made anew
  int shaders = 0, shaders_built_in = 0, shaders_from_cache = 0, pipelines = 0;
};

using FrameTicket = uint64_t;  // of a frame that was submitted and not yet collected

// Runs compiled graphs. Owns pipelines (made once, kept by description, saved in a VkPipelineCache on disk), the
// physical images and buffers of the last plan (kept while plans differ only in what they import; of the last two where
// frames go to and fro between these) and the readback pool; for each frame in flight a command pool, a fence, a query
// pool and descriptor sets. Frames of the same plan, one after another, ask the heap for nothing until they are
// submitted.
//
// Frames in flight share the plan's images and device buffers: a frame begins on the device when the one before has
// ended there, so what overlaps is the host's work with the device's. What an older plan owned lives until the frames
// that use it are done.
//
// Batches of a plan with two queues run on both where the device has a second one, ordered by timeline semaphores, else
// one after another on the one queue. Timed and hashed runs are serial.
class FrameRunner {
 public:
  FrameRunner(Device& device, Bindless& bindless, glsl::ShaderCompiler compiler, std::filesystem::path cache_folder);
  ~FrameRunner();
  // Whether all pipelines of the plan are there.
  bool is_compiled(const CompiledGraph& graph) const;
  // Compiles in parallel what the plan holds. Errors (input) for a shader that does not compile. Beside it, on another
  // thread, allocate() may run, and whatever does not use the runner.
  Expected<PrepareTimes> compile(const CompiledGraph& graph);
  // Makes the images and buffers that the plan names; false: those of the last plan serve. Throws GpuError.
  bool allocate(const CompiledGraph& graph);
  // Both, where they have not been done; before submit().
  Expected<PrepareTimes> prepare(const CompiledGraph& graph);
  // Records the frame and hands it to the device. imports: the physical buffer for each imported resource of the plan;
  // keep: whatever must live, and stay as it is, until the device is done with the frame; the graph lives until
  // collect(), with the caller or here. A timed or hashed run has the device to itself: it waits for the frames before
  // it, and is over when submit returns. Throws GpuError.
  FrameTicket submit(const CompiledGraph& graph, const Imports& imports, const RunOptions& options,
                     const std::vector<std::shared_ptr<const void>>& keep = {});
  // Waits for the frame and gives what it left; each ticket once. A wait longer than timeout_s (default 600) is an
  // error that names the passes not finished; the next frame waits for what was given up on. Throws GpuError.
  FrameRun collect(FrameTicket ticket);
  FrameRun run(const CompiledGraph& graph, const Imports& imports, const RunOptions& options,
               const std::vector<std::shared_ptr<const void>>& keep = {}) {
    return collect(submit(graph, imports, options, keep));
  }
  double timeout_s = 600;

 private:
  struct Hidden;
  std::unique_ptr<Hidden> hidden_;
};

}  // namespace candela::gpu
