#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace candela {

// The figures of a page: drawn by gnuplot, put into the page as pictures, and kept as files of their own to stand
// beside it ("01-frame-time.svg" and its bytes, in the page's order), with the pictures of the scene among them.
class Figures {
 public:
  // draw: has_gnuplot(), or a page of tables alone.
  explicit Figures(bool draw) : draw_(draw) {}
  // The element of a page; a note where gnuplot failed; empty without a script or where nothing is drawn.
  std::string add(const std::string& title, const std::string& script, const std::string& caption = "");
  std::string add_picture(const std::string& title, std::span<const std::byte> png, const std::string& caption);

  bool draws() const { return draw_; }
  const std::vector<std::pair<std::string, std::string>>& files() const { return files_; }

 private:
  std::string file_name(const std::string& title, const char* ending) const;
  bool draw_;
  std::vector<std::pair<std::string, std::string>> files_;
};

}  // namespace candela
