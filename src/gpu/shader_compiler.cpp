#include "gpu/shader_compiler.h"

#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <glslang/build_info.h>

#include <cstring>
#include <mutex>
#include <optional>
#include <set>

#include "base/files.h"
#include "base/hash.h"
#include "base/log.h"
#include "gpu/shader_files.h"

namespace candela::gpu {

namespace {

constexpr uint32_t spirv_magic = 0x07230203;

// Everything about the compiler that changes its output: part of the cache key.
std::string compiler_identity() {
  return fmt::format("glslang {}.{}.{}{} generator {} vulkan 1.3 spirv 1.6", GLSLANG_VERSION_MAJOR,
                     GLSLANG_VERSION_MINOR, GLSLANG_VERSION_PATCH, GLSLANG_VERSION_FLAVOR,
                     glslang::GetSpirvGeneratorVersion());
}

std::optional<EShLanguage> stage_of(const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  if (ending == ".vert") return EShLangVertex;
  if (ending == ".frag") return EShLangFragment;
  if (ending == ".comp") return EShLangCompute;
  return std::nullopt;
}

// Hands glslang the files that are loaded already. A second inclusion of a file with #pragma once is empty.
class Includer : public glslang::TShader::Includer {
 public:
  explicit Includer(const ShaderFiles& files) : files_(files) {}
  IncludeResult* includeLocal(const char* include, const char* includer, size_t) override {
    const ShaderFile* file = files_.resolve(include, includer && *includer ? includer : files_.files[0].name);
    if (!file) return nullptr;
    const bool again = !seen_.insert(file).second && file->once;
    return new IncludeResult(file->name, file->text.data(), again ? 0 : file->text.size(), nullptr);
  }
  void releaseInclude(IncludeResult* result) override { delete result; }

 private:
  const ShaderFiles& files_;
  std::set<const ShaderFile*> seen_;
};

// "ERROR: lib/brdf.glsl:12: 'x' : undeclared identifier" becomes place and message.
Error compile_error(const ShaderFiles& files, std::string_view log) {
  Error error{ErrorKind::input, {}, files.files[0].name};
  bool first = true;
  while (!log.empty()) {
    std::string_view line = log.substr(0, log.find('\n'));
    log.remove_prefix(std::min(log.size(), line.size() + 1));
    if (!line.starts_with("ERROR: ")) continue;
    line.remove_prefix(7);
    if (line.find("compilation errors") != std::string_view::npos) continue;
    const size_t colon = line.find(':');
    const size_t after = colon == std::string_view::npos ? colon : line.find(": ", colon + 1);
    if (!first || after == std::string_view::npos) {
      error.message += (error.message.empty() ? "" : "; ") + std::string(line);
      continue;
    }
    first = false;
    error.place = line.substr(0, after);
    error.message = line.substr(after + 2);
    const ShaderFile* file = files.find(std::string(line.substr(0, colon)));
    if (file && !file->included_by.empty()) error.place += ", included by " + file->included_by;
  }
  if (error.message.empty()) error.message = "does not compile, and the compiler gives no reason";
  return error;
}

// "layers.frag#DEPTH=0#NORMAL=1": the file, and its definitions as preprocessor lines.
struct NamedShader {
  std::string file, definitions;
};
NamedShader split_definitions(const std::string& name) {
  NamedShader shader{name.substr(0, name.find('#')), ""};
  for (size_t at = name.find('#'); at != std::string::npos;) {
    const size_t end = name.find('#', at + 1);
    std::string definition = name.substr(at + 1, end == std::string::npos ? end : end - at - 1);
    std::replace(definition.begin(), definition.end(), '=', ' ');
    shader.definitions += "#define " + definition + "\n";
    at = end;
  }
  return shader;
}

Expected<std::vector<uint32_t>> translate(const ShaderFiles& files, const std::string& definitions, EShLanguage stage) {
  static std::once_flag initialized;
  std::call_once(initialized, [] { glslang::InitializeProcess(); });
  const ShaderFile& root = files.files[0];
  const char* text = root.text.data();
  const char* name = root.name.c_str();
  const int length = int(root.text.size());
  glslang::TShader shader(stage);
  shader.setStringsWithLengthsAndNames(&text, &length, &name, 1);
  const std::string preamble = "#extension GL_GOOGLE_include_directive : require\n" + definitions;
  shader.setPreamble(preamble.c_str());
  shader.setEnvInput(glslang::EShSourceGlsl, stage, glslang::EShClientVulkan, 100);
  shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
  shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_6);
  const auto messages = EShMessages(EShMsgSpvRules | EShMsgVulkanRules);
  Includer includer(files);
  if (!shader.parse(GetDefaultResources(), 460, false, messages, includer))
    return std::unexpected(compile_error(files, shader.getInfoLog()));
  glslang::TProgram program;
  program.addShader(&shader);
  if (!program.link(messages)) return std::unexpected(compile_error(files, program.getInfoLog()));
  std::vector<uint32_t> spirv;
  glslang::SpvOptions options;
  options.disableOptimizer = true;  // drivers optimise; the code stays what the source says
  glslang::GlslangToSpv(*program.getIntermediate(stage), spirv, &options);
  return spirv;
}

// A cache file is the key that it was made under, the hash of its words, and the words: a whole file under another
// key's name is another shader.
struct CachedHead {
  Hash128 key, content;
};

std::optional<std::vector<uint32_t>> read_cached(const std::filesystem::path& path, const Hash128& key) {
  std::error_code absent;
  if (!std::filesystem::exists(path, absent)) return std::nullopt;
  const auto bytes = read_file(path);
  if (!bytes || bytes->size() < sizeof(CachedHead) + 5 * 4 || bytes->size() % 4 != 0) return std::nullopt;
  const auto words = std::span(*bytes).subspan(sizeof(CachedHead));
  CachedHead head;
  std::memcpy(&head, bytes->data(), sizeof head);
  if (head.key != key || head.content != hash128(words)) return std::nullopt;
  std::vector<uint32_t> spirv(words.size() / 4);
  std::memcpy(spirv.data(), words.data(), words.size());
  if (spirv[0] != spirv_magic) return std::nullopt;
  return spirv;
}

// A cache that cannot be written costs time, never the result.
void write_cached(const std::filesystem::path& path, const Hash128& key, const std::vector<uint32_t>& spirv) {
  const auto words = std::as_bytes(std::span(spirv));
  const CachedHead head{key, hash128(words)};
  std::vector<std::byte> bytes(sizeof head + words.size());
  std::memcpy(bytes.data(), &head, sizeof head);
  std::memcpy(bytes.data() + sizeof head, words.data(), words.size());
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  if (const auto written = write_file_atomically(path, bytes); !written)
    log::debug("shader cache: {}", written.error().text());
}

}  // namespace

ShaderCompiler::ShaderCompiler(std::filesystem::path shader_folder, std::filesystem::path cache)
    : shader_folder_(std::move(shader_folder)), cache_(std::move(cache)) {}

Expected<ShaderCompiler::Result> ShaderCompiler::compile(const std::string& name) const {
  const auto [file, definitions] = split_definitions(name);
  const std::optional<EShLanguage> stage = stage_of(file);
  if (!stage) return fail(ErrorKind::input, file, "a shader's name ends in .vert, .frag or .comp");
  const Expected<ShaderFiles> files = load_shader_files(shader_folder_, file);
  if (!files) return std::unexpected(files.error());
  Result result;
  for (const ShaderFile& f : files->files) result.files.push_back(f.name);

  const Hash128 key =
      hash128(fmt::format("{} stage {} {} {}", files->hash().hex(), int(*stage), compiler_identity(), definitions));
  const std::filesystem::path cached = cache_.empty() ? cache_ : cache_ / "spirv" / (key.hex() + ".spv");
  if (auto spirv = cached.empty() ? std::nullopt : read_cached(cached, key)) {
    result.spirv = std::move(*spirv);
    result.from_cache = true;
    return result;
  }
  Expected<std::vector<uint32_t>> spirv = translate(*files, definitions, *stage);
  if (!spirv) return std::unexpected(spirv.error());
  result.spirv = std::move(*spirv);
  if (!cached.empty()) write_cached(cached, key, result.spirv);
  return result;
}

}  // namespace candela::gpu
