#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// URIs as glTF uses them (RFC 3986 references, RFC 2397 data URIs).
namespace candela::gltf {
bool is_data_uri(std::string_view uri);
// "https://...", "file:...": a scheme of two letters or more before the first slash.
bool has_scheme(std::string_view uri);
// %20 becomes a space; nothing when a percent sign is not followed by two hexadecimal digits.
std::optional<std::string> percent_decoded(std::string_view uri);
// The bytes of data:[type];base64,... or of a percent-encoded data URI; nothing when malformed.
std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri);
std::string_view data_uri_type(std::string_view uri);  // "image/png"
}  // namespace candela::gltf
