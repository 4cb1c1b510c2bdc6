#include "gltf/meshopt.h"

#include <meshoptimizer.h>

#include "gltf/meshopt_vertices.h"
#include "gltf/named_files.h"

namespace candela::gltf {
namespace {

size_t whole(const Document& document, const Json& object, const char* key, const std::string& path) {
  const double value = number(document, object, key, 0, path);
  if (!(value >= 0 && value < 9e15 && value == std::floor(value)))
    document.refuse(path + "/" + key, "a whole number is wanted (TYPE_MISMATCH)");
  return size_t(value);
}

// The strides that the extension allows for each filter; the filters CHECK them otherwise.
void apply_filter(const Document& document, const std::string& filter, const std::string& name,
                  std::vector<std::byte>& out, size_t count, size_t stride, const std::string& path) {
  if (filter == "NONE") return;
  const bool fits = filter == "OCTAHEDRAL" || filter == "COLOR" ? stride == 4 || stride == 8
                    : filter == "QUATERNION"                    ? stride == 8
                                                                : stride % 4 == 0;
  if (!fits) document.refuse(path + "/byteStride", "stride {} does not fit filter {}", stride, filter);
  if (filter == "OCTAHEDRAL")
    meshopt_decodeFilterOct(out.data(), count, stride);
  else if (filter == "QUATERNION")
    meshopt_decodeFilterQuat(out.data(), count, stride);
  else if (filter == "EXPONENTIAL")
    meshopt_decodeFilterExp(out.data(), count, stride);
  else if (filter == "COLOR" && name == khr_meshopt)
    decode_filter_color(out, stride);
  else
    document.refuse(path + "/filter", "'{}' is no filter of {} (VALUE_NOT_IN_LIST)", filter, name);
}

}  // namespace

std::vector<std::byte> decompress_view(Document& document, const Json& meshopt, const std::string& name,
                                       const std::string& view_path) {
  const std::string path = fmt::format("{}/extensions/{}", view_path, name);
  const int buffer_index = index_of(document, meshopt, "buffer", document.buffers.size(), path);
  if (buffer_index < 0) document.refuse(path, "the compressed view names no buffer (UNDEFINED_PROPERTY)");
  const std::span<const std::byte> buffer = buffer_bytes(document, size_t(buffer_index));
  const size_t offset = whole(document, meshopt, "byteOffset", path),
               length = whole(document, meshopt, "byteLength", path),
               stride = whole(document, meshopt, "byteStride", path), count = whole(document, meshopt, "count", path);
  if (offset > buffer.size() || length > buffer.size() - offset)
    document.refuse(path, "the compressed bytes lie outside buffer {} of {} bytes (BUFFER_VIEW_TOO_LONG)", buffer_index,
                    buffer.size());
  const std::string mode = text(document, meshopt, "mode", "", path),
                    filter = text(document, meshopt, "filter", "NONE", path);
  const bool attributes = mode == "ATTRIBUTES", triangles = mode == "TRIANGLES";
  if (!attributes && !triangles && mode != "INDICES")
    document.refuse(path + "/mode", "'{}' is no mode of {} (VALUE_NOT_IN_LIST)", mode, name);
  if (attributes ? stride == 0 || stride > 256 || stride % 4 != 0 : stride != 2 && stride != 4)
    document.refuse(path + "/byteStride", "stride {} does not fit mode {} (VALUE_NOT_IN_RANGE)", stride, mode);
  if (triangles && count % 3 != 0) document.refuse(path + "/count", "{} is not a multiple of 3", count);
  if (!attributes && filter != "NONE") document.refuse(path + "/filter", "filters are for mode ATTRIBUTES alone");

  document.charge(count, stride, path + "/count");
  std::vector<std::byte> out(count * stride);
  const unsigned char* in = reinterpret_cast<const unsigned char*>(buffer.data() + offset);
  int result = 0;
  if (attributes && name == khr_meshopt && is_vertices_v1(buffer.subspan(offset, length)))
    result = decode_vertices_v1(buffer.subspan(offset, length), stride, out) ? 0 : 1;
  else if (attributes)
    result = meshopt_decodeVertexBuffer(out.data(), count, stride, in, length);
  else if (triangles)
    result = meshopt_decodeIndexBuffer(out.data(), count, stride, in, length);
  else
    result = meshopt_decodeIndexSequence(out.data(), count, stride, in, length);
  if (result != 0) document.refuse(path, "the compressed data is damaged");
  apply_filter(document, filter, name, out, count, stride, path);
  return out;
}

}  // namespace candela::gltf
