#include "glsl/modules/glslang_module.h"

#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>

#include <exception>
#include <mutex>
#include <string>
#include <vector>

#include "glsl/compiler_identity.h"

namespace {

EShLanguage stage_of(CandelaGlslStage stage) {
  constexpr EShLanguage stages[] = {EShLangVertex, EShLangFragment,   EShLangCompute, EShLangRayGen,
                                    EShLangAnyHit, EShLangClosestHit, EShLangMiss};
  return stages[stage];
}

class Includer : public glslang::TShader::Includer {
 public:
  explicit Includer(const CandelaGlslRequest& request) : request_(request) {}
  IncludeResult* includeLocal(const char* include, const char* includer, size_t) override {
    CandelaGlslText file{};
    const char* from = includer && *includer ? includer : request_.root.name;
    if (!request_.include(request_.user, include, from, &file)) return nullptr;
    return new IncludeResult(file.name, file.text, file.size, nullptr);
  }
  void releaseInclude(IncludeResult* result) override { delete result; }

 private:
  const CandelaGlslRequest& request_;
};

void compile(const CandelaGlslRequest& request) {
  static std::once_flag initialized;
  std::call_once(initialized, [] { glslang::InitializeProcess(); });
  const EShLanguage stage = stage_of(request.stage);
  const int length = int(request.root.size);
  glslang::TShader shader(stage);
  shader.setStringsWithLengthsAndNames(&request.root.text, &length, &request.root.name, 1);
  const std::string preamble = std::string("#extension GL_GOOGLE_include_directive : require\n") + request.definitions;
  shader.setPreamble(preamble.c_str());
  shader.setEnvInput(glslang::EShSourceGlsl, stage, glslang::EShClientVulkan, 100);
  shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
  shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_6);
  const auto messages = EShMessages(EShMsgSpvRules | EShMsgVulkanRules);
  Includer includer(request);
  if (!shader.parse(GetDefaultResources(), 460, false, messages, includer))
    return request.failed(request.user, shader.getInfoLog());
  glslang::TProgram program;
  program.addShader(&shader);
  if (!program.link(messages)) return request.failed(request.user, program.getInfoLog());
  std::vector<uint32_t> spirv;
  glslang::SpvOptions options;
  options.disableOptimizer = true;  // drivers optimise; the code stays what the source says
  glslang::GlslangToSpv(*program.getIntermediate(stage), spirv, &options);
  request.done(request.user, spirv.data(), spirv.size());
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const char* candela_glsl_identity() {
  return candela::glsl::compiler_identity;
}

extern "C" __attribute__((visibility("default"))) void candela_glsl_compile(const CandelaGlslRequest* request) {
  try {
    compile(*request);
  } catch (const std::exception& e) {
    request->failed(request->user, e.what());
  }
}
