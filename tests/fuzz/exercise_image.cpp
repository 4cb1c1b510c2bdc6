#include "exercise.h"

#include "image/io.h"

namespace candela::fuzz {

bool exercise(std::span<const std::byte> bytes) {
  constexpr int max_side = 1024;
  return decode_image(bytes, "input", max_side).has_value();
}

}  // namespace candela::fuzz
