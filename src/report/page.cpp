#include "report/page.h"

#include <fmt/format.h>

#include <algorithm>

#include "report/markup.h"

namespace candela {
namespace {

constexpr std::string_view page_style = R"css(
*{box-sizing:border-box}
body{font:16px/1.5 system-ui,"Segoe UI",Roboto,"DejaVu Sans",sans-serif;margin:0 auto;max-width:1200px;
padding:1.5em 1.2em 4em;
background:#fff;color:#1d2126;overflow-wrap:anywhere}
h1{font-size:1.7em;line-height:1.25;margin:0 0 .6em}
h2{font-size:1.3em;line-height:1.3;margin:2.2em 0 .6em;padding-top:.8em;border-top:1px solid #d5d9de}
h3{font-size:1.05em;margin:1.8em 0 .4em}
p{margin:.5em 0}ul{margin:.5em 0;padding-left:1.3em}li{margin:.25em 0}
.findings{font-size:1.1em;margin:0 0 1.2em;padding:.7em 1.1em;background:#eef4fa;
border-left:5px solid #0072b2}
.findings.faulty{background:#fdf1f2;border-color:#b00020}
.findings ul{margin:0}.wrong,.bad,.error{color:#b00020;font-weight:600}
.head{display:flex;flex-wrap:wrap;gap:1em 1.6em;align-items:flex-start}
.facts{flex:1 1 340px;display:grid;grid-template-columns:max-content minmax(0,1fr);gap:.15em 1em;
margin:0;font-size:.92em}
.facts dt{color:#5c6670}.facts dd{margin:0}
figure{margin:1em 0;max-width:100%}figcaption{font-size:.85em;color:#5c6670}
img{max-width:100%;height:auto}
figure.plot img{display:block;width:960px}
figure.picture{flex:0 1 auto;margin:0}figure.picture img{display:block;min-width:min(320px,100%)}
.pictures{display:flex;flex-wrap:wrap;gap:1em}.pictures figure{margin:0;flex:0 1 320px;min-width:0}
.pictures.small figure{flex:0 0 112px}.pictures.small img{width:112px;image-rendering:pixelated}
.thirds{display:flex;font-size:.85em;color:#5c6670}.thirds span{flex:1 1 0;min-width:0}
.strip img{display:block;width:100%}
.wide{overflow-x:auto;overflow-wrap:normal}
table{border-collapse:collapse;font-size:.86em;margin:.5em 0}
th,td{padding:.25em .75em;border-bottom:1px solid #e3e6ea;text-align:right;white-space:nowrap}
th{background:#f3f5f7;font-weight:600;white-space:normal;vertical-align:bottom}td.text,th.text{text-align:left}
tr.wrong td{color:#b00020}
.note{color:#7a5200}.faint{color:#5c6670}
details{margin:1em 0}summary{cursor:pointer;font-weight:600}
code{font-size:.9em}
@media(max-width:600px){body{padding:1em .8em 3em;font-size:15px}.facts{grid-template-columns:1fr}
.facts dt{margin-top:.4em}
.findings{padding:.6em .8em}th,td{padding:.25em .4em}td.text{white-space:normal;min-width:6em}}
@media print{details{display:none}h2{break-after:avoid}figure,tr{break-inside:avoid}}
)css";

}  // namespace

std::string page_html(const PageHead& head, const std::string& body, const std::string& style,
                      std::string_view script) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\"><title>{0}</title>\n<style>{1}{2}</style></head>\n"
      "<body>\n<h1>{0}</h1>\n",
      escape_markup(head.title), page_style, style);
  if (!head.findings.empty()) {
    const bool wrong =
        std::any_of(head.findings.begin(), head.findings.end(), [](const PageFinding& f) { return f.wrong; });
    html += fmt::format("<div class=\"findings{}\"><ul>\n", wrong ? " faulty" : "");
    for (const PageFinding& finding : head.findings)
      html += fmt::format("<li{}>{}</li>\n", finding.wrong ? " class=\"wrong\"" : "", escape_markup(finding.text));
    html += "</ul></div>\n";
  }
  html += "<div class=\"head\">\n<dl class=\"facts\">\n";
  for (const auto& [name, text] : head.facts)
    if (!text.empty()) html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escape_markup(name), escape_markup(text));
  html += "</dl>\n";
  if (head.picture.starts_with('<')) html += head.picture;
  html += "</div>\n";
  if (!head.picture.empty() && !head.picture.starts_with('<'))
    html += "<p class=\"faint\">" + escape_markup(head.picture) + "</p>\n";
  return html + body + std::string(script) + "</body>\n</html>\n";
}

std::string program_text(const std::string& version, const std::string& commit) {
  return fmt::format("candela {}, commit {}", version, commit.empty() ? "not recorded" : commit);
}

std::string distinct(const std::vector<std::string>& texts) {
  std::vector<std::string> seen;
  std::string joined;
  for (const std::string& text : texts) {
    if (text.empty() || std::find(seen.begin(), seen.end(), text) != seen.end()) continue;
    seen.push_back(text);
    joined += (joined.empty() ? "" : "; ") + text;
  }
  return joined;
}

}  // namespace candela
