#pragma once
// What a surface that hides a share of what is behind absorbs, -ln(1 - share): sums of it are those of all surfaces, in
// any order. At most 16.6, the last float below full coverage. By series where the difference from 1 has few digits.
float absorbance_of(float covered) {
  return covered < 0.01 ? covered * (1.0 + covered * (0.5 + covered * (1.0 / 3.0 + covered * 0.25)))
      : -log(max(1.0 - covered, 5.9604645e-8));
}
float covered_by(float absorbance) {
  return absorbance < 0.01
      ? absorbance * (1.0 - absorbance * (0.5 - absorbance * (1.0 / 6.0 - absorbance * (1.0 / 24.0))))
      : 1.0 - exp(-absorbance);
}
