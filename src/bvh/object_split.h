#pragma once
#include "bvh/build_box.h"

namespace candela {

// Puts doubled centres into buckets between their bounds, on all three axes at once.
class Buckets {
 public:
  Buckets(const BuildBox& centres2, int buckets);
  bool usable(int axis) const { return scale_[axis] > 0; }
  int count() const { return buckets_; }
  void of(F4 centre2, int32_t (&bucket)[4]) const {
    to_ints(max(min((centre2 - low4_) * scale4_, last4_), F4::all(0)), bucket);
  }

 private:
  F4 low4_, scale4_, last4_;
  float scale_[4];
  int buckets_;
};

struct ObjectSplit {
  int axis = -1;                                        // -1: none (all centres are one point)
  int bucket = 0;                                       // the first one on the right side
  float cost = std::numeric_limits<float>::infinity();  // sum of half area times tests over both sides
  float overlap = 0;                                    // half area of the sides' common box; 0: none
};
// The best of all axes and bucket borders; ties: the first axis and border. overlap is made only on request.
ObjectSplit find_object_split(Span references, const Buckets& buckets, uint32_t block_shift, bool with_overlap);

}  // namespace candela
