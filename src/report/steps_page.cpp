#include "report/steps_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "graph/formats.h"
#include "report/markup.h"

namespace candela {
namespace {

constexpr std::string_view style = R"css(
:root{--back:#fff;--text:#1d2126;--faint:#5c6670;--line:#d5d9de;--card:#f5f7f9;--write:#0072b2;--read:#b85c00;
--bar:#56b4e9;--lane:#e3e8ed}
@media(prefers-color-scheme:dark){:root{--back:#15181c;--text:#e4e7ea;--faint:#9aa4ae;--line:#343b43;--card:#1d2227;
--write:#56b4e9;--read:#f0a04b;--bar:#2f7fb3;--lane:#2a3138}}
:root{color-scheme:light dark}
*{box-sizing:border-box}
body{font:16px/1.5 system-ui,"Segoe UI",Roboto,"DejaVu Sans",sans-serif;margin:0 auto;max-width:1280px;
padding:1.2em 1.2em 4em;background:var(--back);color:var(--text);overflow-wrap:anywhere}
h1{font-size:1.6em;line-height:1.25;margin:0 0 .5em}h2{font-size:1.25em;margin:1.8em 0 .5em}
h3{font-size:1.05em;margin:0;display:flex;flex-wrap:wrap;gap:.2em .8em;align-items:baseline}
a{color:inherit;text-decoration-color:var(--faint)}p{margin:.4em 0}
.facts{display:grid;grid-template-columns:max-content minmax(0,1fr);gap:.1em 1em;margin:0;font-size:.92em}
.facts dt{color:var(--faint)}.facts dd{margin:0}
.flow{overflow-x:auto;border:1px solid var(--line);border-radius:6px;background:var(--card)}
.flow svg{display:block;font:12px system-ui,"DejaVu Sans",sans-serif}
.flow text{fill:var(--text)}.flow .faint{fill:var(--faint)}.flow .lane{stroke:var(--lane)}
.flow .life{stroke:var(--faint)}
.flow .w{fill:var(--write)}.flow .r{fill:var(--card);stroke:var(--read);stroke-width:2}.flow .bar{fill:var(--bar)}
.key{font-size:.88em;color:var(--faint)}
.pass{border-left:3px solid var(--write);background:var(--card);border-radius:0 6px 6px 0;padding:.7em 1em;
margin:0 0 1.1em;position:relative}
.pass:not(:last-of-type)::after{content:"";position:absolute;left:-3px;bottom:-1.1em;height:1.1em;
border-left:3px solid var(--line)}
.pass .number{color:var(--faint);font-weight:400}.pass .ms{font-weight:400;color:var(--faint);font-size:.9em}
.uses{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,300px),1fr));gap:.2em 1.5em;font-size:.88em;
margin:.4em 0}
.uses ul{margin:.1em 0;padding-left:1.1em}.uses b{font-weight:600}.uses .reads b{color:var(--read)}
.uses .writes b{color:var(--write)}
.faint{color:var(--faint)}
.pictures{display:flex;flex-wrap:wrap;gap:.8em;align-items:flex-start}
.pictures figure{margin:0;flex:0 1 auto;max-width:100%}.pictures.many figure{flex:0 1 230px}
.pictures img{display:block;max-width:100%;height:auto;border:1px solid var(--line);image-rendering:pixelated}
.pictures.one img{max-height:540px;width:auto}
figcaption{font-size:.82em;color:var(--faint)}
table{border-collapse:collapse;font-size:.88em}td{padding:.15em .8em .15em 0;vertical-align:top}
td:first-child{white-space:nowrap}
details{margin:1em 0}summary{cursor:pointer;font-weight:600}
@media(max-width:600px){body{padding:.8em .7em 3em;font-size:15px}.facts{grid-template-columns:1fr}
.facts dt{margin-top:.3em}.pass{padding:.6em .7em}td:first-child{white-space:normal}}
)css";

struct Used {
  bool reads = false, writes = false;
};
// What each pass does to each resource.
using Uses = std::vector<std::map<int, Used>>;
Uses uses_of(const FramePlan& plan) {
  Uses all(plan.passes.size());
  for (size_t p = 0; p < plan.passes.size(); ++p)
    for (const PlanUse& use : plan.passes[p].uses)
      (use.writes ? all[p][use.resource].writes : all[p][use.resource].reads) = true;
  return all;
}

std::string bytes_text(uint64_t bytes) {
  if (bytes < 10240) return fmt::format("{} bytes", bytes);
  return bytes < (10ull << 20) ? fmt::format("{:.1f} KiB", double(bytes) / 1024)
                               : fmt::format("{:.1f} MiB", double(bytes) / 1048576);
}

std::string size_text(const PlanResource& resource) {
  if (!resource.is_image()) return bytes_text(std::get<BufferDesc>(resource.desc).size_bytes);
  const ImageDesc& image = std::get<ImageDesc>(resource.desc);
  std::string text = fmt::format("{} {}", image_size_text(image), format_name(image.format));
  if (image.samples > 1) text += fmt::format(", {} samples", image.samples);
  return text;
}

std::string ms_text(double ms) { return ms < 1000 ? fmt::format("{:.3g} ms", ms) : fmt::format("{:.0f} ms", ms); }

std::optional<double> ms_of(const StepsPage& page, const std::string& pass) {
  for (const gpu::PassTime& time : page.times)
    if (time.name == pass) return time.gpu_ms;
  return std::nullopt;
}

// Rows are passes, lanes what one leaves for another: a square where it is written, a ring where it is read.
std::string flow_svg(const StepsPage& page, const Uses& uses) {
  const FramePlan& plan = page.plan;
  std::vector<int> lanes;
  for (size_t r = 0; r < plan.resources.size(); ++r) {
    const bool written = std::ranges::any_of(uses, [&](const auto& of_pass) {
      const auto found = of_pass.find(int(r));
      return found != of_pass.end() && found->second.writes;
    });
    if (written) lanes.push_back(int(r));
  }
  std::ranges::stable_sort(lanes, {}, [&](int r) { return plan.resources[size_t(r)].first_pass; });
  constexpr int row = 22, lane = 17, left = 230, bar = 150, right = 70;
  size_t longest = 0;
  for (const int r : lanes) longest = std::max(longest, plan.resources[size_t(r)].name().size());
  const int top = 20 + int(double(longest) * 6.2), width = left + lane * int(lanes.size()) + 20 + bar + right;
  const int height = top + row * int(plan.passes.size()) + 12, bars = left + lane * int(lanes.size()) + 20;
  double most_ms = 0;
  for (const gpu::PassTime& time : page.times) most_ms = std::max(most_ms, time.gpu_ms);
  std::string svg = fmt::format(
      "<svg role=\"img\" aria-label=\"which pass writes and reads what\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 "
      "{0} "
      "{1}\">\n",
      width, height);
  const auto x_of = [&](size_t l) { return left + lane * int(l) + lane / 2; };
  const auto y_of = [&](size_t p) { return top + row * int(p) + row / 2; };
  for (size_t p = 0; p < plan.passes.size(); ++p)
    svg += fmt::format("<line class=\"lane\" x1=\"0\" x2=\"{}\" y1=\"{}\" y2=\"{}\"/>\n", width, y_of(p) + row / 2,
                       y_of(p) + row / 2);
  for (size_t l = 0; l < lanes.size(); ++l) {
    const PlanResource& resource = plan.resources[size_t(lanes[l])];
    svg += fmt::format("<text class=\"faint\" transform=\"translate({},{}) rotate(-90)\">{}</text>\n", x_of(l) + 4,
                       top - 6, escape_markup(resource.name()));
    svg += fmt::format("<line class=\"life\" x1=\"{0}\" x2=\"{0}\" y1=\"{1}\" y2=\"{2}\"/>\n", x_of(l),
                       y_of(size_t(resource.first_pass)), y_of(size_t(resource.last_pass)));
  }
  for (size_t p = 0; p < plan.passes.size(); ++p) {
    const std::string& name = plan.passes[p].name;
    svg += fmt::format("<a href=\"#pass{0}\"><text x=\"8\" y=\"{1}\">{0}. {2}</text></a>\n", p + 1, y_of(p) + 4,
                       escape_markup(name.size() > 30 ? name.substr(0, 29) + "…" : name));
    for (size_t l = 0; l < lanes.size(); ++l) {
      const auto use = uses[p].find(lanes[l]);
      if (use == uses[p].end()) continue;
      const std::string tip =
          fmt::format("<title>{} {} {}</title>", escape_markup(name), use->second.writes ? "writes" : "reads",
                      escape_markup(plan.resources[size_t(lanes[l])].name()));
      if (use->second.writes)
        svg += fmt::format("<rect class=\"w\" x=\"{}\" y=\"{}\" width=\"10\" height=\"10\">{}</rect>\n", x_of(l) - 5,
                           y_of(p) - 5, tip);
      else
        svg += fmt::format("<circle class=\"r\" cx=\"{}\" cy=\"{}\" r=\"4\">{}</circle>\n", x_of(l), y_of(p), tip);
    }
    if (const auto ms = ms_of(page, name)) {
      const double length = most_ms > 0 ? std::max(1.0, bar * *ms / most_ms) : 0;
      svg += fmt::format("<rect class=\"bar\" x=\"{}\" y=\"{}\" width=\"{:.1f}\" height=\"12\"/>\n", bars, y_of(p) - 6,
                         length);
      svg += fmt::format("<text class=\"faint\" x=\"{:.1f}\" y=\"{}\">{}</text>\n", bars + length + 4, y_of(p) + 4,
                         ms_text(*ms));
    }
  }
  return svg + "</svg>\n";
}

// The last pass before this that wrote it; absent: it was there before the frame.
std::optional<size_t> writer_before(const Uses& uses, size_t pass, int resource) {
  for (size_t p = pass; p-- > 0;)
    if (const auto use = uses[p].find(resource); use != uses[p].end() && use->second.writes) return p;
  return std::nullopt;
}

std::string uses_html(const StepsPage& page, const Uses& uses, size_t pass) {
  std::string reads, writes;
  for (const auto& [resource, use] : uses[pass]) {
    const PlanResource& r = page.plan.resources[size_t(resource)];
    const std::string text =
        fmt::format("{} <span class=\"faint\">{}</span>", escape_markup(r.name()), escape_markup(size_text(r)));
    if (use.writes) writes += "<li>" + text + "</li>";
    if (!use.reads) continue;
    const auto from = writer_before(uses, pass, resource);
    const std::string of =
        from ? fmt::format(" of <a href=\"#pass{}\">{}</a>", *from + 1, escape_markup(page.plan.passes[*from].name))
        : r.imported ? " <span class=\"faint\">of the scene</span>"
                     : " <span class=\"faint\">of its own steps</span>";
    reads += "<li>" + text + of + "</li>";
  }
  std::string html = "<div class=\"uses\">";
  if (!reads.empty()) html += "<div class=\"reads\"><b>reads</b><ul>" + reads + "</ul></div>";
  if (!writes.empty()) html += "<div class=\"writes\"><b>writes</b><ul>" + writes + "</ul></div>";
  return html + "</div>\n";
}

std::string pictures_html(const StepsPage& page, const std::string& pass) {
  std::vector<const StepPicture*> own;
  for (const StepPicture& picture : page.pictures)
    if (picture.pass == pass) own.push_back(&picture);
  if (own.empty()) return "<p class=\"faint\">Writes buffers alone.</p>\n";
  std::string html = fmt::format("<div class=\"pictures {}\">\n", own.size() == 1 ? "one" : "many");
  for (const StepPicture* p : own) {
    const std::string name = p->image + (p->part.empty() ? "" : ", " + p->part);
    html += fmt::format(
        "<figure><a href=\"{0}\"><img src=\"{0}\" width=\"{1}\" height=\"{2}\" loading=\"lazy\" "
        "alt=\"{3}\"></a><figcaption>{3}: {4}</figcaption></figure>\n",
        escape_markup(p->file), p->width, p->height, escape_markup(name), escape_markup(p->shows));
  }
  return html + "</div>\n";
}

std::string pass_html(const StepsPage& page, const Uses& uses, size_t p) {
  const PlanPass& pass = page.plan.passes[p];
  std::string time;
  if (const auto ms = ms_of(page, pass.name))
    time = fmt::format("{}{}", ms_text(*ms),
                       page.frame_ms > 0 ? fmt::format(", {:.1f} % of the frame", 100 * *ms / page.frame_ms) : "");
  if (pass.queue == Queue::compute) time += time.empty() ? "queue of compute" : ", queue of compute";
  std::string html = fmt::format(
      "<section class=\"pass\" id=\"pass{}\"><h3><span class=\"number\">{}</span> {} <span "
      "class=\"ms\">{}</span></h3>\n",
      p + 1, p + 1, escape_markup(pass.name), time);
  html += uses_html(page, uses, p) + pictures_html(page, pass.name);
  if (!pass.knobs.empty()) {
    std::string rows = "<table>";
    for (const PlanKnob& knob : pass.knobs)
      rows += fmt::format("<tr><td>{}</td><td>{}</td></tr>", escape_markup(knob.name), escape_markup(knob.value));
    html += fmt::format("<details><summary>{} knob{}</summary>{}</table></details>\n", pass.knobs.size(),
                        pass.knobs.size() == 1 ? "" : "s", rows);
  }
  return html + "</section>\n";
}

}  // namespace

std::string steps_page_html(const StepsPage& page) {
  const Uses uses = uses_of(page.plan);
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\"><title>{0}</title>\n<style>{1}</style></head>\n<body>\n<h1>{0}</"
      "h1>\n"
      "<dl class=\"facts\">\n",
      escape_markup(page.title), style);
  for (const auto& [name, text] : page.facts)
    if (!text.empty()) html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escape_markup(name), escape_markup(text));
  html +=
      "</dl>\n<h2>Flow of data</h2>\n<p class=\"key\">A row is a pass, from the first to the last; a lane is an image "
      "or "
      "a buffer that passes make. A square writes, a ring reads. Bars are times on the device.</p>\n<div "
      "class=\"flow\">";
  html += flow_svg(page, uses) + "</div>\n<h2>The frame as it grows</h2>\n";
  for (size_t p = 0; p < page.plan.passes.size(); ++p) html += pass_html(page, uses, p);
  html += fmt::format("<details><summary>{} passes left out</summary><table>\n", page.plan.left_out.size());
  for (const LeftOut& left : page.plan.left_out)
    html += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", escape_markup(left.pass), escape_markup(left.reason));
  return html + "</table></details>\n</body>\n</html>\n";
}

}  // namespace candela
