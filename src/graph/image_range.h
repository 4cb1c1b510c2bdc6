#pragma once
#include <algorithm>
#include <cstdint>
#include <string>

namespace candela {

struct ImageDesc;

// The shapes of images and of views of them. A face of a cube is a layer; a 3D image has one layer.
enum class ImageKind : uint8_t { d2, d2_array, cube, cube_array, d3 };

// Some subresources of an image: a rectangle of mips x layers. By default all of them.
struct ImageRange {
  static constexpr uint32_t all = ~0u;  // as a count: up to the last
  uint32_t first_mip = 0, mip_count = all, first_layer = 0, layer_count = all;
  bool operator==(const ImageRange&) const = default;
  auto operator<=>(const ImageRange&) const = default;
  static constexpr ImageRange mip(uint32_t mip) { return {mip, 1, 0, all}; }
  static constexpr ImageRange layer(uint32_t layer, uint32_t mip = 0) { return {mip, 1, layer, 1}; }
  bool is_default() const { return *this == ImageRange{}; }
  bool overlaps(const ImageRange& other) const {  // of counts that are resolved
    return first_mip < other.first_mip + other.mip_count && other.first_mip < first_mip + mip_count &&
           first_layer < other.first_layer + other.layer_count && other.first_layer < first_layer + layer_count;
  }
};

// Calls f(index) with the place of each subresource of a resolved range, mip by mip: mip * layers + layer.
template <class F>
void for_subresources(const ImageRange& range, uint32_t layers, F f) {
  for (uint32_t mip = range.first_mip; mip < range.first_mip + range.mip_count; ++mip)
    for (uint32_t layer = range.first_layer; layer < range.first_layer + range.layer_count; ++layer)
      f(size_t(mip) * layers + layer);
}

ImageRange whole(const ImageDesc& desc);
// "all" becomes a number. A range that leaves the image stays one that does: see fits.
ImageRange resolved(ImageRange range, const ImageDesc& desc);
bool fits(const ImageRange& range, const ImageDesc& desc);               // of a resolved range: not empty, and inside
std::string range_text(const ImageRange& range, const ImageDesc& desc);  // "[mip 2, layers 0-5]"; "" for the whole

constexpr uint32_t mip_size(uint32_t size, uint32_t mip) { return std::max(size >> mip, 1u); }
const char* image_kind_name(ImageKind kind);  // "2D array"

}  // namespace candela
