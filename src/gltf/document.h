#pragma once
// Internal to src/scene/gltf*.cpp: a glTF file taken apart, before its parts become a Scene.
#include <tiny_gltf.h>

#include <array>
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"

namespace candela::gltf {

using Json = nlohmann::json;

// Thrown inside the loader only; load_gltf turns it into an Expected.
struct Failure {
  Error error;
};

struct Document {
  std::string name;              // of the file, the first half of every place
  std::filesystem::path folder;  // relative URIs resolve against it
  Json json;
  std::span<const std::byte> binary;  // of a .glb; lies in the caller's bytes
  bool has_binary = false;
  // Core glTF without nodes (core_nodes), and without buffers, images, materials, animations and extensions, which are
  // read from `json`.
  tinygltf::Model model;
  int missing_view = -1;                            // model's stand-in for an absent accessor.bufferView
  std::vector<std::span<const std::byte>> buffers;  // empty until buffer_bytes() is asked for them (named_files.h)
  std::vector<std::vector<std::byte>> storage;      // what read buffers lie in
  std::vector<std::optional<std::vector<std::byte>>> decompressed;  // per buffer view (meshopt.h)
  std::map<int, std::vector<std::byte>> sparse;                     // accessors with their sparse values put in
  // Which two sets of texture coordinates a material's slots 0 and 1 are, where they are not TEXCOORD_0 and TEXCOORD_1.
  std::map<int, std::array<int, 2>> uv_sets;
  std::vector<std::string> files, warnings;
  std::set<std::string> finding_codes;  // what the validation warned of
  size_t bytes_read = 0;
  size_t bytes_expanded = 0;  // what the scene has been given, to keep memory in proportion to the file

  std::string place(const std::string& path) const { return name + ": " + path; }
  template <class... A>
  [[noreturn]] void refuse(const std::string& path, fmt::format_string<A...> format, A&&... args) const {
    throw Failure{Error{ErrorKind::input, fmt::format(format, std::forward<A>(args)...), place(path)}};
  }
  template <class... A>
  void warn(const std::string& path, fmt::format_string<A...> format, A&&... args) {
    warnings.push_back(place(path) + ": " + fmt::format(format, std::forward<A>(args)...));
  }
  // Says that `count` elements of `size` bytes are about to be made; refuses what no honest file of this size needs.
  void charge(size_t count, size_t size, const std::string& path);
};

// Splits, parses and validates; then tinygltf. `bytes` must outlive the document. Throws Failure.
// animated: as LoadOptions has it.
Document open_document(std::span<const std::byte> bytes, const std::string& name, const std::filesystem::path& folder,
                       bool animated = true);
// Nodes from `first` on as core glTF has them, `count` at most: all at once would take many times the file.
std::vector<tinygltf::Node> core_nodes(const Document& document, size_t first, size_t count);
// A buffer view's bytes; decompressed where it says so (meshopt.h).
std::span<const std::byte> view_bytes(Document& document, int view, const std::string& path);

// Null when the object has no such extension.
const Json* extension(const Json& object, const char* name);
const Json* member(const Json& object, const char* name);
// "/materials/3 'paint'"
std::string named(const std::string& path, const Json& object);

// Members of extension objects: absent gives the default, a wrong type or range is refused.
double number(const Document& document, const Json& object, const char* key, double otherwise, const std::string& path);
int index_of(const Document& document, const Json& object, const char* key, size_t limit,
             const std::string& path);  // absent: -1
bool boolean(const Document& document, const Json& object, const char* key, bool otherwise, const std::string& path);
std::string text(const Document& document, const Json& object, const char* key, const std::string& otherwise,
                 const std::string& path);
std::vector<double> numbers(const Document& document, const Json& object, const char* key, size_t count,
                            const std::string& path);

template <class V>
V vector_of(const Document& document, const Json& object, const char* key, V otherwise, const std::string& path) {
  const std::vector<double> values = numbers(document, object, key, size_t(V::length()), path);
  for (size_t i = 0; i < values.size(); ++i) otherwise[int(i)] = typename V::value_type(values[i]);
  return otherwise;
}

}  // namespace candela::gltf
