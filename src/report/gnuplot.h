#pragma once
#include <optional>
#include <string>

namespace candela {

bool has_gnuplot();
// What gnuplot prints for a script: an SVG. Nothing when gnuplot is not there or fails; started without a shell.
// The same script, the same bytes.
std::optional<std::string> gnuplot_svg(const std::string& script);

}  // namespace candela
