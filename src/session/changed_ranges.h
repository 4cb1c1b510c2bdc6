#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace candela {

struct ByteRange {
  size_t first = 0, count = 0;
  bool operator==(const ByteRange&) const = default;
};

// Where `bytes` is not what `held` holds at the same places, in order and apart from each other: whole pieces of 256
// bytes, the last one shorter, and all that lies behind the end of `held`.
// ranges: whatever it held, its memory is used again.
void changed_ranges(std::span<const std::byte> held, std::span<const std::byte> bytes, std::vector<ByteRange>& ranges);

}  // namespace candela
