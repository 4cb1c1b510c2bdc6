#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "metrics/planes.h"

namespace candela {

// Two pictures of the same size and the maps of their difference, to be looked at in a page: side by side, one over the
// other with a slider between them, in turn, or a map with its colour bar, at one to eight times their size.
struct ViewedPictures {
  std::string first = "golden", second = "new";            // what they are
  std::vector<std::byte> first_png, second_png, heat_png;  // heat: FLIP; may be empty
  // What is displayed, where it differs: the map of differences, its largest value white; the pixel of that, and cut
  // out around it the pictures and the map.
  struct Worst {
    int x = 0, y = 0;                      // pixels from the upper left corner
    std::array<int, 3> first{}, second{};  // 8-bit codes there
    double largest = 0;                    // of 1
    std::vector<std::byte> map_png, first_png, second_png, part_png;
    int part_x = 0, part_y = 0, part_width = 0, part_height = 0;  // what is cut out
  };
  std::optional<Worst> worst;  // none: no pixel differs
};
std::string viewer_html(const ViewedPictures& pictures);

// Of planes of R, G and B in [0,1], width x height each, as they are displayed, and the map of FLIP, which may be
// empty. place: what an error of writing PNG names.
Expected<ViewedPictures> viewed_pictures(const std::vector<Plane>& first, const std::vector<Plane>& second,
                                         const Plane& flip, int width, int height, const std::string& place);

// Once a page: in its head, and at its end. Needs nothing from outside.
std::string viewer_style();
std::string_view viewer_script();

}  // namespace candela
