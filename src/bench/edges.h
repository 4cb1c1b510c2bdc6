#pragma once
#include <cstdint>
#include <vector>

#include "image/image.h"

namespace candela {

// Pixels of a picture with the layers object_id, material_id and normal at which another object, another material or a
// normal turned by more than 30 degrees is seen in the pixel or beside it.
class Edges {
 public:
  explicit Edges(const FloatImage& image);
  bool known() const { return ids_.size() == 2 && normal_.size() == 3; }  // the image has those layers
  bool at(int x, int y) const;

 private:
  size_t index(int x, int y) const { return size_t(y) * size_t(width_) + size_t(x); }
  bool differ(size_t a, size_t b) const;

  int width_, height_;
  std::vector<const std::vector<uint32_t>*> ids_;
  std::vector<const std::vector<float>*> normal_;
};
// Layers that tell edges.
const std::vector<std::string>& edge_layers();

}  // namespace candela
