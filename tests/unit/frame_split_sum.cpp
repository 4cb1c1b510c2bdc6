#include "sky/split_sum.h"

#include <gtest/gtest.h>

#include "split_sum_integral.h"

namespace candela::frame_split_sum {
namespace {

using shared::split_sum_columns, shared::split_sum_rows;
using test::GaussRule, test::SplitSum;

double view_at(double column) { return std::pow(column / (split_sum_columns - 1), 2); }
double roughness_at(double row) {
  const double low = std::sqrt(shared::least_roughness);
  return std::pow(low + (1 - low) * row / (split_sum_rows - 1), 2);
}
SplitSum node(uint32_t column, uint32_t row) {
  const size_t at = 2 * (row * split_sum_columns + column);
  return {split_sum_table[at] / 65535.0, split_sum_table[at + 1] / 65535.0};
}
std::string table_text(const std::vector<int>& values) {
  std::string text;
  for (const int v : values) text += std::to_string(v) + ", ";
  return text;
}

}  // namespace

TEST(SplitSum, TheTableIsMadeAgain) {
  const GaussRule rule(32);
  std::vector<int> table, grazing;
  for (uint32_t row = 0; row < split_sum_rows; ++row)
    for (uint32_t column = 0; column < split_sum_columns; ++column) {
      const SplitSum s = test::split_sum_integral(roughness_at(row), std::max(view_at(column), 1e-4), rule);
      for (const double v : {s.scale, s.bias}) table.push_back(int(std::lround(v * 65535)));
    }
  for (uint32_t column = 0; column < split_sum_columns; ++column)
    grazing.push_back(int(std::lround(test::grazing_integral(view_at(column), rule) * 65535)));
  // By one only: the last bits of a sine differ between C libraries.
  int differing = 0;
  for (size_t i = 0; i < table.size(); ++i) differing += std::abs(table[i] - split_sum_table[i]) > 1;
  for (size_t i = 0; i < grazing.size(); ++i) differing += std::abs(grazing[i] - split_sum_grazing[i]) > 1;
  EXPECT_EQ(differing, 0) << "split_sum_table should be: " << table_text(table)
                          << "\nsplit_sum_grazing should be: " << table_text(grazing);
}

// Between its nodes, at the middle of its cells, where a bilinear table is worst.
TEST(SplitSum, TheTableIsNearItsIntegralBetweenItsNodes) {
  const GaussRule rule(24);
  double squares = 0, count = 0;
  for (uint32_t row = 0; row + 1 < split_sum_rows; row += 2)
    for (uint32_t column = row / 2 % 2; column + 1 < split_sum_columns; column += 2) {
      const double n_v = view_at(column + 0.5), roughness = roughness_at(row + 0.5);
      const SplitSum exact = test::split_sum_integral(roughness, n_v, rule);
      SplitSum between;
      for (const uint32_t dy : {0u, 1u})
        for (const uint32_t dx : {0u, 1u}) {
          const SplitSum n = node(column + dx, row + dy);
          between.scale += n.scale / 4, between.bias += n.bias / 4;
        }
      const bool grazing = n_v < 0.01;  // within 0.6 degrees
      EXPECT_NEAR(between.scale, exact.scale, grazing ? 0.009 : 0.002) << roughness << " " << n_v;
      EXPECT_NEAR(between.bias, exact.bias, grazing ? 0.009 : 0.004) << roughness << " " << n_v;
      squares += std::pow(between.scale + between.bias - exact.scale - exact.bias, 2);
      ++count;
    }
  EXPECT_LT(std::sqrt(squares / count), 1e-3);
}

TEST(SplitSum, EnergyIsNeitherMadeNorNegative) {
  for (uint32_t row = 0; row < split_sum_rows; ++row)
    for (uint32_t column = 0; column < split_sum_columns; ++column) {
      const SplitSum n = node(column, row);
      EXPECT_GT(n.scale, 0);
      EXPECT_GE(n.bias, 0);
      EXPECT_LE(n.scale + n.bias, 1 + 1 / 65535.0);
      // Schlick's term falls from grazing to normal incidence, beyond the dip that masking makes on smooth surfaces.
      if (view_at(column) > 0.1) EXPECT_LE(n.bias, node(column - 1, row).bias + 1 / 65535.0) << row << " " << column;
    }
  // Seen from above, the rougher a surface is, the more light bounces twice, which single scattering loses.
  constexpr uint32_t above = split_sum_columns - 1;
  for (uint32_t row = 1; row < split_sum_rows; ++row)
    EXPECT_LE(node(above, row).scale + node(above, row).bias, node(above, row - 1).scale + node(above, row - 1).bias);
  EXPECT_NEAR(node(above, 0).scale, 1, 1e-4);
  // With alpha 1 and v = n the integral of 2 x / (2 (1 + x)) over x = n.l has a closed form.
  const SplitSum rough = node(above, split_sum_rows - 1);
  EXPECT_NEAR(rough.scale + rough.bias, 1 - std::log(2.0), 3e-5);
}

}  // namespace candela::frame_split_sum
