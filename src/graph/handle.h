#pragma once
namespace candela {

// Versioned names of a graph's resources. write() returns a new version and the old one goes stale, so that a wrong
// order is refused while declaring. Empty means absent: the producing pass was left out.
struct ImageHandle {
  int resource = -1, version = 0;
  explicit operator bool() const { return resource >= 0; }
  bool operator==(const ImageHandle&) const = default;
};
struct BufferHandle {
  int resource = -1, version = 0;
  explicit operator bool() const { return resource >= 0; }
  bool operator==(const BufferHandle&) const = default;
};

}  // namespace candela
