#pragma once
// What a surface that hides a fraction of what is behind absorbs, -ln(1 - share): sums of it are those of all
// surfaces, in any order. By series where the difference from 1 has few digits.
const float full_absorbance = 16.6;  // of all light; the last float below full coverage has 16.63

float absorbance_of(float covered) {
  if (covered < 0.02) return covered * (1.0 + covered * (0.5 + covered * (1.0 / 3.0 + covered * 0.25)));
  return -log(max(1.0 - covered, 5.9604645e-8));
}
float covered_by(float absorbance) {
  if (absorbance < 0.02)
    return absorbance * (1.0 - absorbance * (0.5 - absorbance * (1.0 / 6.0 - absorbance * (1.0 / 24.0))));
  return absorbance < full_absorbance ? 1.0 - exp(-absorbance) : 1.0;
}
