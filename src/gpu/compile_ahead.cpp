#include "gpu/compile_ahead.h"

#include "base/log.h"
#include "gpu/device.h"
#include "gpu/pipelines.h"
#include "gpu/shared_device.h"
#include "gpu/specialization_info.h"

namespace candela::gpu {
namespace {

// The device, opened once more.
class Second {
 public:
  Second(const Candidate& chosen, uint32_t textures, uint32_t samplers) {
    const Expected<VkDevice> opened = create_device(chosen);
    if (!opened) throw GpuError(VK_ERROR_INITIALIZATION_FAILED, opened.error().message);
    device_ = *opened;
    try {
      store_ = std::make_unique<PipelineStore>(device_);
      layout_ = store_->layout(textures, samplers).handle;
      vkGetDeviceQueue(device_, chosen.queue_family, 0, &queue_);
      VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
      pool.queueFamilyIndex = chosen.queue_family;
      VK_CHECK(vkCreateCommandPool(device_, &pool, nullptr, &pool_));
    } catch (...) {
      close();
      throw;
    }
  }
  ~Second() { close(); }
  Second(const Second&) = delete;
  Second& operator=(const Second&) = delete;

  void compile(const ShaderAhead& shader) {
    VkShaderModule module = VK_NULL_HANDLE;
    VkPipeline pipeline = VK_NULL_HANDLE;
    try {
      VkShaderModuleCreateInfo code{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
      code.codeSize = shader.spirv.size() * sizeof(uint32_t);
      code.pCode = shader.spirv.data();
      VK_CHECK(vkCreateShaderModule(device_, &code, nullptr, &module));
      const Specialization specialization(shader.constants);
      VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
      info.flags = VK_PIPELINE_CREATE_DISPATCH_BASE_BIT;  // as Pipelines' own
      info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
      info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
      info.stage.module = module;
      info.stage.pName = "main";
      info.stage.pSpecializationInfo = &specialization.info;
      info.layout = layout_;
      VK_CHECK(vkCreateComputePipelines(device_, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline));
      dispatch_nothing(pipeline);
    } catch (...) {
      vkDestroyPipeline(device_, pipeline, nullptr);
      vkDestroyShaderModule(device_, module, nullptr);
      throw;
    }
    vkDestroyPipeline(device_, pipeline, nullptr);
    vkDestroyShaderModule(device_, module, nullptr);
  }

 private:
  void dispatch_nothing(VkPipeline pipeline) {
    VK_CHECK(vkResetCommandPool(device_, pool_, 0));
    VkCommandBufferAllocateInfo one{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    one.commandPool = pool_;
    one.commandBufferCount = 1;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VK_CHECK(vkAllocateCommandBuffers(device_, &one, &commands));
    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    VK_CHECK(vkBeginCommandBuffer(commands, &begin));
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdDispatch(commands, 0, 0, 0);
    VK_CHECK(vkEndCommandBuffer(commands));
    VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands;
    VK_CHECK(vkQueueSubmit(queue_, 1, &submit, VK_NULL_HANDLE));
    VK_CHECK(vkQueueWaitIdle(queue_));
    vkFreeCommandBuffers(device_, pool_, 1, &commands);
  }
  void close() {
    vkDeviceWaitIdle(device_);
    vkDestroyCommandPool(device_, pool_, nullptr);
    store_.reset();
    vkDestroyDevice(device_, nullptr);
  }
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  std::unique_ptr<PipelineStore> store_;
};

}  // namespace

CompileAhead::CompileAhead(const Candidate& device, uint32_t textures, uint32_t samplers,
                           std::vector<ShaderAhead> shaders)
    : thread_([this, device, textures, samplers, shaders = std::move(shaders)] {
        try {
          Second second(device, textures, samplers);
          // The first passes are the frame's own: it reaches them before these would.
          const size_t own = shaders.size() * 2 / 5;
          for (size_t i = shaders.size(); i-- > own && !ends_; ++compiled_) second.compile(shaders[i]);
        } catch (const std::exception& error) {
          log::debug("nothing more is compiled ahead: {}", error.what());
        }
      }) {}

CompileAhead::~CompileAhead() {
  ends_ = true;
  finished();
}

size_t CompileAhead::finished() {
  if (thread_.joinable()) thread_.join();
  return compiled_;
}

}  // namespace candela::gpu
