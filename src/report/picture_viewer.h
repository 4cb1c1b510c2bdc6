#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace candela {

// Two pictures of the same size and the map of their difference, to be looked at in a page: side by side, one over the
// other with a slider between them, in turn, or the difference with its colour bar, at one to eight times their size.
struct ViewedPictures {
  std::string first = "golden", second = "new";            // what they are
  std::vector<std::byte> first_png, second_png, heat_png;  // the last may be empty
};
std::string viewer_html(const ViewedPictures& pictures);

// Once a page: in its head, and at its end. Needs nothing from outside.
std::string viewer_style();
std::string_view viewer_script();

}  // namespace candela
