#pragma once
#include <cstdint>

// The C interface of the module candela_oiio.so: plain pointers and sizes, so that nothing of OpenImageIO or of the C++
// library's types crosses the border. Both sides include this header; `abi_version` guards against a stale module.
namespace candela::oiio {

inline constexpr uint32_t abi_version = 2;
inline constexpr const char* table_symbol = "candela_oiio_table";

// read() returns 0 on success; else it writes a zero-terminated reason to `message` (of `message_size` bytes).
struct Table {
  uint32_t version;

  // Reads any format as float, interleaved, rows from the top. Integer formats give code value / maximum. First `begin`
  // says the size and the channel names (joined by '\n') and returns where to put width*height*channels floats, or null
  // to refuse.
  int (*read)(const char* path, float* (*begin)(void* context, int width, int height, int channels, const char* names),
              void* context, char* message, uint64_t message_size);
};

}  // namespace candela::oiio
