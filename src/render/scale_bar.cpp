#include "render/scale_bar.h"

#include <algorithm>

#include "metrics/heatmap.h"
#include "render/canvas.h"

namespace candela {

void draw_scale_bar(DisplayImage& image, const ScaleBar& scale_bar) {
  const int width = image.width, height = image.height;
  if (width < 160 || height < 60) return;
  const int scale = width >= 1280 && height >= 640 ? 3 : width >= 640 && height >= 320 ? 2 : 1;
  const int bar = std::max(width / 4, Canvas::text_width(scale_bar.title, scale)), thick = 4 * scale, gap = 3 * scale;
  const int line = Canvas::letter_height * scale;
  const int plate_height = 4 * gap + thick + 2 * line, x = 2 * gap, y = height - plate_height;
  Canvas canvas(image);
  canvas.fill(0, y, bar + 4 * gap, plate_height, {40, 40, 40});
  canvas.write(x, y + gap, scale_bar.title, scale);
  Plane ramp(size_t(bar) * size_t(thick));
  for (size_t i = 0; i < ramp.size(); ++i) {
    const float along = float(i % size_t(bar)) / float(bar - 1);
    ramp[i] = scale_bar.falling ? 1 - along : along;
  }
  const DisplayImage colors = heatmap(ramp, bar, thick);
  const int shown = std::min(bar, width - x);
  for (int j = 0; j < thick; ++j)
    std::copy_n(&colors.pixels[size_t(j) * size_t(bar) * 3], size_t(shown) * 3,
                &image.pixels[(size_t(y + 2 * gap + line + j) * size_t(width) + size_t(x)) * 3]);
  const int below = y + 3 * gap + line + thick;
  canvas.write(x, below, scale_bar.first, scale);
  canvas.write(x + (bar - Canvas::text_width(scale_bar.middle, scale)) / 2, below, scale_bar.middle, scale);
  canvas.write(x + bar - Canvas::text_width(scale_bar.last, scale), below, scale_bar.last, scale);
}

}  // namespace candela
