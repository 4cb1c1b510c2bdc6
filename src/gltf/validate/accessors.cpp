#include <set>

#include "gltf/validate/internal.h"

namespace candela::validation {
namespace {

void set_type(AccessorLayout& a) {
  static constexpr struct {
    std::string_view name;
    int components, rows;
  } types[] = {{"SCALAR", 1, 0}, {"VEC2", 2, 0}, {"VEC3", 3, 0}, {"VEC4", 4, 0},
               {"MAT2", 4, 2},   {"MAT3", 9, 3}, {"MAT4", 16, 4}};
  const uint64_t size = uint64_t(component_bytes(a.component_type));
  for (const auto& type : types) {
    if (type.name != a.type) continue;
    a.components = type.components;
    a.matrix = type.rows > 0;
    // Each column of a matrix begins at a multiple of 4 bytes.
    a.element_bytes =
        a.matrix ? uint64_t(type.rows) * ((uint64_t(type.rows) * size + 3) / 4 * 4) : uint64_t(type.components) * size;
  }
  a.usable = a.components > 0 && size > 0;
}

AccessorLayout read_layout(const Json& accessor) {
  AccessorLayout a;
  a.type = text(accessor, "type");
  a.component_type = int(std::clamp<int64_t>(integer(accessor, "componentType", 0), 0, 65535));
  a.normalized = member(accessor, "normalized") == true;
  a.count = uint64_t(integer(accessor, "count", 0));
  a.offset = uint64_t(integer(accessor, "byteOffset", 0));
  a.buffer_view = integer(accessor, "bufferView", -1);
  set_type(a);
  const auto bounds = [&](const char* key) {
    const Json& values = member(accessor, key);
    return values.is_array() && values.size() == size_t(a.components);
  };
  a.has_bounds = bounds("min") && bounds("max");
  return a;
}

// The bytes from the first to the last; the padding behind a matrix's last column need not be there.
uint64_t span_bytes(const AccessorLayout& a) {
  uint64_t last = a.element_bytes;
  if (a.matrix) {
    const uint64_t rows = a.components == 4 ? 2 : a.components == 9 ? 3 : 4;
    const uint64_t column = a.element_bytes / rows;
    last = column * (rows - 1) + rows * uint64_t(component_bytes(a.component_type));
  }
  return a.stride * (a.count - 1) + last;
}

void check_alignment(Document& d, const AccessorLayout& a, uint64_t view_offset, const std::string& path) {
  const uint64_t size = uint64_t(component_bytes(a.component_type));
  if (a.offset % size)
    d.findings.warning("ACCESSOR_OFFSET_ALIGNMENT", path + "/byteOffset", "offset {} is not a multiple of {}", a.offset,
                       size);
  if ((a.offset + view_offset) % size)
    d.findings.warning("ACCESSOR_TOTAL_OFFSET_ALIGNMENT", path, "the total offset {} is not a multiple of {}",
                       a.offset + view_offset, size);
  if (a.matrix && a.offset % 4)
    d.findings.warning("ACCESSOR_MATRIX_ALIGNMENT", path + "/byteOffset", "matrices must be aligned to 4 bytes");
}

void check_range(Document& d, AccessorLayout& a, const std::string& path) {
  const Json& view = elements(d.json, "bufferViews")[a.buffer_view];
  const uint64_t length = uint64_t(integer(view, "byteLength", 0)), stride = uint64_t(integer(view, "byteStride", 0));
  a.view_has_stride = stride > 0;
  a.stride = stride ? stride : a.element_bytes;
  a.byte_length = span_bytes(a);
  check_alignment(d, a, uint64_t(integer(view, "byteOffset", 0)), path);
  if (stride && stride < a.element_bytes)
    return d.findings.fatal("ACCESSOR_SMALL_BYTESTRIDE", path,
                            "the buffer view's byteStride {} is less than the element's {} bytes", stride,
                            a.element_bytes);
  if (a.offset + a.byte_length > length)
    d.findings.fatal("ACCESSOR_TOO_LONG", a.offset >= length ? path + "/byteOffset" : path,
                     "{} bytes at offset {} do not fit buffer view {} of {} bytes", a.byte_length, a.offset,
                     a.buffer_view, length);
}

void check_sparse_part(Document& d, const Json& part, const std::string& path, uint64_t count, uint64_t element_bytes,
                       uint64_t alignment) {
  const int64_t view_index = d.reference(part, "bufferView", "bufferViews", path);
  if (view_index < 0) return;
  const Json& view = elements(d.json, "bufferViews")[view_index];
  const uint64_t offset = uint64_t(integer(part, "byteOffset", 0)), length = uint64_t(integer(view, "byteLength", 0));
  const uint64_t total = offset + uint64_t(integer(view, "byteOffset", 0));
  if (view.contains("byteStride"))
    d.findings.fatal("BUFFER_VIEW_INVALID_BYTE_STRIDE", path + "/bufferView",
                     "only buffer views with vertex data can have byteStride");
  if (total % alignment)
    d.findings.warning("ACCESSOR_TOTAL_OFFSET_ALIGNMENT", path, "the total offset {} is not a multiple of {}", total,
                       alignment);
  if (offset > 2147483647 || offset + count * element_bytes > length)
    d.findings.fatal("ACCESSOR_TOO_LONG", path + "/byteOffset",
                     "{} bytes at offset {} do not fit buffer view {} of {} bytes", count * element_bytes, offset,
                     view_index, length);
}

void check_sparse(Document& d, const Json& sparse, const AccessorLayout& a, const std::string& path) {
  const uint64_t count = uint64_t(integer(sparse, "count", 0));
  if (count > a.count)
    d.findings.fatal("ACCESSOR_SPARSE_COUNT_OUT_OF_RANGE", path + "/count",
                     "{} elements are replaced, but the accessor has {}", count, a.count);
  const Json& indices = member(sparse, "indices");
  const uint64_t index_bytes = uint64_t(component_bytes(int(integer(indices, "componentType", 5125))));
  check_sparse_part(d, indices, path + "/indices", count, index_bytes, index_bytes);
  check_sparse_part(d, member(sparse, "values"), path + "/values", count, a.element_bytes,
                    uint64_t(component_bytes(a.component_type)));
}

// Accessors that a Draco primitive replaces need no bytes of their own.
std::set<int64_t> compressed_accessors(const Document& d) {
  std::set<int64_t> found;
  for (const Json& mesh : elements(d.json, "meshes"))
    for (const Json& primitive : elements(mesh, "primitives")) {
      if (!extension(primitive, "KHR_draco_mesh_compression").is_object()) continue;
      found.insert(integer(primitive, "indices", -1));
      for (const auto& item : member(primitive, "attributes").items()) found.insert(whole(item.value()));
    }
  return found;
}

void check_accessor(Document& d, size_t i, uint64_t& zero_bytes) {
  const Json& json = elements(d.json, "accessors")[i];
  const std::string path = fmt::format("/accessors/{}", i);
  AccessorLayout& a = d.accessors[i];
  const bool has_view = a.buffer_view >= 0;
  if (has_view && d.reference(json, "bufferView", "bufferViews", path) < 0) a.usable = false;
  if (!has_view && json.contains("byteOffset"))
    d.findings.warning("UNSATISFIED_DEPENDENCY", path + "/byteOffset", "byteOffset without bufferView, ignored");
  if (!a.usable) {
    if (const Json& sparse = member(json, "sparse"); sparse.is_object())
      for (const char* part : {"indices", "values"})
        d.reference(member(sparse, part), "bufferView", "bufferViews", fmt::format("{}/sparse/{}", path, part));
    return;
  }
  if (a.normalized && a.component_type == component_float)
    d.findings.warning("ACCESSOR_NORMALIZED_INVALID", path + "/normalized", "floats cannot be normalized, ignored");
  else if (a.normalized && a.component_type == component_uint)
    d.findings.fatal("ACCESSOR_NORMALIZED_INVALID", path + "/normalized",
                     "only (u)byte and (u)short accessors can be normalized");
  if (a.component_type == component_float) a.normalized = false;
  if (has_view)
    check_range(d, a, path);
  else if (!a.compressed)
    zero_bytes += a.count * a.element_bytes;
  if (const Json& sparse = member(json, "sparse"); sparse.is_object()) check_sparse(d, sparse, a, path + "/sparse");
  for (const char* key : {"min", "max"})
    if (const Json& values = member(json, key); values.is_array() && values.size() != size_t(a.components))
      d.findings.warning("ARRAY_LENGTH_NOT_IN_LIST", path + "/" + key, "{} values for {} components", values.size(),
                         a.components);
}

}  // namespace

void check_accessors(Document& d) {
  const Json& accessors = elements(d.json, "accessors");
  d.view_uses.assign(d.count("bufferViews"), ViewUse::none);
  for (size_t i = 0; i < d.view_uses.size(); ++i) {
    const int64_t target = integer(elements(d.json, "bufferViews")[i], "target", 0);
    if (target == 34962) d.view_uses[i] = ViewUse::vertex;
    if (target == 34963) d.view_uses[i] = ViewUse::index;
  }
  d.accessors.reserve(accessors.size());
  for (const Json& accessor : accessors) d.accessors.push_back(read_layout(accessor));
  for (const int64_t i : compressed_accessors(d))
    if (i >= 0 && size_t(i) < d.accessors.size()) d.accessors[i].compressed = true;
  // Accessors without a buffer view are zeros that take no room in the file. What they take in memory is held to its
  // size.
  uint64_t zero_bytes = 0;
  for (size_t i = 0; i < accessors.size(); ++i) {
    check_accessor(d, i, zero_bytes);
    const uint64_t allowed = (uint64_t(16) << 20) + 64 * (d.parts.json.size() + d.parts.binary.size());
    if (zero_bytes <= allowed) continue;
    return d.findings.fatal("VALUE_NOT_IN_RANGE", fmt::format("/accessors/{}/count", i),
                            "accessors without a bufferView ask for {} bytes of zeros, out of proportion to the file",
                            zero_bytes);
  }
}

}  // namespace candela::validation
