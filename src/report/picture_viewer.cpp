#include "report/picture_viewer.h"

#include "metrics/heatmap.h"
#include "report/golden_report.h"

namespace candela {
namespace {

// The heat map's colours from 0 to 1 as stops of a gradient.
std::string gradient() {
  constexpr int stops = 17;
  Plane ramp(stops);
  for (int i = 0; i < stops; ++i) ramp[size_t(i)] = float(i) / (stops - 1);
  const DisplayImage colours = heatmap(ramp, stops, 1);
  std::string text;
  for (size_t i = 0; i < stops; ++i)
    text += fmt::format(",#{:02x}{:02x}{:02x}", uint8_t(colours.pixels[3 * i]), uint8_t(colours.pixels[3 * i + 1]),
                        uint8_t(colours.pixels[3 * i + 2]));
  return text;
}

std::string button(std::string_view group, std::string_view value, std::string_view text, bool pressed) {
  return fmt::format("<button type=\"button\" data-{}=\"{}\" aria-pressed=\"{}\">{}</button>", group, value, pressed,
                     escape_markup(text));
}

std::string pane(std::string_view name, std::string_view role, std::span<const std::byte> png) {
  return fmt::format("<figure class=\"{}\"><img src=\"{}\" alt=\"{}\"><figcaption>{}</figcaption></figure>\n", role,
                     data_url(png), escape_markup(name), escape_markup(name));
}

}  // namespace

std::string base64(std::span<const std::byte> bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k) group = group << 8 | (i + k < bytes.size() ? uint32_t(bytes[i + k]) : 0);
    for (size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string data_url(std::span<const std::byte> png) { return "data:image/png;base64," + base64(png); }

std::string viewer_html(const ViewedPictures& p) {
  const bool heat = !p.heat_png.empty();
  std::string html = "<div class=\"viewer\" data-mode=\"beside\">\n<p class=\"modes\">";
  html += button("mode", "beside", "side by side", true) + button("mode", "slide", "slider", false) +
          button("mode", "blink", "blink", false);
  if (heat) html += button("mode", "heat", "difference", false);
  html += " zoom ";
  for (const char* zoom : {"1", "2", "4", "8"}) html += button("zoom", zoom, zoom, *zoom == '1');
  html +=
      "</p>\n<input class=\"slider\" type=\"range\" min=\"0\" max=\"100\" value=\"50\" aria-label=\"where the "
      "pictures meet\">\n<div class=\"panes\">\n";
  html += pane(p.first, "first", p.first_png) + pane(p.second, "second", p.second_png);
  if (heat) html += pane("FLIP", "heat", p.heat_png);
  html += "</div>\n";
  if (heat) html += "<p class=\"bar\">0 <span></span> 1, FLIP of each pixel</p>\n";
  return html + "</div>\n";
}

std::string viewer_style() {
  return ".viewer figure{display:inline-block;margin:.3em;vertical-align:top}"
         ".viewer img{display:block;image-rendering:pixelated;max-width:none}"
         ".viewer .panes{position:relative;overflow:auto}"
         ".viewer button{font:inherit;margin-right:.3em}.viewer button[aria-pressed=true]{background:#246;color:#fff}"
         ".viewer .slider{display:none;width:20em}.viewer[data-mode=slide] .slider{display:block}"
         ".viewer[data-mode=slide] .heat,.viewer[data-mode=blink] .heat,"
         ".viewer[data-mode=heat] .first,.viewer[data-mode=heat] .second{display:none}"
         ".viewer[data-mode=slide] .second,.viewer[data-mode=blink] .second{position:absolute;left:0;top:0}"
         ".viewer[data-mode=slide] figcaption{display:none}"
         ".viewer[data-mode=blink].off .second{visibility:hidden}"
         ".viewer[data-mode=blink]:not(.off) .first figcaption{visibility:hidden}"
         ".viewer .bar span{display:inline-block;width:16em;height:.8em;background:linear-gradient(to right" +
         gradient() + ")}";
}

std::string_view viewer_script() {
  return R"script(<script>
for (const viewer of document.querySelectorAll(".viewer")) {
  const second = viewer.querySelector(".second img"), slider = viewer.querySelector(".slider");
  const press = (group, button) => {
    for (const other of viewer.querySelectorAll("button[data-" + group + "]"))
      other.setAttribute("aria-pressed", other === button);
  };
  const slide = () => {
    second.style.clipPath = viewer.dataset.mode === "slide" ? "inset(0 0 0 " + slider.value + "%)" : "";
  };
  let timer = 0;
  for (const button of viewer.querySelectorAll("button[data-mode]"))
    button.onclick = () => {
      press("mode", button);
      viewer.dataset.mode = button.dataset.mode;
      viewer.classList.remove("off");
      clearInterval(timer);
      if (button.dataset.mode === "blink") timer = setInterval(() => viewer.classList.toggle("off"), 500);
      slide();
    };
  for (const button of viewer.querySelectorAll("button[data-zoom]"))
    button.onclick = () => {
      press("zoom", button);
      for (const img of viewer.querySelectorAll("img")) img.style.width = img.naturalWidth * button.dataset.zoom + "px";
    };
  slider.oninput = slide;
}
</script>
)script";
}

}  // namespace candela
