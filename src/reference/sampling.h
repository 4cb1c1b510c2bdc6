#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string_view>

// Where samples lie. Every number is a function of seed, pixel, sample and dimension alone: no thread, tile or earlier
// sample matters, so an image has the same bytes however its work is shared out.
namespace candela::reference {

enum class SamplerKind : uint8_t { uniform, jittered, sobol };
std::optional<SamplerKind> sampler_from_name(std::string_view name);

struct SamplerSettings {
  SamplerKind kind = SamplerKind::sobol;
  int spp = 16;  // the whole number: what uniform and jittered cut the pixel into
  uint64_t seed = 0;
};

// Columns and rows of the grid that uniform and jittered use: the most nearly square that gives spp cells, wider than
// high (x4: 2 by 2, x8: 4 by 2, x16: 4 by 4).
glm::ivec2 grid_of(int spp);

// The numbers of one sample of one pixel.
//
// uniform: centres of a grid of the pixel's cells; jittered: one point in each cell; both need spp. sobol:
// Owen-scrambled by hashes and shuffled, padded in groups of four dimensions (Burley, "Practical Hash-based Owen
// Scrambling", 2020); any count does. Every other dimension is of the Sobol kind whatever the pixel's is.
//
// Even and odd samples are scrambled independently of each other, so that the two halves of an image are two
// independent estimates: their difference tells the noise.
class SampleStream {
 public:
  SampleStream(const SamplerSettings& settings, int x, int y, uint64_t sample);

  glm::dvec2 pixel() const { return pixel_; }  // inside the pixel, [0, 1)^2, y down: a box filter one pixel wide
  // The dimension that follows; the same dimension is the same kind of choice in every sample, or stratification is
  // lost.
  void start(uint32_t dimension) { dimension_ = dimension; }
  double next();
  glm::dvec2 next2();
  // Numbers of dimensions that lie that much further on, for what is not in every picture: it takes none of the others.
  SampleStream apart(uint32_t dimensions) const {
    SampleStream s = *this;
    s.dimension_ += dimensions;
    return s;
  }

 private:
  double value(uint32_t dimension) const;

  uint32_t seed_, index_;
  uint32_t dimension_ = 4;  // the pixel takes the first group
  glm::dvec2 pixel_;
};

// A direction about unit n with density cos/pi, from two numbers in [0, 1).
glm::dvec3 cosine_direction(glm::dvec3 n, glm::dvec2 u);

// Two unit vectors that make a right-handed frame with unit n, without a singular direction (Duff et al., "Building an
// Orthonormal Basis, Revisited", 2017).
void make_frame(glm::dvec3 n, glm::dvec3& x, glm::dvec3& y);

}  // namespace candela::reference
