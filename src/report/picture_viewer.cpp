#include "report/picture_viewer.h"

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

}  // namespace

std::string viewer_html(const ViewedPictures& p) {
  const bool heat = !p.heat_png.empty();
  std::string html = "<div class=\"viewer\" data-mode=\"beside\">\n<p class=\"modes\"><span>";
  html += button("mode", "beside", "side by side", true) + button("mode", "slide", "slider", false) +
          button("mode", "blink", "blink", false);
  if (heat) html += button("mode", "heat", "difference", false);
  html += "</span><span>zoom ";
  for (const char* zoom : {"fit", "1", "2", "4", "8"}) html += button("zoom", zoom, zoom, *zoom == 'f');
  html +=
      "</span></p>\n<p class=\"state\"></p>\n<input class=\"slider\" type=\"range\" min=\"0\" max=\"100\" "
      "value=\"50\" aria-label=\"where the pictures meet\">\n<div class=\"panes\">\n";
  html += pane(p.first, "first", p.first_png) + pane(p.second, "second", p.second_png);
  if (heat) html += pane("FLIP", "heat", p.heat_png);
  html += "</div>\n";
  if (heat)
    html +=
        "<p class=\"bar\"><span>0</span><span class=\"ramp\"></span><span>1</span><span>FLIP of each pixel: 0 nobody "
        "sees a difference, 1 the largest</span></p>\n";
  return html + "</div>\n";
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
         ".viewer[data-mode=slide] .heat,.viewer[data-mode=blink] .heat,"
         ".viewer[data-mode=heat] .first,.viewer[data-mode=heat] .second{display:none}"
         ".viewer[data-mode=slide] .panes figure,.viewer[data-mode=blink] .panes figure{grid-area:1/1}"
         ".viewer[data-mode=slide] .panes{cursor:ew-resize;touch-action:pan-y;user-select:none}"
         ".viewer[data-mode=blink].off .second{visibility:hidden}"
         ".viewer .bar{display:flex;flex-wrap:wrap;gap:.3em .6em;align-items:center;font-size:.85em;color:#5c6670}"
         ".viewer .bar .ramp{width:16em;height:.9em;background:linear-gradient(to right" +
         gradient() + ")}@media(max-width:600px){.viewer[data-mode=beside] .panes{grid-auto-flow:row}}";
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
