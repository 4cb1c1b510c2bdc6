#include "glsl/shader_compiler.h"

#include <cstring>
#include <optional>

#include "base/files.h"
#include "base/hash.h"
#include "base/log.h"
#include "glsl/built_in_spirv.h"
#include "glsl/compiler_identity.h"
#include "glsl/glslang.h"
#include "glsl/shader_files.h"

namespace candela::glsl {

namespace {

constexpr uint32_t spirv_magic = 0x07230203;

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
  if (const auto written = replace_file_atomically(path, bytes); !written)
    log::debug("shader cache: {}", written.error().text());
}

}  // namespace

ShaderCompiler::ShaderCompiler(std::filesystem::path shader_folder, std::filesystem::path cache,
                               std::span<const std::byte> built_in)
    : shader_folder_(std::move(shader_folder)), cache_(std::move(cache)), built_in_(built_in) {}

Expected<ShaderCompiler::Result> ShaderCompiler::compile(const std::string& name) const {
  const auto [file, definitions] = split_definitions(name);
  const std::string stage = std::filesystem::path(file).extension().string();
  if (!is_shader_stage(stage))
    return fail(ErrorKind::input, file, "a shader's name ends in .vert, .frag, .comp, .rgen, .rahit, .rchit or .rmiss");
  const Expected<ShaderFiles> files = load_shader_files(shader_folder_, file);
  if (!files) return std::unexpected(files.error());
  Result result;
  for (const ShaderFile& f : files->files) result.files.push_back(f.name);

  result.key = hash128(fmt::format("{} stage {} {} {}", files->hash().hex(), stage, compiler_identity, definitions));
  if (auto spirv = find_spirv(built_in_, result.key)) {
    result.spirv = std::move(*spirv);
    result.built_in = true;
    return result;
  }
  const std::filesystem::path cached = cache_.empty() ? cache_ : cache_ / "spirv" / (result.key.hex() + ".spv");
  if (auto spirv = cached.empty() ? std::nullopt : read_cached(cached, result.key)) {
    result.spirv = std::move(*spirv);
    result.from_cache = true;
    return result;
  }
  Expected<std::vector<uint32_t>> spirv = compile_by_glslang(*files, definitions, stage);
  if (!spirv) return std::unexpected(spirv.error());
  result.spirv = std::move(*spirv);
  if (!cached.empty()) write_cached(cached, result.key, result.spirv);
  return result;
}

}  // namespace candela::glsl
