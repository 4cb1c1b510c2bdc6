#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace candela {

// Bits of a string of bytes, the least significant of each byte first. Past the end come zeros, and overrun() says so:
// a decoder that makes something of every bit asks once, at its end.
class BitReader {
 public:
  explicit BitReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  uint32_t take(uint32_t count) {  // 0 to 32
    while (held_ < count) {
      const bool more = next_ < bytes_.size();
      overrun_ |= !more;
      bits_ |= (more ? uint64_t(bytes_[next_++]) : 0) << held_;
      held_ += 8;
    }
    const auto value = uint32_t(bits_ & ((uint64_t(1) << count) - 1));
    bits_ >>= count;
    held_ -= count;
    return value;
  }
  bool overrun() const { return overrun_; }

 private:
  std::span<const std::byte> bytes_;
  size_t next_ = 0;
  uint64_t bits_ = 0;
  uint32_t held_ = 0;  // of bits_, unread
  bool overrun_ = false;
};

// Unsigned integers as most container formats store them, the lowest byte first. The caller has checked that they are
// there.
template <class T>
T little_endian(std::span<const std::byte> bytes, size_t at) {
  T value = 0;
  for (size_t i = 0; i < sizeof(T); ++i) value = T(value | T(T(bytes[at + i]) << (8 * i)));
  return value;
}

}  // namespace candela
