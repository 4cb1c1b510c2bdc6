#include "gltf/validate/internal.h"

// Asset, buffers, buffer views and accessors: everything that says which bytes belong to what.
namespace candela::validation {
namespace {

// "2.0" -> {2, 0}, also of "2.0.1"; false where the text does not begin with digits, a dot, digits (at most four each).
bool parse_version(std::string_view text, int& major, int& minor) {
  const auto digits = [](std::string_view part, int& value) {
    if (part.empty() || part.size() > 4) return false;
    value = 0;
    for (const char c : part) {
      if (c < '0' || c > '9') return false;
      value = value * 10 + (c - '0');
    }
    return true;
  };
  const size_t dot = text.find('.');
  if (dot == std::string_view::npos) return false;
  const std::string_view rest = text.substr(dot + 1);
  return digits(text.substr(0, dot), major) && digits(rest.substr(0, rest.find('.')), minor) &&
         rest.find_first_not_of("0123456789.") == std::string_view::npos;
}

bool is_meshopt_fallback(const Json& buffer) {
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    if (extension(buffer, name).is_object()) return true;
  return false;
}

void check_buffer(Document& d, size_t i) {
  const Json& buffer = elements(d.json, "buffers")[i];
  const std::string path = fmt::format("/buffers/{}", i);
  const uint64_t length = uint64_t(integer(buffer, "byteLength", 0));
  if (!buffer.contains("uri")) {
    if (is_meshopt_fallback(buffer)) return;
    if (d.parts.is_glb && i == 0 && d.parts.has_binary) {
      if (length > d.parts.binary.size())
        d.findings.fatal("BUFFER_BYTE_LENGTH_MISMATCH", path + "/byteLength",
                         "the binary chunk has {} bytes, fewer than the declared {}", d.parts.binary.size(), length);
      else if (d.parts.binary.size() > length + 3)
        d.findings.warning("BUFFER_GLB_CHUNK_TOO_BIG", path, "the binary chunk is {} bytes longer than the buffer",
                           d.parts.binary.size() - length);
    } else {
      d.findings.warning("BUFFER_MISSING_GLB_DATA", path, "the buffer has neither a uri nor a binary chunk");
    }
    return;
  }
  const std::string_view uri = text(buffer, "uri");
  const DataUri data = inspect_data_uri(uri);
  if (uri.empty()) d.findings.fatal("INVALID_URI", path + "/uri", "the uri is empty");
  if (!data.is_data) return;
  if (!data.valid) return d.findings.fatal("INVALID_URI", path + "/uri", "the data URI is not well-formed base64");
  if (data.mime_type != "application/octet-stream" && data.mime_type != "application/gltf-buffer")
    d.findings.warning("BUFFER_DATA_URI_MIME_TYPE_INVALID", path + "/uri",
                       "the media type should be application/octet-stream or application/gltf-buffer");
  if (data.byte_length < length)
    d.findings.fatal("BUFFER_BYTE_LENGTH_MISMATCH", path + "/byteLength",
                     "the data URI has {} bytes, fewer than the declared {}", data.byte_length, length);
}

// offset and length of a view or of compressed data in a buffer; both may be near 2^53, their sum fits 64 bits.
bool check_view_range(Document& d, const Json& view, const std::string& path, int64_t buffer_index) {
  const uint64_t offset = uint64_t(integer(view, "byteOffset", 0)), length = uint64_t(integer(view, "byteLength", 0));
  const uint64_t size = uint64_t(integer(elements(d.json, "buffers")[buffer_index], "byteLength", 0));
  if (offset + length <= size) return true;
  d.findings.fatal("BUFFER_VIEW_TOO_LONG", path + (offset >= size ? "/byteOffset" : "/byteLength"),
                   "{} bytes at offset {} do not fit buffer {} of {} bytes", length, offset, buffer_index, size);
  return false;
}

void check_meshopt_view(Document& d, const Json& view, const std::string& view_path, const char* name) {
  const Json& packed = extension(view, name);
  if (!packed.is_object()) return;
  const std::string path = fmt::format("{}/extensions/{}", view_path, name);
  const int64_t buffer = d.reference(packed, "buffer", "buffers", path);
  if (buffer < 0 || !check_view_range(d, packed, path, buffer)) return;
  const uint64_t count = uint64_t(integer(packed, "count", 0)), stride = uint64_t(integer(packed, "byteStride", 0));
  const uint64_t packed_bytes = uint64_t(integer(packed, "byteLength", 0));
  const std::string_view mode = text(packed, "mode");
  if (count * stride != uint64_t(integer(view, "byteLength", 0)))
    d.findings.fatal("BUFFER_VIEW_TOO_LONG", path + "/count",
                     "{} elements of {} bytes do not make the buffer view's {} bytes", count, stride,
                     integer(view, "byteLength", 0));
  else if (mode == "ATTRIBUTES" ? stride % 4 != 0 : stride != 2 && stride != 4)
    d.findings.fatal("VALUE_NOT_IN_LIST", path + "/byteStride", "a stride of {} bytes does not go with mode {}", stride,
                     mode);
  else if (mode == "TRIANGLES" && count % 3 != 0)
    d.findings.fatal("VALUE_MULTIPLE_OF", path + "/count", "mode TRIANGLES needs a multiple of 3 indices, got {}",
                     count);
  // The densest coding: 2 bits for 16 bytes of an attribute, about one byte for a triangle; in KHR_ a byte for 4 bytes
  // of each of 256 elements.
  else if (count * stride > (name == std::string_view("KHR_meshopt_compression") ? 1024 : 64) * packed_bytes + 4096)
    d.findings.fatal("BUFFER_VIEW_TOO_LONG", path + "/byteLength", "{} bytes cannot hold {} compressed ones",
                     packed_bytes, count * stride);
}

void check_buffer_view(Document& d, size_t i) {
  const Json& view = elements(d.json, "bufferViews")[i];
  const std::string path = fmt::format("/bufferViews/{}", i);
  const int64_t buffer = d.reference(view, "buffer", "buffers", path);
  check_meshopt_view(d, view, path, "EXT_meshopt_compression");
  check_meshopt_view(d, view, path, "KHR_meshopt_compression");
  if (buffer < 0 || !check_view_range(d, view, path, buffer)) return;
  const int64_t stride = integer(view, "byteStride", 0), length = integer(view, "byteLength", 0);
  if (stride > length)
    d.findings.warning("BUFFER_VIEW_TOO_BIG_BYTE_STRIDE", path + "/byteStride",
                       "byteStride {} is greater than byteLength {}", stride, length);
  if (stride && integer(view, "target", 0) == 34963)
    d.findings.warning("BUFFER_VIEW_INVALID_BYTE_STRIDE", path + "/byteStride",
                       "only buffer views with vertex data can have byteStride");
}

}  // namespace

void check_major_version(const Json& root, Findings& findings) {
  int major = 0, minor = 0;
  if (parse_version(text(member(root, "asset"), "version"), major, minor) && major != 2)
    findings.fatal("UNKNOWN_ASSET_MAJOR_VERSION", "/asset/version",
                   "unknown glTF major version {}: this program reads glTF 2.0", major);
}

void check_asset(Document& d) {
  const Json& asset = member(d.json, "asset");
  int major = 0, minor = 0, least_major = 0, least_minor = 0;
  if (!parse_version(text(asset, "version"), major, minor))
    return d.findings.fatal("PATTERN_MISMATCH", "/asset/version", "value '{}' is not MAJOR.MINOR",
                            text(asset, "version").substr(0, 40));
  if (const std::string_view version = text(asset, "version"); std::ranges::count(version, '.') > 1)
    d.findings.warning("PATTERN_MISMATCH", "/asset/version", "value '{}' is not MAJOR.MINOR; it is read as {}.{}",
                       version.substr(0, 40), major, minor);
  if (minor > 0)
    d.findings.warning("UNKNOWN_ASSET_MINOR_VERSION", "/asset/version", "unknown glTF minor version {}", minor);
  if (!asset.contains("minVersion")) return;
  if (!parse_version(text(asset, "minVersion"), least_major, least_minor))
    return d.findings.fatal("PATTERN_MISMATCH", "/asset/minVersion", "value '{}' is not MAJOR.MINOR",
                            text(asset, "minVersion").substr(0, 40));
  if (least_major > major || (least_major == major && least_minor > minor))
    d.findings.fatal("ASSET_MIN_VERSION_GREATER_THAN_VERSION", "/asset/minVersion",
                     "minVersion {} is greater than version {}", text(asset, "minVersion"), text(asset, "version"));
}

void check_buffers(Document& d) {
  for (size_t i = 0; i < d.count("buffers"); ++i) check_buffer(d, i);
  for (size_t i = 0; i < d.count("bufferViews"); ++i) check_buffer_view(d, i);
}

}  // namespace candela::validation
