#ifndef CANDELA_SHARED_TRANSPARENCY_H
#define CANDELA_SHARED_TRANSPARENCY_H
#include "shared/types.h"
SHARED_BEGIN
struct SumsPush {     // of a triangle that lays sums of blended surfaces over the picture
  uint sum, covered;  // places of the images
  uint sample_number;
};

struct PhenomenologicalPush {               // of the same where what is behind is moved and blurred
  uint sum, covered, widths, moved, color;  // places of the images
  uint images;                              // of REFRACTION_IMAGES
  uint sample_number;
};

// A blended surface in a pixel. Pixels are numbered by quads of 2x2, row by row, whose four follow each other.
struct StoredFragment {
  vec4 radiance;         // premultiplied, pre-exposed
  float depth;           // reversed, at the middle of the pixel
  vec2 slope;            // its change from pixel to pixel
  uint item, primitive;  // which of the frame, in the order of drawing
  uint covers;           // samples, by bits
};

// The words of the buffer of cells: the fragments of a round (a quad is of the round in which its first lies), those of
// the picture, the most of a quad, and one unused; then, for each pixel, how many fragments it has, and how many are
// stored; for each quad where its fragments begin, as if all were stored at once; and sums by group of quads.
struct FragmentsPush {
  uint64_t cells, stored, order, blended, counts, rounds, report;
  uvec2 size_px;
  uint room, round_number, most_rounds, runs;
  uint color;  // place of the image
  uint sample_number;
};
struct FragmentsReport {
  uint total, most;
};
SHARED_END
#ifdef __cplusplus
namespace candela::shared {
inline constexpr uint fragments_group = 256;                  // threads
inline constexpr uint fragments_quads = 4 * fragments_group;  // of a group
inline constexpr uint fragments_held = 0x7fffffffu;           // beyond, sums stay here
static_assert(sizeof(StoredFragment) == 40 && sizeof(FragmentsPush) <= 128);
}  // namespace candela::shared
#else
const uint fragments_group = 256u, fragments_quads = 4u * fragments_group, fragments_held = 0x7fffffffu;
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer CellWordsRef { uint w[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer StoredRef { StoredFragment f[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer OrderRef { uint i[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer BlendedRef { vec4 c[]; };

// Where the parts of the cells' words begin, for a picture of a size.
uint quads_across(uvec2 size_px) { return (size_px.x + 1u) / 2u; }
uint quad_count(uvec2 size_px) { return quads_across(size_px) * ((size_px.y + 1u) / 2u); }
uint pixel_number(uvec2 p, uvec2 size_px) {
  return 4u * (p.y / 2u * quads_across(size_px) + p.x / 2u) + 2u * (p.y & 1u) + (p.x & 1u);
}
const uint first_count = 4u;
uint first_cursor(uvec2 size_px) { return first_count + 4u * quad_count(size_px); }
uint first_offset(uvec2 size_px) { return first_count + 8u * quad_count(size_px); }
uint first_sum(uvec2 size_px) { return first_count + 9u * quad_count(size_px); }
#endif
#endif
