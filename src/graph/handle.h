#pragma once
namespace candela {

// Versioned names of a graph's resources. write() returns a new version and the old one goes stale, so that a wrong
// order is refused while declaring. Empty means absent: the producing pass was left out, and `absence` finds the reason
// (GraphBuilder::absences; -1: none was given).
struct ImageHandle {
  int resource = -1, version = 0, absence = -1;
  explicit operator bool() const { return resource >= 0; }
  bool operator==(const ImageHandle&) const = default;
};
struct BufferHandle {
  int resource = -1, version = 0, absence = -1;
  explicit operator bool() const { return resource >= 0; }
  bool operator==(const BufferHandle&) const = default;
};

}  // namespace candela
