#include "gltf/validate/internal.h"

namespace candela::validation {
namespace {

int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  return -1;
}

}  // namespace

DataUri inspect_data_uri(std::string_view uri) {
  DataUri result;
  if (!uri.starts_with("data:")) return result;
  result.is_data = true;
  const size_t comma = uri.find(',');
  if (comma == std::string_view::npos) return result;
  std::string_view header = uri.substr(5, comma - 5);
  result.payload = uri.substr(comma + 1);
  result.base64 = header.ends_with(";base64");
  result.mime_type = header.substr(0, header.find(';'));
  if (!result.base64) {
    result.byte_length = result.payload.size();
    return result;
  }
  while (result.payload.ends_with('=')) result.payload.remove_suffix(1);
  result.valid = result.payload.size() % 4 != 1;
  for (const char c : result.payload)
    if (base64_value(c) < 0) result.valid = false;
  result.byte_length = result.payload.size() * 3 / 4;
  return result;
}

std::vector<std::byte> data_uri_head(const DataUri& uri, size_t bytes) {
  std::vector<std::byte> head;
  if (!uri.valid) return head;
  uint32_t bits = 0;
  int held = 0;
  for (const char c : uri.payload) {
    bits = bits << 6 | uint32_t(base64_value(c));
    held += 6;
    if (held < 8) continue;
    held -= 8;
    head.push_back(std::byte(bits >> held & 255u));
    if (head.size() == bytes) break;
  }
  return head;
}

}  // namespace candela::validation
