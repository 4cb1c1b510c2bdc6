#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/hash.h"

// A shader's source with everything it includes, before the preprocessor has run.
namespace candela::glsl {

struct ShaderFile {
  std::string name;  // below the shader folder
  std::string text;
  std::string included_by;  // "a.comp:3, included by ...": empty for the root
  bool once = false;        // has #pragma once
};

struct ShaderFiles {
  std::vector<ShaderFile> files;  // the root first, then in order of first mention
  const ShaderFile* find(const std::string& name) const;
  // The name of the file that `include` means inside `includer`: below the shader root, else beside the includer.
  const ShaderFile* resolve(const std::string& include, const std::string& includer) const;
  Hash128 hash() const;
};

// Reads `root` and, transitively, each #include "..." in it, also those that a condition would leave out. A file comes
// from `folder` where it has one, else from the embedded table. <...> includes are for C++ and are not followed.
Expected<ShaderFiles> load_shader_files(const std::filesystem::path& folder, const std::string& root);

}  // namespace candela::glsl
