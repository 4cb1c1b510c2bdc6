#pragma once
// Coverage as what adds up: -ln(1 - coverage), and back. Where 1 - c loses what is left of c by series.
const float full_absorbance = 16.6;  // 1 - e^-a is 1 from here on; the last float below full coverage has 16.63

float absorbance_of(float coverage) {
  if (coverage < 0.02) return coverage * (1.0 + coverage * (0.5 + coverage * (1.0 / 3.0 + coverage * 0.25)));
  return -log(max(1.0 - coverage, 5.9604645e-8));
}
float coverage_of(float absorbance) {
  if (absorbance < 0.02)
    return absorbance * (1.0 - absorbance * (0.5 - absorbance * (1.0 / 6.0 - absorbance * (1.0 / 24.0))));
  return absorbance < full_absorbance ? 1.0 - exp(-absorbance) : 1.0;
}
