#pragma once
#include <algorithm>
#include <array>

namespace candela::reference {

// Four nodes of a table about a place (in nodes from the first) and their weights (Catmull and Rom 1974). Where one
// lies beyond the ends, it is the parabola's through the three next to it.
struct CubicWeights {
  CubicWeights(double at, int nodes) {
    const int cell = std::clamp(int(at), 0, nodes - 2);
    const double t = std::clamp(at - cell, 0.0, 1.0), t2 = t * t, t3 = t2 * t;
    weight = {(-t3 + 2 * t2 - t) / 2, (3 * t3 - 5 * t2 + 2) / 2, (-3 * t3 + 4 * t2 + t) / 2, (t3 - t2) / 2};
    first = std::clamp(cell - 1, 0, nodes - 4);
    const double w0 = weight[0], w3 = weight[3];
    if (cell == 0) weight = {weight[1] + 3 * w0, weight[2] - 3 * w0, w3 + w0, 0};
    if (cell == nodes - 2) weight = {0, w0 + w3, weight[1] - 3 * w3, weight[2] + 3 * w3};
  }
  std::array<double, 4> weight;
  int first;
};

}  // namespace candela::reference
