#pragma once
#include <string>
#include <utility>
#include <vector>

namespace candela {

struct PageFinding {
  std::string text;
  bool wrong = false;  // in red
};

// What every report begins with: title, findings, what was measured where and with which program, and a picture of the
// scene. Facts without text are left out.
struct PageHead {
  std::string title;
  std::vector<PageFinding> findings;
  std::vector<std::pair<std::string, std::string>> facts;
  std::string picture;  // HTML (Figures::add_picture), or a sentence that says why there is none; may be empty
};

// One HTML page of the style that all reports have, without other files. body: HTML. style, script: what the page needs
// beside.
std::string page_html(const PageHead& head, const std::string& body, const std::string& style = "",
                      std::string_view script = "");

// "candela 0.1.0, commit gabcdef"; says so where the commit is not known.
std::string program_text(const std::string& version, const std::string& commit);

// Each once, joined by "; ".
std::string distinct(const std::vector<std::string>& texts);

}  // namespace candela
