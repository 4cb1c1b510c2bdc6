#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"

namespace candela {

// An image that is asked for as it stands behind a pass: `render --dump PASS.IMAGE[mip,layer]`, `--view
// debug.PASS.IMAGE[mip,layer]`.
struct DumpRequest {
  std::string name;  // "depth_views.sun.sun.maps": both parts may hold points
  uint32_t mip = 0, layer = 0;
  std::string option = "--dump";  // which errors name
  std::string text() const;
};
Expected<DumpRequest> parse_dump(const std::string& text, const std::string& option = "--dump");
// The image that a view named debug.PASS.IMAGE shows; absent: it is a layer's name, or no such name.
std::optional<DumpRequest> image_of_view(const std::string& view);
inline constexpr std::string_view image_view_prefix = "debug.";

}  // namespace candela
