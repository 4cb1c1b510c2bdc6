#include "report/markup.h"

#include <fmt/format.h>

namespace candela {
namespace {

constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

}  // namespace

std::string escape_markup(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        if (uint8_t(c) < 0x20 && c != '\n' && c != '\t')
          result += "\xef\xbf\xbd";
        else
          result += c;
    }
  }
  return result;
}

std::string base64(std::span<const std::byte> bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k) group = group << 8 | (i + k < bytes.size() ? uint32_t(bytes[i + k]) : 0);
    for (size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::vector<std::byte> from_base64(std::string_view text) {
  while (text.ends_with('=')) text.remove_suffix(1);
  std::vector<std::byte> bytes;
  uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const size_t digit = std::string_view(digits).find(c);
    if (digit == std::string_view::npos) return {};
    bits = bits << 6 | uint32_t(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(std::byte(bits >> count & 0xff));
  }
  return bytes;
}

std::string data_url(std::span<const std::byte> png) { return "data:image/png;base64," + base64(png); }

TableCell text_cell(std::string text) { return {std::move(text), TableCell::Kind::text}; }

std::string html_table(const std::vector<std::string>& head, size_t text_columns,
                       const std::vector<std::vector<TableCell>>& rows) {
  static constexpr std::string_view classes[] = {"", " class=\"text\"", " class=\"bad\""};
  std::string html = "<div class=\"wide\"><table>\n<tr>";
  for (size_t i = 0; i < head.size(); ++i)
    html += fmt::format(
        "<th{}>{}</th>",
        i < text_columns || (!rows.empty() && rows[0][i].kind == TableCell::Kind::text) ? " class=\"text\"" : "",
        escape_markup(head[i]));
  html += "</tr>\n";
  for (const auto& row : rows) {
    html += "<tr>";
    for (const TableCell& cell : row)
      html += fmt::format("<td{}>{}</td>", classes[size_t(cell.kind)], escape_markup(cell.text));
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

std::string folded(const std::string& summary, const std::string& html) {
  if (html.empty()) return html;
  return "<details><summary>" + escape_markup(summary) + "</summary>\n" + html + "</details>\n";
}

std::string notes_html(const std::vector<std::string>& notes) {
  return folded(fmt::format("Notes ({})", notes.size()), list_html(notes, "note"));
}

std::string list_html(const std::vector<std::string>& sentences, std::string_view css_class) {
  if (sentences.empty()) return {};
  std::string html = css_class.empty() ? "<ul>\n" : fmt::format("<ul class=\"{}\">\n", css_class);
  for (const std::string& sentence : sentences) html += "<li>" + escape_markup(sentence) + "</li>\n";
  return html + "</ul>\n";
}

}  // namespace candela
