#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/hash.h"
#include "glsl/shader_compiler.h"
#include "gpu/bindless.h"
#include "gpu/device.h"
#include "gpu/shader_table.h"
#include "graph/plan.h"

namespace candela::gpu {

class CompileAhead;
struct PrepareTimes;

struct Pipeline {
  VkPipeline handle = VK_NULL_HANDLE;
  VkPipelineBindPoint bind_point = VK_PIPELINE_BIND_POINT_COMPUTE;
  std::array<uint32_t, 3> workgroup{};       // compute only
  std::shared_ptr<const ShaderTable> table;  // rays only
};

// Pipelines by description, made once and kept. Behind them are those of the device's store, which outlive this, and a
// VkPipelineCache on disk, one file for each device and driver. Pipelines of rays are not in the store: their tables
// are memory that this device accounts for.
class Pipelines {
 public:
  Pipelines(Device& device, Bindless& bindless, glsl::ShaderCompiler compiler, std::filesystem::path cache_folder);
  ~Pipelines();
  Pipelines(const Pipelines&) = delete;
  Pipelines& operator=(const Pipelines&) = delete;
  // Parallel to `wanted`. Compiles and builds, in parallel, those that are not there yet, and adds what that cost to
  // `times`.
  Expected<std::vector<const Pipeline*>> get(std::span<const PipelineDesc> wanted, PrepareTimes& times);
  bool hold(std::span<const PipelineDesc> wanted) const;  // all of them are there
  std::filesystem::path cache_file() const;
  size_t compiled_ahead();  // how many compute shaders; waits for them

 private:
  Expected<void> compile(std::span<const PipelineDesc> wanted, PrepareTimes& times);
  void make_modules(std::span<const PipelineDesc> wanted);
  // What a pipeline is made of: the key of the description with the shaders' contents, and the layout.
  std::string store_key(const PipelineDesc& desc) const;
  Pipeline make(const ComputePipelineDesc& desc) const;
  Pipeline make(const GraphicsPipelineDesc& desc) const;
  Pipeline make(const RayPipelineDesc& desc) const;
  void check_queries(const std::string& file) const;
  // Of the shader, or one of its own of what the constants leave of it (gpu/specialize.h), which ends with it.
  struct Module {
    Module() = default;
    Module(Module&& other) noexcept : handle(other.handle), owner(std::exchange(other.owner, nullptr)) {}
    ~Module();
    VkShaderModule handle = VK_NULL_HANDLE;
    VkDevice owner = nullptr;
  };
  Module module(const std::string& file, const std::vector<SpecConstant>& constants) const;
  VkShaderModule make_module(std::span<const uint32_t> spirv, const std::string& file) const;
  void load_cache();
  void save_cache();
  // Where the driver's cache on disk has little of them, as far as is known, begins to fill it (gpu/compile_ahead.h).
  void compile_ahead(std::span<const PipelineDesc> missing);
  std::filesystem::path known_file() const;

  Device& device_;
  Bindless& bindless_;
  glsl::ShaderCompiler compiler_;
  std::filesystem::path cache_folder_;
  VkPhysicalDeviceFeatures features_{};
  bool specializes_ = false;  // a CPU device, whose driver takes long over code that is never reached
  VkPipelineCache cache_ = VK_NULL_HANDLE;
  Hash128 on_disk_;  // of the data in the cache file
  struct Shader {
    std::vector<uint32_t> spirv;
    Hash128 content;                         // of the source and all that the compiler was given
    VkShaderModule module = VK_NULL_HANDLE;  // where a pipeline was made of it
  };
  std::map<std::string, Shader> shaders_;                             // by file
  std::map<std::string, std::shared_ptr<const Pipeline>> pipelines_;  // by key
  std::unique_ptr<CompileAhead> ahead_;
};

}  // namespace candela::gpu
