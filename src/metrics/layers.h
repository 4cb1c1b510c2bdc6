#pragma once
#include <map>
#include <string>
#include <vector>

#include "image/image.h"
#include "metrics/numeric.h"

namespace candela {

// What a layer's values are decides what an error in it means.
//   ids      differing, and its fraction of the pixels; levels of Cryptomatte too, whose floats are bits
//   depth    relative difference |b-a|/|a| where both show a surface: depth-rel-mean, depth-rel-p99, depth-rel-max; and
//            one-sided, the pixels where only one image shows a surface
//   normals  angle in degrees where both have a normal: angle-mean, angle-p99, angle-max; and one-sided
//   values   the metrics of numeric.h
// All have differing.
struct LayerResult {
  std::string name;
  enum class Kind { ids, depth, normals, values } kind = Kind::values;
  std::map<std::string, double> metrics;
  Place max_at;
};
std::string_view layer_kind_name(LayerResult::Kind kind);

// "depth" of "depth.Z", the whole of "object_id", "" of R G B A Y.
std::string layer_of(const Channel& channel);

// A layer of Cryptomatte of which the images store different numbers of levels, two ranks each.
struct SharedLevels {
  std::string layer;
  int reference = 0, test = 0;
  int shared() const { return reference < test ? reference : test; }
};
// Takes the levels that one image alone has out of the other: a rank that is not stored says nothing of what it would
// hold. A layer without any level in one of the images stays.
std::vector<SharedLevels> keep_shared_levels(FloatImage& reference, FloatImage& test);

// Each layer that both images have whole, by name; beauty and the reference's variance are not among them.
std::vector<LayerResult> compare_layers(const FloatImage& reference, const FloatImage& test);

}  // namespace candela
