#pragma once
#include <vector>

#include "reference/film.h"
#include "reference/world.h"

namespace candela::reference {

// How many leaf boxes of the acceleration structure the line of sight through each pixel's centre crosses, whatever
// hides them: where many overlap, rays do work in vain.
std::vector<float> leaf_counts(const World& world, const Film& film);

}  // namespace candela::reference
