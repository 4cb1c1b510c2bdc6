#pragma once
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace candela {

// A value that may be there; one that is not keeps its memory for the next.
template <class T>
class Reused {
 public:
  // There from now on, as whoever had it left it.
  T& emplace() { return there_ = true, value_; }
  void reset() { there_ = false; }
  explicit operator bool() const { return there_; }
  T& operator*() { return value_; }
  const T& operator*() const { return value_; }
  T* operator->() { return &value_; }
  const T* operator->() const { return &value_; }

 private:
  T value_{};
  bool there_ = false;
};

// Lines of text, whose memory serves the next frame's.
class Notes {
 public:
  template <class... Args>
  void add(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(next()), format, std::forward<Args>(args)...);
  }
  // More of the last line.
  template <class... Args>
  void extend(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(lines_[count_ - 1]), format, std::forward<Args>(args)...);
  }
  void push_back(std::string_view line) { next() = line; }
  template <class Lines>
  void append(const Lines& lines) {
    for (const std::string& line : lines) push_back(line);
  }
  // A new line, empty.
  std::string& next() {
    if (count_ == lines_.size()) lines_.emplace_back();
    lines_[count_].clear();
    return lines_[count_++];
  }
  void clear() { count_ = 0; }
  size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  auto begin() const { return lines_.begin(); }
  auto end() const { return lines_.begin() + std::ptrdiff_t(count_); }
  const std::string& front() const { return lines_.front(); }
  const std::string& operator[](size_t i) const { return lines_[i]; }

 private:
  std::vector<std::string> lines_;
  size_t count_ = 0;
};

}  // namespace candela
