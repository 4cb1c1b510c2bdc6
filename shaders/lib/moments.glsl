#pragma once
// Moments of what is absorbed along a ray, and the transmittance that they tell (Muenstermann et al. 2018; the bound by
// Peters and Klein, "Moment Shadow Mapping", 2015), of lib/warped_depth.glsl. MOMENTS: how many, even.
#include "lib/absorbance.glsl"
#include "lib/warped_depth.glsl"
#ifndef MOMENTS
#define MOMENTS 4
#endif
const int moment_roots = MOMENTS / 2;

const float overestimation = 0.25;

// The fraction of a ray's absorbance that lies before a depth z: between the least and the most that moments allow, by
// `overestimation`. m: moments from the first, of absorbance 1.
#if MOMENTS == 4
// As below, written out: CPU devices keep no array in registers.
float absorbed_before(vec4 m, float z) {
  const vec4 b = mix(m, vec4(0.0, 0.375, 0.0, 0.375), 5e-7);
  const float d1 = max(b.y - b.x * b.x, 1e-12), l21 = (b.z - b.x * b.y) / d1;
  const float d2 = max(b.w - b.y * b.y - l21 * l21 * d1, 1e-12);
  const float c1 = (z - b.x) / d1, c2 = (z * z - b.y - l21 * (z - b.x)) / d2;
  const vec3 c = vec3(1.0 - b.x * (c1 - l21 * c2) - b.y * c2, c1 - l21 * c2, c2);
  const float p = -0.5 * c.y, root = sqrt(max(p * p - c.x * c.z, 0.0)), q = p < 0.0 ? p - root : p + root;
  const float x1 = q / (abs(c.z) > 1e-30 ? c.z : 1e-30), x2 = c.x / (abs(q) > 1e-30 ? q : 1e-30);
  const float f1 = x1 < z ? 1.0 : 0.0, f2 = x2 < z ? 1.0 : 0.0;
  const float apart1 = x1 - z, apart2 = x2 - x1, apart3 = x2 - z;
  const float f01 = (f1 - overestimation) / (abs(apart1) > 1e-12 ? apart1 : 1e-12);
  const float f12 = (f2 - f1) / (abs(apart2) > 1e-12 ? apart2 : 1e-12);
  const float f012 = (f12 - f01) / (abs(apart3) > 1e-12 ? apart3 : 1e-12);
  const float mean = overestimation + f01 * (b.x - z) + f012 * (b.y - (z + x1) * b.x + z * x1);
  return mean >= 0.0 ? min(mean, 1.0) : 0.0;  // no number is 0 too
}
#else
// The root of a polynomial between two places, by steps of Newton that never leave them; the nearer place where it lies
// beyond one.
float root_between(float c[moment_roots + 1], int degree, float low, float high) {
  float at_low = c[degree], at_high = c[degree];
  for (int k = degree - 1; k >= 0; --k) {
    at_low = at_low * low + c[k];
    at_high = at_high * high + c[k];
  }
  if ((at_low < 0.0) == (at_high < 0.0)) return abs(at_low) < abs(at_high) ? low : high;
  float x = 0.5 * (low + high);
  for (int i = 0; i < 16; ++i) {
    float p = c[degree], slope = 0.0;
    for (int k = degree - 1; k >= 0; --k) {
      slope = slope * x + p;
      p = p * x + c[k];
    }
    if ((p < 0.0) == (at_low < 0.0)) low = x;
    else high = x;
    const float next = x - p / slope;
    x = next > low && next < high ? next : 0.5 * (low + high);
  }
  return x;
}

// The roots of the polynomial c, all real, in ascending order: between those of its derivative.
void polynomial_roots(float c[moment_roots + 1], out float roots[moment_roots]) {
  const float beyond = 16.0;  // more than any root that carries weight
  for (int i = 0; i < moment_roots; ++i) roots[i] = beyond;
  for (int degree = 1; degree <= moment_roots; ++degree) {
    // The derivative of order moment_roots - degree, up to a factor that keeps its numbers small.
    float d[moment_roots + 1];
    for (int k = 0; k <= degree; ++k) {
      float factor = 1.0;
      for (int j = 1; j <= moment_roots - degree; ++j) factor *= float(k + j) / float(j);
      d[k] = c[k + moment_roots - degree] * factor;
    }
    float before = -beyond, next[moment_roots];
    for (int i = 0; i < degree; ++i) {
      const float after = i + 1 < degree ? roots[i] : beyond;
      next[i] = root_between(d, degree, before, after);
      before = after;
    }
    for (int i = 0; i < degree; ++i) roots[i] = next[i];
  }
}

float absorbed_before(float m[MOMENTS + 1], float z) {
#if MOMENTS == 6
  const float bias = 5e-5, even[] = float[](0.48, 0.451, 0.45);
#else
  const float bias = 5e-5, even[] = float[](0.75, 0.67666667, 0.63, 0.60030303);
#endif
  // Towards the moments of an even spread, so that the matrix is regular for a single layer too: by more than the
  // paper's 5e-6 for six, which is lost in the rounding of 32-bit sums of three sheets.
  m[0] = 1.0;
  for (int k = 1; k <= MOMENTS; ++k) m[k] = mix(m[k], k % 2 == 0 ? even[k / 2 - 1] : 0.0, bias);
  // The Hankel matrix of moments, times c, is (1, z, z^2, ...): by Cholesky's L D L^T.
  float l[moment_roots + 1][moment_roots + 1], d[moment_roots + 1], c[moment_roots + 1];
  for (int i = 0; i <= moment_roots; ++i)
    for (int j = 0; j <= i; ++j) {
      float v = m[i + j];
      for (int k = 0; k < j; ++k) v -= l[i][k] * l[j][k] * d[k];
      if (i == j) d[i] = max(v, 1e-12);
      else l[i][j] = v / d[j];
    }
  float power = 1.0;
  for (int i = 0; i <= moment_roots; ++i) {
    c[i] = power;
    for (int k = 0; k < i; ++k) c[i] -= l[i][k] * c[k];
    power *= z;
  }
  for (int i = 0; i <= moment_roots; ++i) c[i] /= d[i];
  for (int i = moment_roots - 1; i >= 0; --i)
    for (int k = i + 1; k <= moment_roots; ++k) c[i] -= l[k][i] * c[k];
  // What lies at z and at the roots of c, and has these moments. Newton's polynomial is 1 at roots before z, 0 behind,
  // the overestimation at z, and the moments say its mean.
  float x[moment_roots + 1], f[moment_roots + 1];
  float roots[moment_roots];
  polynomial_roots(c, roots);
  for (int i = 0; i < moment_roots; ++i) x[i + 1] = roots[i];
  x[0] = z;
  f[0] = overestimation;
  for (int i = 1; i <= moment_roots; ++i) f[i] = x[i] < z ? 1.0 : 0.0;
  for (int j = 1; j <= moment_roots; ++j)
    for (int i = moment_roots; i >= j; --i) {
      const float apart = x[i] - x[i - j];
      f[i] = (f[i] - f[i - 1]) / (abs(apart) > 1e-12 ? apart : 1e-12);
    }
  float polynomial[moment_roots + 1];
  for (int i = 0; i <= moment_roots; ++i) polynomial[i] = 0.0;
  polynomial[0] = f[moment_roots];
  for (int i = moment_roots - 1; i >= 0; --i) {
    for (int k = moment_roots - i; k > 0; --k) polynomial[k] = polynomial[k - 1] - x[i] * polynomial[k];
    polynomial[0] = f[i] - x[i] * polynomial[0];
  }
  float mean = 0.0;
  for (int k = 0; k <= moment_roots; ++k) mean += polynomial[k] * m[k];
  return mean >= 0.0 ? min(mean, 1.0) : 0.0;  // no number is 0 too
}
#endif
