#include "gltf/named_files.h"

#include <algorithm>

#include "base/file_uses.h"
#include "base/files.h"
#include "base/input.h"
#include "gltf/uri.h"

namespace candela::gltf {

namespace {

// Files that a URI may mean: what it says, then what its writer may have meant: no percent-encoding, and \ for /.
std::vector<std::string> meant_by(const std::string& uri) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (!name.empty() && name.find('\0') == std::string::npos && std::ranges::find(names, name) == names.end())
      names.push_back(name);
  };
  const std::optional<std::string> decoded = percent_decoded(uri);
  for (const std::string& name : {decoded.value_or(""), uri}) {
    add(name);
    std::string slashes = name;
    std::ranges::replace(slashes, '\\', '/');
    add(slashes);
  }
  return names;
}

}  // namespace

Expected<std::vector<std::byte>> read_named_file(Document& document, const std::string& uri, const std::string& path) {
  if (is_data_uri(uri)) {
    std::optional<std::vector<std::byte>> bytes = decode_data_uri(uri);
    if (!bytes) document.refuse(path, "the data URI is not valid base64 (INVALID_URI)");
    return std::move(*bytes);  // already counted: its text is part of the file
  }
  if (has_scheme(uri))
    document.refuse(path, "'{}' is not a relative path; only files beside the scene and data URIs are read", uri);
  const std::vector<std::string> names = meant_by(uri);
  if (names.empty()) document.refuse(path, "'{}' is not a valid URI (INVALID_URI)", uri);
  // The first that is there; where none is, the message is of the first.
  const auto is_there = [&](const std::string& name) {
    std::error_code failed;
    return std::filesystem::is_regular_file(document.folder / name, failed);
  };
  const auto there = std::ranges::find_if(names, is_there);
  const std::string& name = there == names.end() ? names.front() : *there;
  if (name != percent_decoded(uri)) document.warn(path, "'{}' is taken for '{}' (INVALID_URI)", uri, name);
  const std::filesystem::path file = document.folder / name;
  if (auto allowed = check_named_file(file, document.folder, document.name); !allowed)
    document.refuse(path, "{} (IO_ERROR)", allowed.error().message);
  Expected<std::vector<std::byte>> bytes = read_file(file);
  if (!bytes) return bytes;
  if (std::find(document.files.begin(), document.files.end(), file.string()) == document.files.end()) {
    document.files.push_back(file.string());
    document.bytes_read += bytes->size();
  } else {
    document.charge(bytes->size(), 1, path);  // read again: a copy that no bytes on disk pay for
  }
  return bytes;
}

std::vector<std::filesystem::path> named_files(const Document& document) {
  std::vector<std::filesystem::path> files;
  std::vector<const Json*> open = {&document.json};
  while (!open.empty()) {
    const Json& json = *open.back();
    open.pop_back();
    if (!json.is_structured()) continue;
    for (const auto& [key, value] : json.items()) {
      open.push_back(&value);
      if (key != "uri" || !value.is_string()) continue;
      const std::string& uri = value.get_ref<const std::string&>();
      if (is_data_uri(uri) || has_scheme(uri)) continue;
      for (const std::string& name : meant_by(uri)) files.push_back(document.folder / name);
    }
  }
  return files;
}

void note_named_files(const Document& document) {
  for (const std::filesystem::path& file : named_files(document)) note_read({document.name, file});
}

std::span<const std::byte> buffer_bytes(Document& document, size_t buffer) {
  std::span<const std::byte>& bytes = document.buffers[buffer];
  if (!bytes.empty()) return bytes;
  const Json& json = document.json["buffers"][buffer];
  const std::string path = fmt::format("/buffers/{}", buffer);
  const double wanted = number(document, json, "byteLength", 0, path);
  std::span<const std::byte> stored = document.binary;
  if (json.contains("uri")) {
    auto read = read_named_file(document, text(document, json, "uri", "", path), path + "/uri");
    if (!read) document.refuse(path + "/uri", "{} (IO_ERROR)", read.error().text());
    document.storage.push_back(std::move(*read));
    stored = document.storage.back();
  } else if (buffer != 0 || !document.has_binary) {
    document.refuse(path, "the buffer has no bytes: neither a uri nor a binary chunk");
  }
  if (!(wanted <= double(stored.size())))
    document.refuse(path + "/byteLength", "byteLength is {:.0f} but there are {} bytes (BUFFER_BYTE_LENGTH_MISMATCH)",
                    wanted, stored.size());
  return bytes = stored.first(size_t(wanted));
}

}  // namespace candela::gltf
