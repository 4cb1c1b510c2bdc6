// The table of sheen's albedo that shaders read, against the reference's double integral.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reference/sheen.h"
#include "shared/sheen_albedo.h"

namespace candela::reference {
namespace {

constexpr int columns = shared::sheen_albedo_columns, rows = shared::sheen_albedo_rows;

double roughness_of(double row) {
  const double y = row / (rows - 1);
  return least_sheen_roughness + (1 - least_sheen_roughness) * y * y;
}
double cosine_of(double column) {
  const double least = std::pow(double(shared::least_sheen_cosine), 0.25);
  return std::pow(least + (1 - least) * column / (columns - 1), 4);
}
double entry(int row, int column) {
  const int at = row * columns + column;
  const uint32_t word = shared::sheen_albedo_words[at / 2];
  return shared::sheen_albedo_most * double(at % 2 ? word >> 16 : word & 0xffffu) / 65535;
}
// As lib/lobes.glsl reads it: the polynomials of third degree through four rows and four columns.
double interpolated(double row, double column) {
  const int r = std::clamp(int(row) - 1, 0, rows - 4), c = std::clamp(int(column) - 1, 0, columns - 4);
  const auto weight = [](double at, int node) {
    double product = 1;
    for (int other = 0; other < 4; ++other)
      if (other != node) product *= (at - other) / (node - other);
    return product;
  };
  double sum = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) sum += weight(row - r, i) * weight(column - c, j) * entry(r + i, c + j);
  return std::max(sum, 0.0);
}

}  // namespace

TEST(SheenAlbedo, TheTableIsTheIntegral) {
  EXPECT_FLOAT_EQ(shared::least_sheen_roughness, float(least_sheen_roughness));
  double worst = 0;
  std::string made;
  for (int at = 0; at < rows * columns; at += 2) {
    uint32_t word = 0;
    for (int i = 0; i < 2; ++i) {
      const int row = (at + i) / columns, column = (at + i) % columns;
      const double exact = integrate_sheen(roughness_of(row), cosine_of(column), 240);
      word |= uint32_t(std::lround(exact / shared::sheen_albedo_most * 65535)) << (16 * i);
      worst = std::max(worst, std::abs(entry(row, column) - exact));
    }
    made += fmt::format("{}0x{:08x}u,", at % 16 == 0 ? "\n    " : " ", word);
  }
  EXPECT_LT(worst, 1e-4) << "shaders/shared/sheen_albedo.h should hold" << made;
}

// Cut at 1, as it is used.
TEST(SheenAlbedo, BetweenItsPlacesTheTableIsNearTheIntegral) {
  double worst = 0, sum = 0;
  int count = 0;
  for (double row = 0.5; row < rows - 1; row += 1.25)
    for (double column = 0.5; column < columns - 1; column += 1.25, ++count) {
      const double exact = integrate_sheen(roughness_of(row), cosine_of(column), 128);
      const double error = std::abs(std::min(interpolated(row, column), 1.0) - std::min(exact, 1.0));
      worst = std::max(worst, error), sum += error;
    }
  EXPECT_LT(worst, 0.001);
  EXPECT_LT(sum / count, 0.0001);
}

}  // namespace candela::reference
