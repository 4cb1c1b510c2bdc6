#include "exercise.h"

#include "../png_checksums.h"
#include "image/io.h"

namespace candela::fuzz {

bool exercise(std::span<const std::byte> bytes) {
  constexpr int max_side = 1024;
  std::vector<std::byte> file(bytes.begin(), bytes.end());
  test::renew_png_checksums(file);
  return decode_image(file, "input", max_side).has_value();
}

}  // namespace candela::fuzz
