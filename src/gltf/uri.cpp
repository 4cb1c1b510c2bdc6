#include "gltf/uri.h"

#include <array>

namespace candela::gltf {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

constexpr std::array<int8_t, 256> base64_values = [] {
  std::array<int8_t, 256> table{};
  table.fill(-1);
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (size_t i = 0; i < digits.size(); ++i) table[size_t(digits[i])] = int8_t(i);
  return table;
}();

std::optional<std::vector<std::byte>> decode_base64(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::vector<std::byte> bytes;
  bytes.reserve(text.size() * 3 / 4);
  uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int value = base64_values[static_cast<unsigned char>(c)];
    if (value < 0) return std::nullopt;
    bits = bits << 6 | uint32_t(value);
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes.push_back(std::byte(bits >> count & 0xff));
    }
  }
  return bytes;
}

}  // namespace

bool is_data_uri(std::string_view uri) { return uri.starts_with("data:"); }

bool has_scheme(std::string_view uri) {
  const size_t colon = uri.find(':'), slash = uri.find('/');
  if (colon == std::string_view::npos || colon < 2 || slash < colon) return false;
  for (const char c : uri.substr(0, colon))
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '+' && c != '-' && c != '.') return false;
  return std::isalpha(static_cast<unsigned char>(uri[0])) != 0;
}

std::optional<std::string> percent_decoded(std::string_view uri) {
  std::string out;
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%') {
      out.push_back(uri[i]);
      continue;
    }
    const int high = i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1,
              low = i + 2 < uri.size() ? hex_digit(uri[i + 2]) : -1;
    if (high < 0 || low < 0) return std::nullopt;
    out.push_back(char(high * 16 + low));
    i += 2;
  }
  return out;
}

std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri) {
  const size_t comma = uri.find(',');
  if (comma == std::string_view::npos) return std::nullopt;
  const std::string_view head = uri.substr(0, comma), body = uri.substr(comma + 1);
  if (head.ends_with(";base64")) {
    if (body.find('%') == std::string_view::npos) return decode_base64(body);
    const std::optional<std::string> plain = percent_decoded(body);
    return plain ? decode_base64(*plain) : std::nullopt;
  }
  const std::optional<std::string> plain = percent_decoded(body);
  if (!plain) return std::nullopt;
  const std::byte* first = reinterpret_cast<const std::byte*>(plain->data());
  return std::vector<std::byte>(first, first + plain->size());
}

std::string_view data_uri_type(std::string_view uri) {
  const size_t end = uri.find_first_of(";,");
  return end == std::string_view::npos || end < 5 ? std::string_view() : uri.substr(5, end - 5);
}

}  // namespace candela::gltf
