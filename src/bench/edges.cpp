#include "bench/edges.h"

#include <algorithm>

namespace candela {

const std::vector<std::string>& edge_layers() {
  static const std::vector<std::string> names = {"object_id", "material_id", "normal"};
  return names;
}

Edges::Edges(const FloatImage& image) : width_(image.width), height_(image.height) {
  for (const char* name : {"object_id.X", "material_id.X"})
    if (const Channel* ids = image.find(name)) ids_.push_back(&ids->u);
  for (const char* name : {"normal.X", "normal.Y", "normal.Z"})
    if (const Channel* part = image.find(name)) normal_.push_back(&part->f);
}

bool Edges::at(int x, int y) const {
  const size_t here = index(x, y);
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, height_ - 1); ++j)
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, width_ - 1); ++i)
      if (differ(here, index(i, j))) return true;
  return false;
}

bool Edges::differ(size_t a, size_t b) const {
  for (const std::vector<uint32_t>* ids : ids_)
    if ((*ids)[a] != (*ids)[b]) return true;
  double dot = 0, of_a = 0;
  for (const std::vector<float>* n : normal_)
    dot += double((*n)[a]) * double((*n)[b]), of_a += double((*n)[a]) * double((*n)[a]);
  constexpr double least_cosine = 0.8660254;  // of 30 degrees
  return of_a > 0 && dot < least_cosine;
}

}  // namespace candela
