#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace candela {

// Text for HTML and XML, in elements and in quoted attributes; control characters that XML forbids become U+FFFD.
std::string escape_markup(std::string_view text);

// RFC 4648, with padding.
std::string base64(std::span<const std::byte> bytes);
// What base64 made; empty where it is none of it.
std::vector<std::byte> from_base64(std::string_view text);
std::string data_url(std::span<const std::byte> png);  // a picture inside a page

// A table that scrolls by itself where the page is too narrow. Numbers stand right, text left.
struct TableCell {
  std::string text;
  enum class Kind { number, text, bad } kind = Kind::number;  // bad: in red
};
TableCell text_cell(std::string text);
std::string html_table(const std::vector<std::string>& head, size_t text_columns,
                       const std::vector<std::vector<TableCell>>& rows);

// Folded: what was found stands before what was noted on the way. Empty without content.
std::string folded(const std::string& summary, const std::string& html);
std::string notes_html(const std::vector<std::string>& notes);
// Sentences as a list; empty without any.
std::string list_html(const std::vector<std::string>& sentences, std::string_view css_class = "");

}  // namespace candela
