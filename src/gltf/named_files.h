#pragma once
#include "gltf/document.h"

namespace candela::gltf {

// The bytes behind a URI: in it (data:) or in a file below the scene's folder. An error where the file is not there or
// cannot be read; throws Failure for what a scene may not name (base/input.h) and for what is no URI.
Expected<std::vector<std::byte>> read_named_file(Document& document, const std::string& uri, const std::string& path);

// All files that a glTF names, also those of what is not used, and whether they are there or not.
std::vector<std::filesystem::path> named_files(const Document& document);
// Notes them as read (base/file_uses.h): an output that takes the name of one would change what the scene is.
void note_named_files(const Document& document);

// The bytes of a buffer, whose file is read when they are first asked for: what is not used may be absent. Throws
// Failure.
std::span<const std::byte> buffer_bytes(Document& document, size_t buffer);

}  // namespace candela::gltf
