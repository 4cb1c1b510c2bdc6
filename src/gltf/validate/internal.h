#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/json.h"
#include "gltf/validate/validate.h"

// What the validate_*.cpp files share. The codes and their meaning are those of the Khronos glTF validator; which of
// its errors are fatal here is decided at each place: fatal where no right picture can be made, a warning where the
// file can be used.
namespace candela::validation {

using Json = nlohmann::json;

enum class Harm : uint8_t { warning, fatal };

// Collects findings. Warnings beyond a bound are dropped, so that a broken exporter does not bury the first ones.
class Findings {
 public:
  void add(Harm harm, std::string_view code, std::string path, std::string message);
  template <class... A>
  void fatal(std::string_view code, std::string path, fmt::format_string<A...> format, A&&... a) {
    add(Harm::fatal, code, std::move(path), fmt::format(format, std::forward<A>(a)...));
  }
  template <class... A>
  void warning(std::string_view code, std::string path, fmt::format_string<A...> format, A&&... a) {
    add(Harm::warning, code, std::move(path), fmt::format(format, std::forward<A>(a)...));
  }
  bool any_fatal() const { return fatal_count_ > 0; }
  std::vector<Finding> take() { return std::move(findings_); }

 private:
  std::vector<Finding> findings_;
  size_t fatal_count_ = 0, warning_count_ = 0;
};

// Readers for documents whose types the schema checks have passed. A missing member gives null, an empty array or the
// default.
const Json& member(const Json& object, std::string_view key);
const Json& elements(const Json& object, std::string_view key);
const Json& extension(const Json& object, std::string_view name);
int64_t integer(const Json& object, std::string_view key, int64_t otherwise);
double number(const Json& object, std::string_view key, double otherwise);
std::string_view text(const Json& object, std::string_view key);
// Whole numbers count as integers however they are written (1e300 too); whole() holds them to +-2^62.
bool is_whole(const Json& value);
int64_t whole(const Json& value);

// An accessor's layout. usable is false for a type or component type that the specification does not list.
struct AccessorLayout {
  bool usable = false, normalized = false, has_bounds = false, compressed = false;
  int component_type = 0, components = 0;  // components: 1 to 4, or 4, 9, 16 for matrices
  bool matrix = false;
  std::string_view type;
  uint64_t count = 0, offset = 0, stride = 0, element_bytes = 0, byte_length = 0;
  int64_t buffer_view = -1;
  bool view_has_stride = false;
  std::string format() const;  // "{VEC3, FLOAT}", as the validator writes it
};

constexpr int component_byte = 5120, component_ubyte = 5121, component_short = 5122, component_ushort = 5123,
              component_uint = 5125, component_float = 5126;
int component_bytes(int component_type);

// What a buffer view was first used for; using it for something else later is BUFFER_VIEW_TARGET_OVERRIDE.
enum class ViewUse : uint8_t { none, index, vertex, other };

struct Document {
  const Json& json;
  const GltfParts& parts;
  Findings& findings;
  std::vector<AccessorLayout> accessors;
  std::vector<ViewUse> view_uses;
  std::vector<int64_t> parents;  // of nodes; -1: a root

  bool uses(std::string_view extension_name) const;  // in extensionsUsed or extensionsRequired
  size_t count(std::string_view root_array) const { return elements(json, root_array).size(); }
  // An index that must lie in root_array. Reports UNRESOLVED_REFERENCE; gives -1 where absent or dangling.
  int64_t reference(const Json& object, std::string_view key, std::string_view root_array, const std::string& path);
  // The layout of a referenced accessor, or null where absent, dangling or of an unlisted type (reported).
  const AccessorLayout* accessor(const Json& object, std::string_view key, const std::string& path);
  void use_view(const AccessorLayout& accessor, ViewUse use, const std::string& path);
};

// The UV sets that a material's textures read, and where it says so.
struct TexcoordUse {
  std::string path;
  int64_t set = 0;
};
void collect_texcoord_uses(const Json& material, const std::string& path, std::vector<TexcoordUse>& uses);

// In this order; each trusts what those before it have passed, and the first that finds something fatal ends the
// checks.
void check_major_version(const Json& root,
                         Findings& findings);  // alone: another major version breaks the schema all over
void check_schema(const Json& root, Findings& findings);
void check_asset(Document& document);
void check_buffers(Document& document);
void check_accessors(Document& document);
void check_textures(Document& document);
void check_materials(Document& document);
void check_meshes(Document& document);
void check_nodes(Document& document);
void check_skins(Document& document);
void check_animations(Document& document);
void check_extensions(Document& document);

// The bytes that a data URI decodes to. valid is false where it is not well-formed base64 (or percent encoding).
struct DataUri {
  bool is_data = false, valid = false;
  std::string_view mime_type;
  uint64_t byte_length = 0;
  std::string_view payload;
  bool base64 = false;
};
DataUri inspect_data_uri(std::string_view uri);
// The first bytes, for recognising image formats.
std::vector<std::byte> data_uri_head(const DataUri& uri, size_t bytes);

}  // namespace candela::validation
