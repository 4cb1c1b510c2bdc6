#pragma once
#include <array>
#include <cstdint>
#include <span>

namespace candela {

// 4x4 texels of 4 channels, rows from the top.
using UastcTexels = std::array<std::array<uint8_t, 4>, 16>;

// UASTC, the finer of Basis Universal's two codecs: a block of 16 bytes is 4x4 texels, in one of 19 modes of ASTC
// (Binomial, "UASTC LDR 4x4 Texture Specification", public domain; Khronos, Data Format Specification 1.3, "ASTC").
// Gives false when the block is none.
bool decode_uastc(std::span<const std::byte, 16> block, UastcTexels& out);

}  // namespace candela
