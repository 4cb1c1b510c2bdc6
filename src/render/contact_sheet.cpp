#include "render/contact_sheet.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "metrics/planes.h"
#include "render/canvas.h"

namespace candela {
namespace {

constexpr int gap = 8, caption_scale = 2;
constexpr int caption_height = Canvas::letter_height * caption_scale + gap;

// What each new pixel covers of the old ones along one side.
struct Cover {
  size_t first = 0;
  std::vector<double> shares;  // sum to 1
};
std::vector<Cover> covers(int from, int to) {
  std::vector<Cover> all(size_t(to), Cover{});
  for (int i = 0; i < to; ++i) {
    const double low = double(i) * from / to, high = double(i + 1) * from / to;
    Cover& cover = all[size_t(i)];
    cover.first = size_t(low);
    for (size_t p = cover.first; p < size_t(from) && double(p) < high; ++p)
      cover.shares.push_back((std::min(high, double(p + 1)) - std::max(low, double(p))) / (high - low));
  }
  return all;
}

// encoded: the values are of sRGB, and what they stand for is averaged.
std::vector<float> shrunk(const std::vector<float>& plane, int width, int new_width, int new_height, int height,
                          bool encoded) {
  const std::vector<Cover> across = covers(width, new_width), down = covers(height, new_height);
  std::vector<float> result(size_t(new_width) * size_t(new_height));
  for (size_t y = 0; y < size_t(new_height); ++y)
    for (size_t x = 0; x < size_t(new_width); ++x) {
      double sum = 0;
      for (size_t j = 0; j < down[y].shares.size(); ++j)
        for (size_t i = 0; i < across[x].shares.size(); ++i) {
          const float v = plane[(down[y].first + j) * size_t(width) + across[x].first + i];
          sum += down[y].shares[j] * across[x].shares[i] * (encoded ? linear_from_srgb(v) : v);
        }
      result[y * size_t(new_width) + x] = encoded ? srgb_from_linear(float(sum)) : float(sum);
    }
  return result;
}

// At most as large as a tile.
SheetPicture fitted(const SheetPicture& picture, const SheetLayout& layout) {
  const double scale =
      std::min({1.0, double(layout.tile_width) / picture.width, double(layout.tile_height) / picture.height});
  const int width = std::max(1, int(std::lround(picture.width * scale))),
            height = std::max(1, int(std::lround(picture.height * scale)));
  if (width == picture.width && height == picture.height) return picture;
  SheetPicture result{.width = width, .height = height, .caption = picture.caption};
  for (const auto& plane : picture.planes)
    result.planes.push_back(shrunk(plane, picture.width, width, height, picture.height, true));
  if (!picture.alpha.empty()) result.alpha = shrunk(picture.alpha, picture.width, width, height, picture.height, false);
  return result;
}

// What shows through at a pixel of a picture, display-encoded.
float checker(int x, int y) {
  constexpr int side_px = 8;
  return (x / side_px + y / side_px) % 2 == 0 ? 0.6f : 0.4f;
}

void put(const SheetPicture& picture, int x, int y, DisplayImage& sheet) {
  for (int j = 0; j < picture.height; ++j)
    for (int i = 0; i < picture.width; ++i)
      for (size_t c = 0; c < 3; ++c) {
        const size_t at = size_t(j) * size_t(picture.width) + size_t(i);
        float v = picture.planes[c][at];
        if (!picture.alpha.empty()) v += (1 - picture.alpha[at]) * checker(i, j);
        sheet.pixels[(size_t(y + j) * size_t(sheet.width) + size_t(x + i)) * 3 + c] =
            std::byte(int(std::clamp(v, 0.0f, 1.0f) * 255.0f + 0.5f));
      }
}

// In capitals, with its end where it is too long for the tile.
std::string caption_of(const SheetPicture& picture, int tile_width) {
  std::string text = picture.caption;
  for (char& c : text) c = char(std::toupper(static_cast<unsigned char>(c)));
  const size_t most = size_t(std::max(1, (tile_width + caption_scale) / ((Canvas::letter_width + 1) * caption_scale)));
  return text.size() > most ? text.substr(text.size() - most) : text;
}

}  // namespace

DisplayImage contact_sheet(std::span<const SheetPicture> pictures, const SheetLayout& layout) {
  CHECK(!pictures.empty() && layout.tile_width > 0 && layout.tile_height > 0 && layout.columns >= 0);
  const int count = int(pictures.size());
  const int columns = std::min(count, layout.columns > 0 ? layout.columns : int(std::ceil(std::sqrt(double(count)))));
  const int rows = (count + columns - 1) / columns;
  const int step_x = layout.tile_width + gap, step_y = layout.tile_height + caption_height + gap;
  DisplayImage sheet{.width = columns * step_x + gap, .height = rows * step_y + gap};
  sheet.pixels.resize(size_t(sheet.width) * size_t(sheet.height) * 3);
  Canvas canvas(sheet);
  canvas.fill(0, 0, sheet.width, sheet.height, {24, 24, 24});
  for (int k = 0; k < count; ++k) {
    CHECK(pictures[size_t(k)].planes.size() == 3);
    const SheetPicture picture = fitted(pictures[size_t(k)], layout);
    const int x = gap + k % columns * step_x, y = gap + k / columns * step_y;
    put(picture, x + (layout.tile_width - picture.width) / 2, y + (layout.tile_height - picture.height) / 2, sheet);
    canvas.write(x, y + layout.tile_height + gap / 2, caption_of(picture, layout.tile_width), caption_scale);
  }
  return sheet;
}

}  // namespace candela
