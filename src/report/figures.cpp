#include "report/figures.h"

#include <fmt/format.h>

#include "report/gnuplot.h"
#include "report/markup.h"

namespace candela {

std::string Figures::file_name(const std::string& title, const char* ending) const {
  constexpr size_t longest = 60;
  std::string name;
  for (const char c : title) {
    const bool kept = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    const bool capital = c >= 'A' && c <= 'Z';
    if (name.size() >= longest) break;
    if (kept || capital)
      name += capital ? char(c - 'A' + 'a') : c;
    else if (!name.empty() && name.back() != '-')
      name += '-';
  }
  while (!name.empty() && name.back() == '-') name.pop_back();
  return fmt::format("{:02}-{}{}", files_.size() + 1, name, ending);
}

// An image element of its own: gnuplot's files use the same identifiers in every figure.
std::string Figures::add(const std::string& title, const std::string& script, const std::string& caption) {
  if (script.empty() || !draw_) return {};
  const auto svg = gnuplot_svg(script);
  if (!svg) return fmt::format("<p class=\"note\">gnuplot could not draw: {}</p>\n", escape_markup(title));
  files_.emplace_back(file_name(title, ".svg"), *svg);
  return fmt::format("<figure class=\"plot\"><img src=\"data:image/svg+xml;base64,{}\" alt=\"{}\">{}</figure>\n",
                     base64(std::as_bytes(std::span(*svg))), escape_markup(title),
                     caption.empty() ? "" : "<figcaption>" + escape_markup(caption) + "</figcaption>");
}

std::string Figures::add_picture(const std::string& title, std::span<const std::byte> png, const std::string& caption) {
  if (png.empty()) return {};
  files_.emplace_back(file_name(title, ".png"), std::string(reinterpret_cast<const char*>(png.data()), png.size()));
  return fmt::format("<figure class=\"picture\"><img src=\"{}\" alt=\"{}\"><figcaption>{}</figcaption></figure>\n",
                     data_url(png), escape_markup(title), escape_markup(caption));
}

}  // namespace candela
