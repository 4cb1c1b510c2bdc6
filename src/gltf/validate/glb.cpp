#include <cstring>
#include <optional>

#include "gltf/validate/validate.h"

namespace candela {
namespace {

constexpr uint32_t magic_gltf = 0x46546C67, chunk_json = 0x4E4F534A, chunk_bin = 0x004E4942;

// The container's checks stop at the first fatal finding: nothing behind it can be trusted.
class GlbReader {
 public:
  GlbReader(std::span<const std::byte> file, std::vector<Finding>& findings) : file_(file), findings_(findings) {}

  bool read(GltfParts& parts) {
    if (!header()) return false;
    size_t at = 12;
    for (size_t index = 0; at < length_; ++index)
      if (!chunk(at, index, parts)) return false;
    if (file_.size() < length_)
      return stop(file_.size(), "GLB_LENGTH_MISMATCH",
                  fmt::format("the header declares {} bytes, the file has {}", length_, file_.size()));
    if (file_.size() > length_) note(length_, "GLB_EXTRA_DATA", "extra data after the end of the GLB, ignored");
    return true;
  }

 private:
  uint32_t u32(size_t at) const {
    uint32_t value;
    std::memcpy(&value, file_.data() + at, 4);
    return value;
  }

  bool stop(size_t at, std::string_view code, std::string message) {
    findings_.push_back({true, std::string(code), fmt::format("byte {}", at), std::move(message)});
    return false;
  }

  void note(size_t at, std::string_view code, std::string message) {
    constexpr size_t most_notes = 100;
    if (findings_.size() < most_notes)
      findings_.push_back({false, std::string(code), fmt::format("byte {}", at), std::move(message)});
  }

  bool header() {
    if (file_.size() < 4)
      return stop(file_.size(), "GLB_UNEXPECTED_END_OF_HEADER", "the file ends within the GLB header");
    if (u32(0) != magic_gltf)
      return stop(0, "GLB_INVALID_MAGIC", fmt::format("invalid GLB magic value {:#010x}", u32(0)));
    if (file_.size() < 12)
      return stop(file_.size(), "GLB_UNEXPECTED_END_OF_HEADER", "the file ends within the GLB header");
    if (u32(4) != 2) return stop(4, "GLB_INVALID_VERSION", fmt::format("GLB version {} is not 2", u32(4)));
    length_ = u32(8);
    if (length_ <= 12) return stop(8, "GLB_LENGTH_TOO_SMALL", fmt::format("declared length {} is too small", length_));
    return true;
  }

  // Where the file or the declared length ends too early, the nearer end is the one to name.
  bool chunk(size_t& at, size_t index, GltfParts& parts) {
    if (file_.size() - at < 8) {
      if (file_.size() == at)
        return stop(at, "GLB_LENGTH_MISMATCH",
                    fmt::format("the header declares {} bytes, the file has {}", length_, at));
      return stop(file_.size(), "GLB_UNEXPECTED_END_OF_CHUNK_HEADER", "the file ends within a chunk header");
    }
    const uint64_t size = u32(at);
    const uint32_t type = u32(at + 4);
    if (size % 4)
      note(at, "GLB_CHUNK_LENGTH_UNALIGNED",
           fmt::format("length {} of chunk {:#010x} is not a multiple of 4; it is read as it stands", size, type));
    if (at + 8 + size > length_)
      return stop(at, "GLB_CHUNK_TOO_BIG",
                  fmt::format("chunk {:#010x} of {} bytes does not fit the GLB's length {}", type, size, length_));
    if (!chunk_order(at, index, type, size)) return false;
    if (at + 8 + size > file_.size())
      return stop(file_.size(), "GLB_UNEXPECTED_END_OF_CHUNK_DATA", "the file ends within a chunk");
    const auto data = file_.subspan(at + 8, size);
    if (index == 0) parts.json = data;
    if (index == 1 && type == chunk_bin) {
      parts.binary = data;
      parts.has_binary = true;
    }
    at += 8 + size;
    return true;
  }

  bool chunk_order(size_t at, size_t index, uint32_t type, uint64_t size) {
    if (index == 0 && type != chunk_json)
      return stop(at, "GLB_UNEXPECTED_FIRST_CHUNK", fmt::format("the first chunk must be JSON, found {:#010x}", type));
    if (type == chunk_json) {
      if (size == 0) return stop(at, "GLB_EMPTY_CHUNK", "the JSON chunk is empty");
      if (index > 0) return stop(at, "GLB_DUPLICATE_CHUNK", "there is a second JSON chunk");
    } else if (type == chunk_bin) {
      if (seen_bin_) return stop(at, "GLB_DUPLICATE_CHUNK", "there is a second BIN chunk");
      if (index > 1) return stop(at, "GLB_UNEXPECTED_BIN_CHUNK", "the BIN chunk must be the second chunk");
      seen_bin_ = true;
    } else {
      note(at, "GLB_UNKNOWN_CHUNK_TYPE", fmt::format("unknown chunk type {:#010x}, ignored", type));
    }
    return true;
  }

  std::span<const std::byte> file_;
  std::vector<Finding>& findings_;
  uint64_t length_ = 0;
  bool seen_bin_ = false;
};

// A .glb by its magic or, where the magic is broken, by the file's name.
bool is_glb(std::span<const std::byte> file, const std::string& name) {
  if (file.size() >= 4 && std::memcmp(file.data(), "glTF", 4) == 0) return true;
  const size_t dot = name.rfind('.');
  if (dot == std::string::npos) return false;
  std::string ending = name.substr(dot);
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return ending == ".glb";
}

}  // namespace

Expected<GltfParts> split_gltf(std::span<const std::byte> file, const std::string& name,
                               std::vector<Finding>& findings) {
  GltfParts parts;
  if (!is_glb(file, name)) {
    parts.json = file;
    return parts;
  }
  parts.is_glb = true;
  if (GlbReader(file, findings).read(parts)) return parts;
  const Finding& last = findings.back();
  return fail(ErrorKind::input, name + ": " + last.path, "{} ({})", last.message, last.code);
}

}  // namespace candela
