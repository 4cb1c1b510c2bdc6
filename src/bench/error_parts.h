#pragma once
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "bench/error_truth.h"
#include "bench/row.h"
#include "session/session.h"

namespace candela {

// Where in a picture an error lies: at edges, and off edges in which of the terms that beauty is the sum of.

// Layers that both renderers need for it: the terms, and what tells edges.
std::vector<std::string> gpu_part_layers();
std::vector<std::string> reference_part_layers(bool with_air);  // with the light of fog and of lamps in the air

// Relative squared errors of a picture against a reference with those layers, all over the square of the reference's
// beauty plus 0.01, as in relmse, so that they are of one scale:
//   part.edges   of beauty, at pixels where another object, another material or a normal turned by more than 30 degrees
//                is seen in the pixel or beside it
//   part.TERM    of that term, elsewhere; a term that the picture does not have counts as black
//   part.shadow.TERM, part.occlusion
//                of direct_sun, direct_point, direct_spot and of ambient_diffuse: what the fraction of light that
//                arrives (layers shadow, shadow_local, occlusion) gets wrong, times the term as it is unshadowed;
//                part.TERM is then of the rest. Without those layers nothing is shadowed. Of point and spot lights the
//                share is that of all lamps together
//   part.all     of beauty, everywhere
// Means over red, green and blue of all pixels. The terms' parts need not add up to the rest of part.all: errors of two
// terms may cancel each other. Empty where the reference has no such layers or the sizes differ.
std::map<std::string, double> error_parts(const FloatImage& reference, const FloatImage& picture);

// Adds the parts of a row's errors to their metrics: against the traced references, and against its technique's picture
// at quality exact, which comes before its others. jobs: one a row, without a scene where the row is not divided. After
// times are taken: layers would be in them.
void divide_errors(std::span<BenchRow> rows, std::span<const Job> jobs, double time_s, std::span<const Truth> truths,
                   const RunSettings& settings, const std::function<bool()>& stop);

// A job's frame with these layers, from a session of its own.
Expected<FloatImage> picture_with_parts(Job job, double time_s, const RunSettings& settings);

}  // namespace candela
