#include "graph/image_range.h"

#include <fmt/format.h>

#include "graph/plan.h"

namespace candela {

ImageRange whole(const ImageDesc& desc) { return {0, desc.mips, 0, desc.layers}; }

ImageRange resolved(ImageRange range, const ImageDesc& desc) {
  if (range.mip_count == ImageRange::all) range.mip_count = desc.mips - std::min(desc.mips, range.first_mip);
  if (range.layer_count == ImageRange::all) range.layer_count = desc.layers - std::min(desc.layers, range.first_layer);
  return range;
}

bool fits(const ImageRange& range, const ImageDesc& desc) {
  const auto inside = [](uint32_t first, uint32_t count, uint32_t end) {
    return count > 0 && first < end && count <= end - first;
  };
  return inside(range.first_mip, range.mip_count, desc.mips) &&
         inside(range.first_layer, range.layer_count, desc.layers);
}

namespace {
std::string span_text(const char* one, uint32_t first, uint32_t count) {
  return count == 1 ? fmt::format("{} {}", one, first) : fmt::format("{}s {}-{}", one, first, first + count - 1);
}
}  // namespace

std::string range_text(const ImageRange& range, const ImageDesc& desc) {
  const ImageRange all = whole(desc);
  const bool mips = range.first_mip != 0 || range.mip_count != all.mip_count;
  const bool layers = range.first_layer != 0 || range.layer_count != all.layer_count;
  if (!mips && !layers) return "";
  return fmt::format("[{}{}{}]", mips ? span_text("mip", range.first_mip, range.mip_count) : "",
                     mips && layers ? ", " : "",
                     layers ? span_text("layer", range.first_layer, range.layer_count) : "");
}

const char* image_kind_name(ImageKind kind) {
  constexpr const char* names[] = {"2D", "2D array", "cube", "cube array", "3D"};
  return names[int(kind)];
}

}  // namespace candela
