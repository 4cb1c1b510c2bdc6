#include "glsl/shader_files.h"

#include <optional>

#include "base/files.h"
#include "glsl/shader_sources.h"

namespace candela::glsl {

namespace {

std::optional<std::string> find_text(const std::filesystem::path& folder, const std::string& name) {
  std::error_code error;
  if (!folder.empty() && std::filesystem::is_regular_file(folder / name, error))
    if (const auto bytes = read_file(folder / name))
      return std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  for (const EmbeddedShader& shader : embedded_shaders())
    if (shader.name == name) return std::string(shader.text);
  return std::nullopt;
}

std::string beside(const std::string& includer, const std::string& include) {
  return (std::filesystem::path(includer).parent_path() / include).lexically_normal().generic_string();
}

struct Include {
  std::string name;
  int line;
};

std::string_view trim_left(std::string_view text) {
  const size_t start = text.find_first_not_of(" \t");
  return start == std::string_view::npos ? std::string_view{} : text.substr(start);
}

// Directives of a file: its quoted includes, and whether it says #pragma once.
std::vector<Include> scan(ShaderFile& file) {
  std::vector<Include> includes;
  int line_number = 0;
  std::string_view rest = file.text;
  while (!rest.empty()) {
    ++line_number;
    std::string_view line = trim_left(rest.substr(0, rest.find('\n')));
    rest.remove_prefix(
        std::min(rest.size(), rest.find('\n') == std::string_view::npos ? rest.size() : rest.find('\n') + 1));
    if (!line.starts_with('#')) continue;
    line = trim_left(line.substr(1));
    if (line.starts_with("pragma") && trim_left(line.substr(6)).starts_with("once")) file.once = true;
    if (!line.starts_with("include")) continue;
    line = trim_left(line.substr(7));
    const size_t end = line.starts_with('"') ? line.find('"', 1) : std::string_view::npos;
    if (end != std::string_view::npos) includes.push_back({std::string(line.substr(1, end - 1)), line_number});
  }
  return includes;
}

}  // namespace

const ShaderFile* ShaderFiles::find(const std::string& name) const {
  const auto found =
      std::find_if(files.begin(), files.end(), [&](const ShaderFile& file) { return file.name == name; });
  return found == files.end() ? nullptr : &*found;
}

const ShaderFile* ShaderFiles::resolve(const std::string& include, const std::string& includer) const {
  if (const ShaderFile* file = find(include)) return file;
  return find(beside(includer, include));
}

Hash128 ShaderFiles::hash() const {
  std::string all;
  for (const ShaderFile& file : files) all += fmt::format("{} {}\n{}\n", file.name, file.text.size(), file.text);
  return hash128(all);
}

Expected<ShaderFiles> load_shader_files(const std::filesystem::path& folder, const std::string& root) {
  ShaderFiles result;
  const std::optional<std::string> text = find_text(folder, root);
  if (!text)
    return fail(ErrorKind::input, root, "there is no such shader{}",
                folder.empty() ? std::string(" in the program") : " in " + folder.string() + " or in the program");
  result.files.push_back({root, *text, {}, false});
  for (size_t i = 0; i < result.files.size(); ++i) {
    for (const Include& include : scan(result.files[i])) {
      const std::string includer = result.files[i].name;
      if (result.resolve(include.name, includer)) continue;
      const std::string& above = result.files[i].included_by;
      std::string place = fmt::format("{}:{}", includer, include.line);
      if (!above.empty()) place += ", included by " + above;
      std::string name = include.name;
      std::optional<std::string> found = find_text(folder, name);
      if (!found) found = find_text(folder, name = beside(includer, include.name));
      if (!found) return fail(ErrorKind::input, place, "cannot find \"{}\"", include.name);
      result.files.push_back({std::move(name), std::move(*found), std::move(place), false});
    }
  }
  return result;
}

}  // namespace candela::glsl
