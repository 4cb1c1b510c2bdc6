#include "session/changed_ranges.h"

#include <algorithm>
#include <cstring>

namespace candela {

void changed_ranges(std::span<const std::byte> held, std::span<const std::byte> bytes, std::vector<ByteRange>& ranges) {
  constexpr size_t piece = 256;
  ranges.clear();
  for (size_t at = 0; at < bytes.size(); at += piece) {
    const size_t count = std::min(piece, bytes.size() - at);
    if (at + count <= held.size() && std::memcmp(held.data() + at, bytes.data() + at, count) == 0) continue;
    if (!ranges.empty() && ranges.back().first + ranges.back().count == at)
      ranges.back().count += count;
    else
      ranges.push_back({at, count});
  }
}

}  // namespace candela
