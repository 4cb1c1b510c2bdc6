// make_spirv LIST OUT: compiles the shaders that LIST names, as candela does, into the table that is built into it
// (glsl/built_in_spirv.h). What OUT holds already under the same key is not compiled again.
#include <tbb/parallel_for.h>

#include <cstdio>

#include "base/files.h"
#include "glsl/built_in_spirv.h"
#include "glsl/shader_compiler.h"

using namespace candela;

namespace {

Expected<void> make_table(const std::filesystem::path& list, const std::filesystem::path& out) {
  const auto text = read_file(list);
  if (!text) return std::unexpected(text.error());
  const std::vector<std::string> names =
      glsl::listed_shaders({reinterpret_cast<const char*>(text->data()), text->size()});
  std::vector<std::byte> before;
  if (std::filesystem::exists(out))
    if (auto bytes = read_file(out)) before = std::move(*bytes);
  const glsl::ShaderCompiler compiler({}, {}, before);
  std::vector<Expected<glsl::ShaderCompiler::Result>> results(names.size());
  tbb::parallel_for(size_t(0), names.size(), [&](size_t i) { results[i] = compiler.compile(names[i]); });
  std::vector<std::pair<Hash128, std::vector<uint32_t>>> shaders;
  for (size_t i = 0; i < names.size(); ++i) {
    if (!results[i])
      return fail(results[i].error().kind, list.string() + ", " + names[i], "{}", results[i].error().text());
    shaders.emplace_back(results[i]->key, std::move(results[i]->spirv));
  }
  return write_file_atomically(out, glsl::spirv_table(shaders));
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) {
    std::fprintf(stderr, "make_spirv LIST OUT\n");
    return 2;
  }
  const auto made = make_table(arguments[1], arguments[2]);
  if (!made) std::fprintf(stderr, "%s\n", made.error().text().c_str());
  return made ? 0 : 1;
}
