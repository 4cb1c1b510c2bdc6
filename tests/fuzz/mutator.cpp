#include "mutator.h"

#include <array>
#include <cstring>
#include <iterator>
#include <limits>

namespace candela::fuzz {
namespace {

using nlohmann::json;

constexpr std::string_view base64_digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::string_view data_prefix = "data:application/octet-stream;base64,";

Bytes from_base64(std::string_view text) {
  Bytes out;
  uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    const size_t value = base64_digits.find(c);
    if (value == std::string_view::npos) break;
    bits = bits << 6 | uint32_t(value);
    if ((held += 6) >= 8) out += char(bits >> (held -= 8));
  }
  return out;
}

Bytes to_base64(const Bytes& bytes) {
  Bytes out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? base64_digits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

void collect(json& value, std::vector<json*>& nodes) {
  nodes.push_back(&value);
  if (value.is_structured())
    for (json& item : value) collect(item, nodes);
}

bool split(const Bytes& bytes, Bytes& text, Bytes& binary) {
  if (!bytes.starts_with("glTF")) {
    text = bytes;
    return true;
  }
  uint32_t length = 0, binary_length = 0;
  if (bytes.size() < 20) return false;
  std::memcpy(&length, bytes.data() + 12, 4);
  if (length > bytes.size() - 20) return false;
  text = bytes.substr(20, length);
  if (bytes.size() < 28 + size_t(length)) return true;
  std::memcpy(&binary_length, bytes.data() + 20 + length, 4);
  binary = bytes.substr(28 + size_t(length), binary_length);
  return true;
}

}  // namespace

Bytes as_glb(const Bytes& text, const Bytes& binary) {
  const auto pad = [](Bytes bytes, char with) { return bytes + Bytes((4 - bytes.size() % 4) % 4, with); };
  const auto u32 = [](size_t value) {
    const uint32_t word = uint32_t(value);
    return Bytes(reinterpret_cast<const char*>(&word), 4);
  };
  const Bytes padded = pad(text, ' '), data = pad(binary, '\0');
  Bytes chunks = u32(padded.size()) + "JSON" + padded;
  if (!data.empty()) chunks += u32(data.size()) + Bytes("BIN\0", 4) + data;
  return "glTF" + u32(2) + u32(12 + chunks.size()) + chunks;
}

Mutator::Mutator(std::vector<Bytes> seeds, std::vector<Bytes> words, uint32_t seed)
    : seeds_(std::move(seeds)), words_(std::move(words)), random_(seed) {}

Bytes Mutator::next() {
  Bytes bytes = pick(seeds_);
  if (below(4) > 0)
    structured(bytes);
  else
    for (size_t n = 1 + below(4); n > 0; --n) raw(bytes);
  return bytes;
}

void Mutator::raw(Bytes& bytes) {
  const size_t at = below(bytes.size());
  switch (below(8)) {
    case 0:
      for (size_t n = 1 + below(8); n > 0 && !bytes.empty(); --n) bytes[below(bytes.size())] ^= char(1 << below(8));
      return;
    case 1:
      return replace_number(bytes);
    case 2:
      return splice(bytes);
    case 3:
      return length_field(bytes);
    case 4:
      bytes.erase(at, 1 + below(40));
      return;
    case 5:
      bytes.insert(at, bytes.substr(at, 1 + below(200)));
      return;
    case 6:
      for (size_t i = at; i < bytes.size() && i < at + 16; ++i) bytes[i] = char(random_());
      return;
    default:
      return bytes.resize(at);
  }
}

void Mutator::replace_number(Bytes& bytes) {
  static const char* const values[] = {"0",    "-1", "1e999", "2147483648", "18446744073709551615",
                                       "null", "[]", "{}",    "1e0",        "0.5"};
  const size_t digit = bytes.find_first_of("0123456789", below(bytes.size()));
  if (digit == Bytes::npos) return;
  bytes.replace(digit, bytes.find_first_not_of("0123456789.eE+-", digit) - digit, values[below(std::size(values))]);
}

void Mutator::splice(Bytes& bytes) {
  const Bytes& other = pick(seeds_);
  const size_t from = below(other.size());
  bytes.insert(below(bytes.size() + 1), other, from, below(300));
}

// The lengths of the container and of its first chunk.
void Mutator::length_field(Bytes& bytes) {
  static const uint32_t values[] = {0, 1, 4, 8, 12, 20, 0x7FFFFFFF, 0xFFFFFFFC, 0xFFFFFFFF};
  const size_t at = std::array<size_t, 3>{8, 12, 16}[below(3)];
  const uint32_t value = below(2) ? values[below(std::size(values))] : uint32_t(bytes.size() - below(24));
  if (bytes.size() >= at + 4) std::memcpy(bytes.data() + at, &value, 4);
}

bool Mutator::structured(Bytes& bytes) {
  Bytes text, binary;
  if (!split(bytes, text, binary)) return false;
  Json document = Json::parse(text, nullptr, false);
  if (!document.is_object()) return false;
  for (size_t n = 1 + below(3); n > 0; --n) {
    if (below(3) > 0)
      change_document(document);
    else if (!binary.empty())
      change_buffer(binary);
    else if (document.contains("buffers"))
      for (Json& buffer : document["buffers"])
        if (buffer.is_object() && buffer.contains("uri") && buffer["uri"].is_string()) {
          const Bytes uri = buffer["uri"];
          if (!uri.starts_with(data_prefix)) continue;
          Bytes data = from_base64(std::string_view(uri).substr(data_prefix.size()));
          change_buffer(data);
          buffer["uri"] = Bytes(data_prefix) + to_base64(data);
        }
  }
  text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
  bytes = bytes.starts_with("glTF") ? as_glb(text, binary) : text;
  return true;
}

void Mutator::change_document(Json& document) {
  std::vector<Json*> nodes;
  collect(document, nodes);
  Json& value = *pick(nodes);
  if (value.is_structured()) {
    Json other = *pick(nodes);
    change_members(value, other);
  } else {
    change_value(value);
  }
}

// Mostly a value of the right kind: the wrong kinds are found early and lead nowhere.
void Mutator::change_value(Json& value) {
  static const int64_t whole[] = {0,
                                  1,
                                  2,
                                  3,
                                  4,
                                  5,
                                  6,
                                  7,
                                  -1,
                                  255,
                                  256,
                                  65535,
                                  65536,
                                  2147483647,
                                  2147483648,
                                  4294967295,
                                  9007199254740991,
                                  5120,
                                  5121,
                                  5122,
                                  5123,
                                  5125,
                                  5126,
                                  34962,
                                  34963};
  static const double real[] = {0.0, -0.5, 1e-30, 1e30, 3.4e38, 1e300, -1e30, 0.5, 3.141592653589793};
  static const char* const names[] = {"SCALAR",      "VEC2",     "VEC3",       "VEC4",       "MAT2",
                                      "MAT3",        "MAT4",     "LINEAR",     "STEP",       "CUBICSPLINE",
                                      "translation", "rotation", "scale",      "weights",    "ATTRIBUTES",
                                      "TRIANGLES",   "INDICES",  "OCTAHEDRAL", "EXPONENTIAL"};
  if (below(12) == 0) {
    const Json odd[] = {nullptr, true, Json::array(), Json::object(), "x", 1e300, -1};
    value = odd[below(std::size(odd))];
  } else if (value.is_string()) {
    value = below(2) || words_.empty() ? names[below(std::size(names))] : pick(words_);
  } else if (value.is_number_float()) {
    value = real[below(std::size(real))];
  } else if (value.is_number()) {
    value = below(2) ? Json(whole[below(std::size(whole))]) : Json(value.get<int64_t>() + int64_t(below(3)) - 1);
  } else if (value.is_boolean()) {
    value = !value.get<bool>();
  }
}

void Mutator::change_members(Json& value, const Json& other) {
  const auto at = [&] { return std::next(value.begin(), ptrdiff_t(below(value.size()))); };
  switch (value.empty() ? 3 : below(5)) {
    case 0:
      value.erase(at());
      return;
    case 1:
      *at() = other;
      return;
    case 2: {
      Json copy = *at();
      if (value.is_array())
        value.push_back(std::move(copy));
      else if (!words_.empty())
        value[pick(words_)] = std::move(copy);
      return;
    }
    case 3:
      if (value.is_array())
        value.push_back(other);
      else if (!words_.empty())
        value[pick(words_)] = other;
      return;
    default:
      return std::swap(*at(), *at());
  }
}

void Mutator::change_buffer(Bytes& buffer) {
  static const float real[] = {0.f,
                               -1.f,
                               1e-40f,
                               1e30f,
                               3.4e38f,
                               std::numeric_limits<float>::infinity(),
                               std::numeric_limits<float>::quiet_NaN()};
  if (buffer.empty()) return;
  const size_t at = below(buffer.size());
  switch (below(4)) {
    case 0:
      buffer[at] = char(random_());
      return;
    case 1:
      buffer[at] ^= char(1 << below(8));
      return;
    case 2: {
      const float value = real[below(std::size(real))];
      if (buffer.size() >= 4) std::memcpy(buffer.data() + std::min(at / 4 * 4, buffer.size() - 4), &value, 4);
      return;
    }
    default:
      return std::fill_n(buffer.begin() + ptrdiff_t(at), std::min<size_t>(buffer.size() - at, 4),
                         char(below(2) ? 0xFF : 0)),
             void();
  }
}

}  // namespace candela::fuzz
