#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// Deflate streams (RFC 1951 in RFC 1950's frame) made for pictures: what was filtered before, so that mostly entropy
// coding is left. Bytes depend on the input alone: on no library's version, and not on how many threads there are.
namespace candela {

// A whole zlib stream. threads: the input's pieces are compressed side by side.
std::vector<std::byte> zlib_stream(std::span<const std::byte> input, bool threads);
// The same appended to `out`.
void append_zlib_stream(std::vector<std::byte>& out, std::span<const std::byte> input, bool threads);

}  // namespace candela
