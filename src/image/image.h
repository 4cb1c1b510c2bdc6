#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace candela {

enum class ChannelType : uint8_t { half, float32, uint32 };

// A named plane of an image; `data` holds width*height samples, rows from the top, as float or (uint32) bit-exact
// integers.
struct Channel {
  std::string name;                         // field's names: R G B A, depth.Z, normal.X ... (docs/using/outputs.md)
  ChannelType type = ChannelType::float32;  // how it is stored in a file
  std::vector<float> f;                     // used when type != uint32
  std::vector<uint32_t> u;                  // used when type == uint32
};

// Values are scene-linear Rec.709 unless said otherwise. metadata: name -> text, number or matrix, written into EXR
// headers.
struct MetadataEntry {
  std::string name;
  enum class Kind { text, number, integer, matrix44 } kind = Kind::text;
  std::string text;
  double number = 0;
  std::vector<float> matrix;  // 16, row-major as OpenEXR stores M44f
};

struct FloatImage {
  int width = 0, height = 0;  // of the data window
  // Where the data window lies in the display window, and the display window's size; 0: both windows are the same.
  int origin_x = 0, origin_y = 0, display_width = 0, display_height = 0;
  std::vector<Channel> channels;
  std::vector<MetadataEntry> metadata;
  const Channel* find(std::string_view name) const {
    for (const Channel& c : channels)
      if (c.name == name) return &c;
    return nullptr;
  }
};

// A plane whose samples somebody else keeps: rows from the top, as a file stores them.
struct PlaneView {
  std::string name;
  ChannelType type = ChannelType::float32;
  const std::byte* data = nullptr;
  size_t row_bytes = 0;  // from one row to the next
};
struct PictureView {
  int width = 0, height = 0;
  int origin_x = 0, origin_y = 0, display_width = 0, display_height = 0;  // as in FloatImage
  std::vector<PlaneView> planes;
  std::vector<MetadataEntry> metadata;
};

// 8- or 16-bit display-referred pixels, interleaved, rows from the top.
struct DisplayImage {
  int width = 0, height = 0, channels = 3, bits = 8;  // bits 8 or 16 (native endian)
  std::vector<std::byte> pixels;
};
struct DisplayView {
  int width = 0, height = 0, channels = 3, bits = 8;
  const std::byte* pixels = nullptr;
  size_t row_bytes = 0;  // from one row to the next
};
inline size_t row_bytes(const DisplayImage& image) {
  return size_t(image.width) * size_t(image.channels) * size_t(image.bits / 8);
}
inline DisplayView view_of(const DisplayImage& image) {
  return {image.width, image.height, image.channels, image.bits, image.pixels.data(), row_bytes(image)};
}

}  // namespace candela
