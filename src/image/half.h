#pragma once
#include <bit>
#include <cmath>
#include <cstdint>

namespace candela {

// The value of a 16-bit float (IEEE 754 binary16), exactly; infinities and NaN stay what they are.
inline float half_to_float(uint16_t h) {
  const uint32_t sign = uint32_t(h >> 15) << 31, exponent = (h >> 10) & 31, mantissa = h & 1023;
  if (exponent == 0) return (sign ? -1.0f : 1.0f) * std::ldexp(float(mantissa), -24);
  const uint32_t bits =
      exponent == 31 ? sign | 0x7f800000u | mantissa << 13 : sign | (exponent + 112) << 23 | mantissa << 13;
  return std::bit_cast<float>(bits);
}

// The nearest 16-bit float, ties to even; beyond its range infinity.
inline uint16_t float_to_half(float value) {
  const uint32_t bits = std::bit_cast<uint32_t>(value), sign = (bits >> 16) & 0x8000u, size = bits & 0x7fffffffu;
  if (size >= 0x47800000u) return uint16_t(sign | (size > 0x7f800000u ? 0x7e00u : 0x7c00u));
  if (size < 0x38800000u)  // below the normal ones: the sum's last bit is 2^-24
    return uint16_t(sign | (std::bit_cast<uint32_t>(std::bit_cast<float>(size) + 0.5f) - 0x3f000000u));
  return uint16_t(sign | ((size - 0x38000000u + 0x0fffu + ((size >> 13) & 1)) >> 13));
}

}  // namespace candela
