#pragma once
#include <span>

namespace candela {

// Monotone pieces between values at ascending places: each stays between the two values at its ends (Fritsch and
// Carlson, "Monotone Piecewise Cubic Interpolation", 1980), and they meet with one slope. At a turning point it is 0,
// elsewhere the weighted harmonic mean of both sides' (Fritsch and Butland, "A Method for Constructing Local Monotone
// Piecewise Cubic Interpolants", 1984). i: the piece between place[i] and place[i + 1], within which x lies.
double monotone_cubic(std::span<const double> place, std::span<const double> value, size_t i, double x);

}  // namespace candela
