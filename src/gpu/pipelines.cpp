#include "gpu/pipelines.h"

#include <tbb/parallel_for.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <set>
#include <thread>

#include "base/check.h"
#include "base/clock.h"
#include "base/files.h"
#include "base/log.h"
#include "gpu/compile_ahead.h"
#include "gpu/device_select.h"
#include "gpu/frame_runner.h"
#include "gpu/shared_device.h"
#include "gpu/specialization_info.h"
#include "gpu/specialize.h"
#include "gpu/workgroup_size.h"

namespace candela::gpu {

namespace {

std::string key_of(const std::vector<SpecConstant>& constants) {
  std::string key;
  for (const SpecConstant& c : constants) key += fmt::format(" {}={}", c.id, c.value);
  return key;
}
std::string key_of(const ComputePipelineDesc& d) { return d.shader + key_of(d.constants); }
std::string key_of(const GraphicsPipelineDesc& d) {
  std::string key =
      fmt::format("{}|{}{}|{}|", d.vertex_shader, d.fragment_shader, key_of(d.constants), int(d.topology));
  for (const VkFormat format : d.color_formats) key += fmt::format("{},", int(format));
  key += fmt::format("|{} {} {} {} {} {}", int(d.depth_format), d.samples, int(d.depth_compare), d.depth_test,
                     d.depth_write, int(d.blend));
  for (const AttachmentState& a : d.attachments) key += fmt::format("|{} {}", int(a.blend), a.write_mask);
  const StencilState& s = d.stencil;
  if (d.stencil_test)
    key += fmt::format("|stencil {} {} {} {} {} {}", int(s.compare), int(s.fail), int(s.depth_fail), int(s.pass),
                       s.read_mask, s.write_mask);
  return key + fmt::format("|{} {} {}", d.depth_bias_constant, d.depth_bias_slope, d.depth_clamp);
}
std::string key_of(const RayPipelineDesc& d) {
  return fmt::format("{}|{}|{}|{}|{}", d.raygen_shader, d.miss_shader, d.closest_hit_shader, d.any_hit_shader,
                     key_of(d.constants));
}
std::string key_of(const PipelineDesc& desc) {
  return std::visit([](const auto& d) { return key_of(d); }, desc);
}

std::vector<std::string> shaders_of(const PipelineDesc& desc) {
  if (const auto* compute = std::get_if<ComputePipelineDesc>(&desc)) return {compute->shader};
  if (const auto* rays = std::get_if<RayPipelineDesc>(&desc))
    return {rays->raygen_shader, rays->miss_shader, rays->closest_hit_shader, rays->any_hit_shader};
  const auto& graphics = std::get<GraphicsPipelineDesc>(desc);
  if (graphics.fragment_shader.empty()) return {graphics.vertex_shader};
  return {graphics.vertex_shader, graphics.fragment_shader};
}

bool uses(const std::vector<uint32_t>& spirv, uint32_t capability) {
  constexpr size_t header_words = 5;
  constexpr uint32_t op_capability = (2u << 16) | 17u;
  for (size_t i = header_words; i + 1 < spirv.size() && spirv[i] == op_capability; i += 2)
    if (spirv[i + 1] == capability) return true;
  return false;
}

VkPipelineColorBlendAttachmentState blend_state(const AttachmentState& attachment) {
  const Blend blend = attachment.blend;
  VkPipelineColorBlendAttachmentState state{};
  state.colorWriteMask = attachment.write_mask;  // Vulkan's bits, red to alpha
  state.blendEnable = blend != Blend::none;
  state.srcColorBlendFactor = state.srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
  state.dstColorBlendFactor = state.dstAlphaBlendFactor = blend == Blend::additive ? VK_BLEND_FACTOR_ONE
                                                          : blend == Blend::coverage
                                                              ? VK_BLEND_FACTOR_ONE_MINUS_SRC_COLOR
                                                              : VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  state.colorBlendOp = state.alphaBlendOp = blend == Blend::greatest ? VK_BLEND_OP_MAX : VK_BLEND_OP_ADD;
  return state;
}

// A pipeline of rays has a table, which is memory of this Device's own; the others are the store's.
std::shared_ptr<const Pipeline> kept_in_store(Device& device, const std::string& key, Pipeline made) {
  if (!made.table) return device.store().insert(key, std::move(made));
  return {new Pipeline(std::move(made)), [handle = device.handle()](const Pipeline* pipeline) {
            vkDestroyPipeline(handle, pipeline->handle, nullptr);
            delete pipeline;
          }};
}

}  // namespace

Pipelines::Pipelines(Device& device, Bindless& bindless, glsl::ShaderCompiler compiler,
                     std::filesystem::path cache_folder)
    : device_(device), bindless_(bindless), compiler_(std::move(compiler)), cache_folder_(std::move(cache_folder)) {
  vkGetPhysicalDeviceFeatures(device.physical(), &features_);  // what is optional is on where it is present
  specializes_ = device_.info().is_cpu;
  load_cache();
}

Pipelines::~Pipelines() {
  ahead_.reset();
  pipelines_.clear();
  for (const auto& [file, shader] : shaders_) vkDestroyShaderModule(device_.handle(), shader.module, nullptr);
  vkDestroyPipelineCache(device_.handle(), cache_, nullptr);
}

std::filesystem::path Pipelines::cache_file() const {
  if (cache_folder_.empty()) return {};
  const Hash128 driver = hash128(device_.info().driver + device_.info().name);
  return cache_folder_ / "pipelines" / fmt::format("{}-{}.bin", device_.info().uuid, driver.hex().substr(0, 8));
}

// The file is the hash of the data, then the data: drivers are not required to survive a damaged cache. A file of
// another driver has another name, and drivers refuse data whose header is not theirs.
void Pipelines::load_cache() {
  std::vector<std::byte> data;
  const std::filesystem::path path = cache_file();
  std::error_code absent;
  if (!path.empty() && std::filesystem::exists(path, absent)) {
    Hash128 stated;
    if (auto bytes = read_file(path); bytes && bytes->size() > sizeof stated) {
      std::memcpy(&stated, bytes->data(), sizeof stated);
      const auto payload = std::span(*bytes).subspan(sizeof stated);
      if (hash128(payload) == stated) {
        data.assign(payload.begin(), payload.end());
        on_disk_ = stated;
      }
    }
  }
  VkPipelineCacheCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  info.initialDataSize = data.size();
  info.pInitialData = data.data();
  if (vkCreatePipelineCache(device_.handle(), &info, nullptr, &cache_) != VK_SUCCESS) {
    info.initialDataSize = 0;
    VK_CHECK(vkCreatePipelineCache(device_.handle(), &info, nullptr, &cache_));
  }
}

void Pipelines::save_cache() {
  const std::filesystem::path path = cache_file();
  size_t size = 0;
  if (path.empty() || vkGetPipelineCacheData(device_.handle(), cache_, &size, nullptr) != VK_SUCCESS || size == 0)
    return;
  std::vector<std::byte> bytes(sizeof(Hash128) + size);
  if (vkGetPipelineCacheData(device_.handle(), cache_, &size, bytes.data() + sizeof(Hash128)) != VK_SUCCESS) return;
  bytes.resize(sizeof(Hash128) + size);
  const Hash128 hash = hash128(std::span(bytes).subspan(sizeof(Hash128)));
  if (hash == on_disk_) return;
  std::memcpy(bytes.data(), &hash, sizeof hash);
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  if (const auto written = replace_file_atomically(path, bytes); !written)
    log::debug("pipeline cache: {}", written.error().text());
  else
    on_disk_ = hash;
}

size_t Pipelines::compiled_ahead() { return ahead_ ? ahead_->finished() : 0; }

std::filesystem::path Pipelines::known_file() const { return cache_file().replace_extension(".known"); }

// The file has a hash a line of each compute pipeline that a process on this machine has used with this driver: where
// they are in it, so is their code in the driver's own cache, unless that was emptied.
void Pipelines::compile_ahead(std::span<const PipelineDesc> missing) {
  constexpr size_t least_shaders = 6, digits = 32, most_known = 1 << 15;
  if (!specializes_ || cache_folder_.empty() || std::thread::hardware_concurrency() < 2) return;
  // A layer that the environment asks for is to see what the program itself does.
  for (const char* name : {"VK_INSTANCE_LAYERS", "VK_LOADER_LAYERS_ENABLE"})
    if (const char* layers = std::getenv(name); layers && *layers) return;
  const auto chosen = candidate_without_validation(device_.instance(), device_.physical());
  if (!chosen) return;
  std::set<std::string> known;
  if (const auto bytes = read_file(known_file()))
    for (size_t at = 0; at + digits < bytes->size() && known.size() < most_known; at += digits + 1)
      known.emplace(reinterpret_cast<const char*>(bytes->data()) + at, digits);
  std::vector<ShaderAhead> shaders;
  for (const PipelineDesc& desc : missing)
    if (const auto* compute = std::get_if<ComputePipelineDesc>(&desc))
      if (known.insert(hash128(store_key(desc)).hex()).second)
        shaders.push_back({specialized(shaders_.at(compute->shader).spirv, compute->constants), compute->constants});
  if (shaders.empty()) return;
  std::string text;
  for (const std::string& one : known) text += one + "\n";
  std::error_code error;
  std::filesystem::create_directories(known_file().parent_path(), error);
  (void)replace_file_atomically(known_file(), std::as_bytes(std::span(text)));
  // Once in a process: what comes later comes bit by bit.
  static std::atomic<bool> done = false;
  if (shaders.size() < least_shaders || done.exchange(true)) return;
  const PipelineLayout& layout = device_.store().layout_of(bindless_.layout());
  ahead_ = std::make_unique<CompileAhead>(*chosen, layout.textures, layout.samplers, std::move(shaders));
}

Expected<void> Pipelines::compile(std::span<const PipelineDesc> wanted, PrepareTimes& times) {
  std::set<std::string> missing;
  for (const PipelineDesc& desc : wanted)
    for (const std::string& file : shaders_of(desc))
      if (!shaders_.contains(file)) missing.insert(file);
  if (missing.empty()) return {};
  const auto start = Clock::now();
  const std::vector<std::string> files(missing.begin(), missing.end());
  std::vector<Expected<glsl::ShaderCompiler::Result>> results(files.size());
  tbb::parallel_for(size_t(0), files.size(), [&](size_t i) { results[i] = compiler_.compile(files[i]); });
  for (size_t i = 0; i < files.size(); ++i) {
    if (!results[i]) return std::unexpected(results[i].error());
    shaders_.emplace(files[i], Shader{std::move(results[i]->spirv), results[i]->key});
    ++times.shaders;
    times.shaders_built_in += results[i]->built_in;
    times.shaders_from_cache += results[i]->from_cache;
  }
  times.compile_ms += ms_since(start);
  return {};
}

VkShaderModule Pipelines::make_module(std::span<const uint32_t> spirv, const std::string& file) const {
  VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  info.codeSize = spirv.size_bytes();
  info.pCode = spirv.data();
  VkShaderModule module = VK_NULL_HANDLE;
  VK_CHECK(vkCreateShaderModule(device_.handle(), &info, nullptr, &module));
  device_.set_name(VK_OBJECT_TYPE_SHADER_MODULE, uint64_t(module), file);
  return module;
}

void Pipelines::make_modules(std::span<const PipelineDesc> wanted) {
  for (const PipelineDesc& desc : wanted)
    for (const std::string& file : shaders_of(desc)) {
      Shader& shader = shaders_.at(file);
      // Vertex shaders stay whole: with draw.vert pruned lavapipe 25.0.7 draws shadows in the wrong place. The cause is
      // not known (docs/building/decisions.md).
      const auto* drawing = std::get_if<GraphicsPipelineDesc>(&desc);
      if (shader.module || (specializes_ && !(drawing && file == drawing->vertex_shader))) continue;
      shader.module = make_module(shader.spirv, file);
    }
}

std::string Pipelines::store_key(const PipelineDesc& desc) const {
  std::string key = fmt::format("{} {}", bindless_.room(), key_of(desc));
  for (const std::string& file : shaders_of(desc)) key += " " + shaders_.at(file).content.hex();
  return key;
}

bool Pipelines::hold(std::span<const PipelineDesc> wanted) const {
  return std::ranges::all_of(wanted, [&](const PipelineDesc& desc) { return pipelines_.contains(key_of(desc)); });
}

Expected<std::vector<const Pipeline*>> Pipelines::get(std::span<const PipelineDesc> wanted, PrepareTimes& times) {
  std::vector<PipelineDesc> absent;
  std::set<std::string> absent_keys;
  for (const PipelineDesc& desc : wanted)
    if (std::string key = key_of(desc); !pipelines_.contains(key) && absent_keys.insert(std::move(key)).second)
      absent.push_back(desc);
  if (const auto compiled = compile(absent, times); !compiled) return std::unexpected(compiled.error());
  std::vector<PipelineDesc> missing;
  for (const PipelineDesc& desc : absent)
    if (auto kept = device_.store().find(store_key(desc)))
      pipelines_.emplace(key_of(desc), std::move(kept));
    else
      missing.push_back(desc);
  if (!missing.empty()) {
    const auto start = Clock::now();
    make_modules(missing);
    compile_ahead(missing);
    std::vector<Pipeline> made(missing.size());
    std::vector<std::exception_ptr> failures(missing.size());
    tbb::parallel_for(size_t(0), missing.size(), [&](size_t i) {
      try {
        made[i] = std::visit([&](const auto& desc) { return make(desc); }, missing[i]);
      } catch (...) {
        failures[i] = std::current_exception();
      }
    });
    for (size_t i = 0; i < missing.size(); ++i) {
      if (!made[i].handle) continue;
      device_.set_name(VK_OBJECT_TYPE_PIPELINE, uint64_t(made[i].handle), key_of(missing[i]));
      pipelines_.emplace(key_of(missing[i]), kept_in_store(device_, store_key(missing[i]), std::move(made[i])));
      ++times.pipelines;
    }
    for (const std::exception_ptr& failure : failures)
      if (failure) std::rethrow_exception(failure);
    times.pipeline_ms += ms_since(start);
    save_cache();
  }
  std::vector<const Pipeline*> result;
  for (const PipelineDesc& desc : wanted) result.push_back(pipelines_.at(key_of(desc)).get());
  return result;
}

Pipelines::Module Pipelines::module(const std::string& file, const std::vector<SpecConstant>& constants) const {
  const Shader& shader = shaders_.at(file);
  Module made;
  made.handle = shader.module;
  if (made.handle) return made;
  made.handle = make_module(specialized(shader.spirv, constants), file);
  made.owner = device_.handle();
  return made;
}
Pipelines::Module::~Module() {
  if (owner) vkDestroyShaderModule(owner, handle, nullptr);
}

void Pipelines::check_queries(const std::string& file) const {
  constexpr uint32_t ray_query = 4472;  // of SPIR-V
  if (uses(shaders_.at(file).spirv, ray_query) && !device_.info().rays.queries)
    throw GpuError(VK_ERROR_FEATURE_NOT_PRESENT, fmt::format("{}, for {}", VK_KHR_RAY_QUERY_EXTENSION_NAME, file));
}

Pipeline Pipelines::make(const ComputePipelineDesc& desc) const {
  constexpr uint32_t int64_atomics = 12;  // of SPIR-V
  if (!has_int64_atomics(device_.physical()) && uses(shaders_.at(desc.shader).spirv, int64_atomics))
    throw GpuError(VK_ERROR_FEATURE_NOT_PRESENT, fmt::format("shaderBufferInt64Atomics, for {}", desc.shader));
  check_queries(desc.shader);
  const Specialization specialization(desc.constants);
  VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  info.flags = VK_PIPELINE_CREATE_DISPATCH_BASE_BIT;  // CommandList::dispatch_picture
  info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  const Module code = module(desc.shader, desc.constants);
  info.stage.module = code.handle;
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &specialization.info;
  info.layout = bindless_.layout();
  Pipeline pipeline;
  pipeline.workgroup = workgroup_size(shaders_.at(desc.shader).spirv, desc.constants);
  CHECK_MSG(pipeline.workgroup[0] * pipeline.workgroup[1] * pipeline.workgroup[2] > 0, desc.shader);
  VK_CHECK(vkCreateComputePipelines(device_.handle(), cache_, 1, &info, nullptr, &pipeline.handle));
  return pipeline;
}

Pipeline Pipelines::make(const GraphicsPipelineDesc& desc) const {
  const Specialization specialization(desc.constants);
  std::vector<VkPipelineShaderStageCreateInfo> stages;
  std::vector<Module> modules;
  const auto add_stage = [&](VkShaderStageFlagBits stage, const std::string& file) {
    VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
    info.stage = stage;
    info.module = modules.emplace_back(module(file, desc.constants)).handle;
    info.pName = "main";
    info.pSpecializationInfo = &specialization.info;
    stages.push_back(info);
  };
  add_stage(VK_SHADER_STAGE_VERTEX_BIT, desc.vertex_shader);
  if (!desc.fragment_shader.empty()) add_stage(VK_SHADER_STAGE_FRAGMENT_BIT, desc.fragment_shader);

  const VkPipelineVertexInputStateCreateInfo vertex_input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = desc.topology;
  VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  viewport.viewportCount = viewport.scissorCount = 1;
  VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  raster.lineWidth = 1;
  raster.depthBiasEnable = desc.depth_bias_constant != 0 || desc.depth_bias_slope != 0;
  raster.depthBiasConstantFactor = desc.depth_bias_constant;
  raster.depthBiasSlopeFactor = desc.depth_bias_slope;
  raster.depthClampEnable = desc.depth_clamp;
  if (!desc.fragment_shader.empty()) {
    check_queries(desc.fragment_shader);
    constexpr uint32_t geometry = 2, post_depth_coverage = 4447;  // of SPIR-V
    const std::vector<uint32_t>& spirv = shaders_.at(desc.fragment_shader).spirv;
    if (uses(spirv, geometry) && !features_.geometryShader)
      throw GpuError(VK_ERROR_FEATURE_NOT_PRESENT, fmt::format("geometryShader, for {}", desc.fragment_shader));
    if (uses(spirv, post_depth_coverage) && !device_.info().post_depth_coverage)
      throw GpuError(VK_ERROR_FEATURE_NOT_PRESENT,
                     fmt::format("{}, for {}", VK_EXT_POST_DEPTH_COVERAGE_EXTENSION_NAME, desc.fragment_shader));
  }
  if (desc.depth_clamp && !features_.depthClamp)
    throw GpuError(VK_ERROR_FEATURE_NOT_PRESENT, fmt::format("depthClamp, for {}", desc.vertex_shader));
  VkPipelineMultisampleStateCreateInfo multisample{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  multisample.rasterizationSamples = VkSampleCountFlagBits(desc.samples);
  VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  depth.depthTestEnable = desc.depth_test;
  depth.depthWriteEnable = desc.depth_write;
  depth.depthCompareOp = desc.depth_compare;
  depth.stencilTestEnable = desc.stencil_test;
  const StencilState& s = desc.stencil;
  depth.front = depth.back = {s.fail, s.pass, s.depth_fail, s.compare, s.read_mask, s.write_mask, 0};
  CHECK_MSG(desc.attachments.empty() || desc.attachments.size() == desc.color_formats.size(), desc.fragment_shader);
  std::vector<VkPipelineColorBlendAttachmentState> attachments;
  for (size_t i = 0; i < desc.color_formats.size(); ++i)
    attachments.push_back(blend_state(desc.attachments.empty() ? AttachmentState{desc.blend} : desc.attachments[i]));
  VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blend.attachmentCount = uint32_t(attachments.size());
  blend.pAttachments = attachments.data();
  const VkDynamicState dynamic_states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR,
                                           VK_DYNAMIC_STATE_CULL_MODE, VK_DYNAMIC_STATE_FRONT_FACE,
                                           VK_DYNAMIC_STATE_STENCIL_REFERENCE};
  VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
  dynamic.dynamicStateCount = uint32_t(std::size(dynamic_states));
  dynamic.pDynamicStates = dynamic_states;
  VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
  rendering.colorAttachmentCount = uint32_t(desc.color_formats.size());
  rendering.pColorAttachmentFormats = desc.color_formats.data();
  rendering.depthAttachmentFormat = desc.depth_format;
  if (has_stencil(desc.depth_format)) rendering.stencilAttachmentFormat = desc.depth_format;

  VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, &rendering};
  info.stageCount = uint32_t(stages.size());
  info.pStages = stages.data();
  info.pVertexInputState = &vertex_input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &multisample;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = bindless_.layout();
  Pipeline pipeline;
  pipeline.bind_point = VK_PIPELINE_BIND_POINT_GRAPHICS;
  VK_CHECK(vkCreateGraphicsPipelines(device_.handle(), cache_, 1, &info, nullptr, &pipeline.handle));
  return pipeline;
}

Pipeline Pipelines::make(const RayPipelineDesc& desc) const {
  if (!device_.info().rays.pipelines)
    throw GpuError(VK_ERROR_FEATURE_NOT_PRESENT,
                   fmt::format("{}, for {}", VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME, desc.raygen_shader));
  const Specialization specialization(desc.constants);
  const std::pair<VkShaderStageFlagBits, const std::string*> stages[] = {
      {VK_SHADER_STAGE_RAYGEN_BIT_KHR, &desc.raygen_shader},
      {VK_SHADER_STAGE_MISS_BIT_KHR, &desc.miss_shader},
      {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, &desc.closest_hit_shader},
      {VK_SHADER_STAGE_ANY_HIT_BIT_KHR, &desc.any_hit_shader}};
  std::vector<VkPipelineShaderStageCreateInfo> stage_infos;
  std::vector<Module> modules;
  for (const auto& [stage, file] : stages) {
    VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
    info.stage = stage;
    info.module = modules.emplace_back(module(*file, desc.constants)).handle;
    info.pName = "main";
    info.pSpecializationInfo = &specialization.info;
    stage_infos.push_back(info);
  }
  constexpr uint32_t none = VK_SHADER_UNUSED_KHR;
  const auto group = [&](VkRayTracingShaderGroupTypeKHR type, uint32_t general, uint32_t closest, uint32_t any) {
    return VkRayTracingShaderGroupCreateInfoKHR{VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR,
                                                nullptr,
                                                type,
                                                general,
                                                closest,
                                                any,
                                                none,
                                                nullptr};
  };
  const VkRayTracingShaderGroupCreateInfoKHR groups[] = {
      group(VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR, 0, none, none),
      group(VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR, 1, none, none),
      group(VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR, none, 2, 3)};
  VkRayTracingPipelineCreateInfoKHR info{VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR};
  info.stageCount = uint32_t(stage_infos.size());
  info.pStages = stage_infos.data();
  info.groupCount = uint32_t(std::size(groups));
  info.pGroups = groups;
  info.maxPipelineRayRecursionDepth = 1;
  info.layout = bindless_.layout();
  Pipeline pipeline;
  pipeline.bind_point = VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR;
  VK_CHECK(device_.function<PFN_vkCreateRayTracingPipelinesKHR>("vkCreateRayTracingPipelinesKHR")(
      device_.handle(), VK_NULL_HANDLE, cache_, 1, &info, nullptr, &pipeline.handle));
  try {
    pipeline.table = make_shader_table(device_, pipeline.handle);
  } catch (...) {
    vkDestroyPipeline(device_.handle(), pipeline.handle, nullptr);
    throw;
  }
  return pipeline;
}

}  // namespace candela::gpu
