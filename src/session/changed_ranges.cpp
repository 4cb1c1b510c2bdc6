#include "session/changed_ranges.h"

#include <algorithm>
#include <cstring>

namespace candela {

std::vector<ByteRange> changed_ranges(std::span<const std::byte> held, std::span<const std::byte> bytes) {
  constexpr size_t piece = 256;
  std::vector<ByteRange> ranges;
  for (size_t at = 0; at < bytes.size(); at += piece) {
    const size_t count = std::min(piece, bytes.size() - at);
    if (at + count <= held.size() && std::memcmp(held.data() + at, bytes.data() + at, count) == 0) continue;
    if (!ranges.empty() && ranges.back().first + ranges.back().count == at)
      ranges.back().count += count;
    else
      ranges.push_back({at, count});
  }
  return ranges;
}

}  // namespace candela
