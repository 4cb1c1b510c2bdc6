#pragma once
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"

namespace candela {

// Numbers of frames in an order, none twice, as the ranges that they are: ten million of them take no more room than
// one.
class FrameList {
 public:
  FrameList() = default;
  FrameList(std::initializer_list<int64_t> frames);

  size_t size() const { return ranges_.empty() ? 0 : ranges_.back().before + ranges_.back().count; }
  bool empty() const { return ranges_.empty(); }
  int64_t operator[](size_t place) const;
  std::optional<size_t> place_of(int64_t frame) const;
  bool contains(int64_t frame) const { return place_of(frame).has_value(); }
  // Places first, first + step, first + 2 step, ...
  FrameList every(size_t step, size_t first) const;
  void add(int64_t first, uint64_t step, size_t count);  // those that are not in it yet

  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = int64_t;
    using difference_type = std::ptrdiff_t;
    using pointer = const int64_t*;
    using reference = int64_t;
    Iterator() = default;
    Iterator(const FrameList* list, size_t place) : list_(list), place_(place) {}
    int64_t operator*() const { return (*list_)[place_]; }
    Iterator& operator++() {
      ++place_;
      return *this;
    }
    Iterator operator++(int) {
      const Iterator before = *this;
      ++place_;
      return before;
    }
    bool operator==(const Iterator& other) const { return place_ == other.place_; }

   private:
    const FrameList* list_ = nullptr;
    size_t place_ = 0;
  };
  using value_type = int64_t;
  using const_iterator = Iterator;
  Iterator begin() const { return {this, 0}; }
  Iterator end() const { return {this, size()}; }
  bool operator==(const FrameList& other) const;

 private:
  struct Range {
    int64_t first = 0;
    uint64_t step = 1;
    size_t count = 0, before = 0;  // before: frames of earlier ranges
    int64_t at(size_t i) const { return int64_t(uint64_t(first) + uint64_t(i) * step); }
    int64_t last() const { return at(count - 1); }
    std::optional<size_t> place_of(int64_t frame) const;
  };
  void append(int64_t first, uint64_t step, size_t count);
  void append_one(int64_t frame);
  std::vector<Range> ranges_;
};

// Inclusive, as the field writes them: "0-249", "1-100x5", "2,4,10-20", "-5--1". In the order written, without
// duplicates.
Expected<FrameList> parse_frame_list(const std::string& text);

}  // namespace candela
