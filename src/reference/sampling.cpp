#include "reference/sampling.h"

#include <cmath>
#include <numbers>

namespace candela::reference {
namespace {

// An integer hash with every output bit a function of every input bit.
uint32_t mixed(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ (x >> 16);
}
uint32_t combined(uint32_t seed, uint32_t value) {
  return mixed(seed ^ (mixed(value) + 0x9e3779b9u + (seed << 6) + (seed >> 2)));
}

uint32_t reversed_bits(uint32_t x) {
  x = (x << 16) | (x >> 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
  x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
  return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}
// Nested uniform scramble from the highest bit down: the permutation of Laine and Karras in Burley's constants, which
// lets each bit depend on lower ones only, run on the reversed number.
uint32_t owen_scrambled(uint32_t x, uint32_t seed) {
  x = reversed_bits(x);
  x += seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  x ^= x * 0x8d22f6e6u;
  return reversed_bits(x);
}

// Generator matrices of the first four Sobol dimensions, from the primitive polynomials and initial numbers of Joe and
// Kuo (2008).
struct SobolMatrices {
  uint32_t column[4][32];
  SobolMatrices() {
    constexpr struct {
      int degree;
      uint32_t coefficients, initial[3];
    } polynomials[3] = {{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}};
    for (int bit = 0; bit < 32; ++bit) column[0][bit] = 1u << (31 - bit);
    for (int d = 1; d < 4; ++d) {
      const auto& p = polynomials[d - 1];
      for (int bit = 0; bit < 32; ++bit) {
        if (bit < p.degree) {
          column[d][bit] = p.initial[bit] << (31 - bit);
          continue;
        }
        uint32_t v = column[d][bit - p.degree] ^ (column[d][bit - p.degree] >> p.degree);
        for (int k = 1; k < p.degree; ++k)
          if ((p.coefficients >> (p.degree - 1 - k)) & 1u) v ^= column[d][bit - k];
        column[d][bit] = v;
      }
    }
  }
};

// What each byte of an index adds to a number of each dimension.
struct SobolTables {
  uint32_t of[4][4][256] = {};
  SobolTables() {
    const SobolMatrices matrices;
    for (int d = 0; d < 4; ++d)
      for (int byte = 0; byte < 4; ++byte)
        for (int value = 0; value < 256; ++value)
          for (int bit = 0; bit < 8; ++bit)
            if (value >> bit & 1) of[d][byte][value] ^= matrices.column[d][8 * byte + bit];
  }
};
const SobolTables tables;

uint32_t sobol(uint32_t index, uint32_t dimension) {
  const auto& t = tables.of[dimension];
  return t[0][index & 255] ^ t[1][index >> 8 & 255] ^ t[2][index >> 16 & 255] ^ t[3][index >> 24];
}

double unit(uint32_t x) { return (double(x) + 0.5) * 0x1p-32; }

}  // namespace

std::optional<SamplerKind> sampler_from_name(std::string_view name) {
  if (name == "uniform") return SamplerKind::uniform;
  if (name == "jittered") return SamplerKind::jittered;
  if (name == "sobol") return SamplerKind::sobol;
  return std::nullopt;
}

glm::ivec2 grid_of(int spp) {
  int rows = 1;
  for (int r = 1; r * r <= spp; ++r)
    if (spp % r == 0) rows = r;
  return {spp / rows, rows};
}

SampleStream::SampleStream(const SamplerSettings& settings, int x, int y, uint64_t sample) {
  const uint32_t half = uint32_t(sample & 1);
  seed_ = combined(combined(combined(uint32_t(settings.seed), uint32_t(settings.seed >> 32) ^ half), uint32_t(x)),
                   uint32_t(y));
  index_ = uint32_t(sample >> 1);
  if (settings.kind == SamplerKind::sobol) {
    pixel_ = {value(0), value(1)};
    return;
  }
  const glm::ivec2 grid = grid_of(settings.spp);
  const int cell = int(sample % uint64_t(settings.spp));
  glm::dvec2 within(0.5);
  if (settings.kind == SamplerKind::jittered)
    within = {unit(combined(seed_, index_ * 2)), unit(combined(seed_, index_ * 2 + 1))};
  pixel_ = (glm::dvec2(cell % grid.x, cell / grid.x) + within) / glm::dvec2(grid);
}

double SampleStream::value(uint32_t dimension) const {
  const uint32_t group = combined(seed_, dimension / 4), within = dimension % 4;
  const uint32_t shuffled = owen_scrambled(index_, group);
  return unit(owen_scrambled(sobol(shuffled, within), combined(group, within)));
}

double SampleStream::next() { return value(dimension_++); }

glm::dvec2 SampleStream::next2() {
  if (dimension_ % 4 == 3) ++dimension_;  // both of one group
  const double a = next();
  return {a, next()};
}

void make_frame(glm::dvec3 n, glm::dvec3& x, glm::dvec3& y) {
  const double sign = std::copysign(1.0, n.z);
  const double a = -1 / (sign + n.z), b = n.x * n.y * a;
  x = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
  y = {b, sign + n.y * n.y * a, -n.y};
}

glm::dvec3 cosine_direction(glm::dvec3 n, glm::dvec2 u) {
  glm::dvec3 x, y;
  make_frame(n, x, y);
  const double r = std::sqrt(u.x), phi = 2 * std::numbers::pi * u.y;
  return glm::normalize(r * std::cos(phi) * x + r * std::sin(phi) * y + std::sqrt(std::max(1 - u.x, 0.0)) * n);
}

}  // namespace candela::reference
