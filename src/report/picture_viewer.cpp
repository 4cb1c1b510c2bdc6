#include "report/picture_viewer.h"

#include "image/png_write.h"
#include "metrics/difference.h"
#include "metrics/heatmap.h"
#include "report/markup.h"

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
  return fmt::format(
      "<figure class=\"{}\"><figcaption>{}</figcaption><div class=\"box\"><img src=\"{}\" "
      "alt=\"{}\"></div></figure>\n",
      role, escape_markup(name), data_url(png), escape_markup(name));
}

std::string bar(std::string_view role, std::string_view from, std::string_view to, std::string_view meaning) {
  return fmt::format(
      "<p class=\"bar {}\"><span>{}</span><span class=\"ramp\"></span><span>{}</span><span>{}</span></p>\n", role, from,
      to, meaning);
}

std::string code_text(const std::array<int, 3>& code) { return fmt::format("{}, {}, {}", code[0], code[1], code[2]); }

// The neighbourhood of the pixel that differs most, with a frame about that pixel.
std::string worst_html(const ViewedPictures& p) {
  const ViewedPictures::Worst& w = *p.worst;
  std::string html = fmt::format(
      "<p>Largest difference: {:.0f} of 255 at pixel {}, {} (from the upper left corner); 8-bit codes there: {} {}, {} "
      "{}.</p>\n<div class=\"worst\">\n",
      w.largest * 255, w.x, w.y, escape_markup(p.first), code_text(w.first), escape_markup(p.second),
      code_text(w.second));
  const std::string mark =
      fmt::format("left:{:.4f}%;top:{:.4f}%;width:{:.4f}%;height:{:.4f}%", 100.0 * (w.x - w.part_x) / w.part_width,
                  100.0 * (w.y - w.part_y) / w.part_height, 100.0 / w.part_width, 100.0 / w.part_height);
  for (const auto& [name, png] :
       {std::pair(std::string_view(p.first), &w.first_png), {p.second, &w.second_png}, {"difference", &w.part_png}})
    html += fmt::format(
        "<figure><div><img src=\"{}\" alt=\"{} around pixel {}, {}\"><span "
        "style=\"{}\"></span></div><figcaption>{}</figcaption></figure>\n",
        data_url(*png), escape_markup(name), w.x, w.y, mark, escape_markup(name));
  return html + "</div>\n";
}

}  // namespace

std::string viewer_html(const ViewedPictures& p) {
  const bool heat = !p.heat_png.empty();
  std::string html = "<div class=\"viewer\" data-mode=\"beside\">\n<p class=\"modes\"><span>";
  html += button("mode", "beside", "side by side", true) + button("mode", "slide", "slider", false) +
          button("mode", "blink", "blink", false);
  if (heat) html += button("mode", "heat", "FLIP", false);
  if (p.worst) html += button("mode", "scaled", "difference", false);
  html += "</span><span>zoom ";
  for (const char* zoom : {"fit", "1", "2", "4", "8"}) html += button("zoom", zoom, zoom, *zoom == 'f');
  html +=
      "</span></p>\n<p class=\"state\"></p>\n<input class=\"slider\" type=\"range\" min=\"0\" max=\"100\" "
      "value=\"50\" aria-label=\"where the pictures meet\">\n<div class=\"panes\">\n";
  html += pane(p.first, "first", p.first_png) + pane(p.second, "second", p.second_png);
  if (heat) html += pane("FLIP", "heat", p.heat_png);
  if (p.worst) html += pane("difference", "scaled", p.worst->map_png);
  html += "</div>\n";
  if (heat) html += bar("of-heat", "0", "1", "FLIP of each pixel: 0 no visible difference, 1 the largest");
  if (p.worst)
    html += bar("of-scaled", "0", fmt::format("{:.0f}", p.worst->largest * 255),
                "difference of each pixel's displayed value, its farthest channel, of 255");
  return html + "</div>\n" + (p.worst ? worst_html(p) : std::string());
}

Expected<ViewedPictures> viewed_pictures(const std::vector<Plane>& first, const std::vector<Plane>& second,
                                         const Plane& flip, int width, int height, const std::string& place) {
  constexpr int part_px = 33;
  const DisplayImage images[2] = {as_display(first, width, height), as_display(second, width, height)};
  ViewedPictures pictures;
  Expected<void> made;
  const auto put = [&](const DisplayImage& image, std::vector<std::byte>& png) {
    auto encoded = encode_png(image, place);
    if (!encoded)
      made = std::unexpected(encoded.error());
    else
      png = std::move(*encoded);
  };
  put(images[0], pictures.first_png), put(images[1], pictures.second_png);
  if (!flip.empty()) put(heatmap(flip, width, height), pictures.heat_png);
  DisplayDifference difference = display_difference(first, second, width, height);
  if (difference.largest > 0) {
    ViewedPictures::Worst& worst = pictures.worst.emplace();
    worst.x = difference.x, worst.y = difference.y, worst.largest = double(difference.largest);
    const size_t at = 3 * (size_t(worst.y) * size_t(width) + size_t(worst.x));
    for (size_t c = 0; c < 3; ++c)
      worst.first[c] = int(images[0].pixels[at + c]), worst.second[c] = int(images[1].pixels[at + c]);
    for (float& value : difference.map) value /= difference.largest;
    const DisplayImage map = heatmap(difference.map, width, height);
    const Around part = square_around(worst.x, worst.y, part_px, width, height);
    worst.part_x = part.x, worst.part_y = part.y, worst.part_width = part.width, worst.part_height = part.height;
    put(map, worst.map_png), put(cut_out(map, part), worst.part_png);
    put(cut_out(images[0], part), worst.first_png), put(cut_out(images[1], part), worst.second_png);
  }
  if (!made) return std::unexpected(made.error());
  return pictures;
}

std::string viewer_style() {
  return ".viewer{margin:.8em 0}.viewer .modes{display:flex;flex-wrap:wrap;gap:.5em 1.5em}"
         ".viewer button{font:inherit;margin:0 .3em .3em 0;padding:.15em .7em;border:1px solid "
         "#9aa4ae;border-radius:4px;"
         "background:#fff;color:inherit}.viewer "
         "button[aria-pressed=true]{background:#0072b2;border-color:#0072b2;color:#fff}"
         ".viewer .state{min-height:1.5em;margin:.2em 0;color:#5c6670}.viewer .slider{display:none;width:100%;margin:0}"
         ".viewer[data-mode=slide] .slider{display:block}.viewer figure{margin:0;min-width:0}"
         ".viewer .panes{display:grid;gap:.8em;grid-auto-columns:minmax(0,1fr);grid-auto-flow:column}"
         ".viewer .box{overflow:auto;max-height:85vh}.viewer img{display:block;max-width:none}"
         ".viewer:not([data-mode=beside]) .panes{grid-template-columns:minmax(0,1fr);grid-auto-flow:row}"
         ".viewer:not([data-mode=beside]) figcaption{display:none}"
         ".viewer .scaled,.viewer .bar.of-scaled{display:none}.viewer[data-mode=scaled] .scaled{display:block}"
         ".viewer[data-mode=scaled] .bar.of-scaled{display:flex}"
         ".viewer[data-mode=slide] .heat,.viewer[data-mode=blink] .heat,.viewer[data-mode=scaled] .heat,"
         ".viewer[data-mode=scaled] .bar.of-heat,.viewer[data-mode=scaled] .first,.viewer[data-mode=scaled] .second,"
         ".viewer[data-mode=heat] .first,.viewer[data-mode=heat] .second{display:none}"
         ".viewer[data-mode=slide] .panes figure,.viewer[data-mode=blink] .panes figure{grid-area:1/1}"
         ".viewer[data-mode=slide] .panes{cursor:ew-resize;touch-action:pan-y;user-select:none}"
         ".viewer[data-mode=blink].off .second{visibility:hidden}"
         ".viewer .bar{display:flex;flex-wrap:wrap;gap:.3em .6em;align-items:center;font-size:.85em;color:#5c6670}"
         ".viewer .bar .ramp{width:16em;height:.9em;background:linear-gradient(to right" +
         gradient() +
         ")}.worst{display:flex;flex-wrap:wrap;gap:.8em}.worst figure{margin:0;flex:0 1 15em}"
         ".worst div{position:relative}.worst img{display:block;width:100%;image-rendering:pixelated}"
         ".worst span{position:absolute;box-sizing:content-box;margin:-2px;border:2px solid #fff;outline:2px solid "
         "#b00020}@media(max-width:600px){.viewer[data-mode=beside] .panes{grid-auto-flow:row}}";
}

std::string_view viewer_script() {
  return R"script(<script>
for (const viewer of document.querySelectorAll(".viewer")) {
  const find = name => viewer.querySelector(name), all = name => viewer.querySelectorAll(name);
  const second = find(".second img"), slider = find(".slider"), state = find(".state"), boxes = all(".box");
  const names = [find(".first img").alt, second.alt];
  let timer = 0, zoom = "fit";
  const press = (group, button) => {
    for (const other of all("button[data-" + group + "]")) other.setAttribute("aria-pressed", other === button);
  };
  const show = () => {
    const mode = viewer.dataset.mode;
    second.style.clipPath = mode === "slide" ? "inset(0 0 0 " + slider.value + "%)" : "";
    state.textContent = mode === "slide" ? "left: " + names[0] + ", right: " + names[1]
      : mode === "blink" ? names[viewer.classList.contains("off") ? 0 : 1] : "";
  };
  const scale = () => {
    for (const img of all("img")) {
      const wide = img.parentElement.clientWidth;
      img.style.width = zoom === "fit" ? "100%" : img.naturalWidth * zoom + "px";
      img.style.imageRendering = zoom === "fit" && wide < img.naturalWidth ? "auto" : "pixelated";
    }
  };
  for (const button of all("button[data-mode]"))
    button.onclick = () => {
      press("mode", button);
      viewer.dataset.mode = button.dataset.mode;
      viewer.classList.remove("off");
      clearInterval(timer);
      if (button.dataset.mode === "blink") timer = setInterval(() => { viewer.classList.toggle("off"); show(); }, 500);
      scale();
      show();
    };
  for (const button of all("button[data-zoom]"))
    button.onclick = () => {
      press("zoom", button);
      zoom = button.dataset.zoom;
      scale();
    };
  for (const box of boxes)
    box.onscroll = () => {
      for (const other of boxes)
        if (other !== box) other.scrollLeft = box.scrollLeft, other.scrollTop = box.scrollTop;
    };
  slider.oninput = show;
  find(".panes").onpointerdown = find(".panes").onpointermove = event => {
    if (viewer.dataset.mode !== "slide" || !event.buttons) return;
    const place = second.getBoundingClientRect();
    slider.value = 100 * (event.clientX - place.left) / place.width;
    event.preventDefault();
    show();
  };
  for (const img of all("img")) img.draggable = false;
  addEventListener("resize", scale);
  scale();
}
</script>
)script";
}

}  // namespace candela
