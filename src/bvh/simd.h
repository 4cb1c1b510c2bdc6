#pragma once
// Four, eight and sixteen floats at once, for the reference's builders and traversal: AVX-512, AVX2, SSE2 or plain C++,
// by what the including file is compiled for. Every operation but multiply_add() is one IEEE operation per lane (no
// approximate reciprocal), so all four give the same bits; multiply_add() rounds once or twice and is for bounds alone.
// min and max are x86's: the second operand where either is NaN. Each variant lives in a namespace of its own: inline
// functions of files compiled for AVX2 must never be the ones that the linker keeps for the rest of the program.
#include <bit>
#include <cstdint>

#if defined(__AVX512VL__) && !defined(CANDELA_SIMD_SCALAR)
#include <immintrin.h>
#define CANDELA_SIMD_NAME simd_avx512
#elif defined(__AVX2__) && !defined(CANDELA_SIMD_SCALAR)
#include <immintrin.h>
#define CANDELA_SIMD_NAME simd_avx2
#elif defined(__SSE2__) && !defined(CANDELA_SIMD_SCALAR)
#include <emmintrin.h>
#define CANDELA_SIMD_NAME simd_sse2
#else
#define CANDELA_SIMD_NAME simd_scalar
#endif

namespace candela::inline CANDELA_SIMD_NAME {

#if defined(__SSE2__) && !defined(CANDELA_SIMD_SCALAR)

struct F4 {
  __m128 v;
  static F4 load(const float* p) { return {_mm_loadu_ps(p)}; }
  static F4 load3(const float* p) {  // the fourth lane is 0
    const __m128 xy = _mm_castpd_ps(_mm_load_sd(reinterpret_cast<const double*>(p)));
    return {_mm_movelh_ps(xy, _mm_load_ss(p + 2))};
  }
  static F4 all(float x) { return {_mm_set1_ps(x)}; }
  static F4 one_lane(float others, int lane, float x) {
    static constexpr uint32_t ones = 0xffffffffu;
    alignas(16) static constexpr uint32_t masks[3][4] = {{ones, 0, 0, 0}, {0, ones, 0, 0}, {0, 0, ones, 0}};
    const __m128 mask = _mm_castsi128_ps(_mm_load_si128(reinterpret_cast<const __m128i*>(masks[lane])));
    return {_mm_or_ps(_mm_and_ps(mask, _mm_set1_ps(x)), _mm_andnot_ps(mask, _mm_set1_ps(others)))};
  }
  float largest3() const {  // of the first three lanes
    const __m128 y = _mm_shuffle_ps(v, v, _MM_SHUFFLE(1, 1, 1, 1)), z = _mm_movehl_ps(v, v);
    return _mm_cvtss_f32(_mm_max_ss(_mm_max_ss(v, y), z));
  }
  void store(float* p) const { _mm_storeu_ps(p, v); }
};
inline F4 operator+(F4 a, F4 b) { return {_mm_add_ps(a.v, b.v)}; }
inline F4 operator-(F4 a, F4 b) { return {_mm_sub_ps(a.v, b.v)}; }
inline F4 operator*(F4 a, F4 b) { return {_mm_mul_ps(a.v, b.v)}; }
inline F4 operator/(F4 a, F4 b) { return {_mm_div_ps(a.v, b.v)}; }
inline F4 min(F4 a, F4 b) { return {_mm_min_ps(a.v, b.v)}; }
inline F4 max(F4 a, F4 b) { return {_mm_max_ps(a.v, b.v)}; }
inline F4 absolute(F4 a) { return {_mm_andnot_ps(_mm_set1_ps(-0.0f), a.v)}; }
inline F4 operator|(F4 a, F4 b) { return {_mm_or_ps(a.v, b.v)}; }  // bit by bit
struct M4 {                                                        // of each lane, whether
  __m128 v;
  uint32_t bits() const { return uint32_t(_mm_movemask_ps(v)); }  // bit i is lane i
};
inline M4 operator&(M4 a, M4 b) { return {_mm_and_ps(a.v, b.v)}; }
inline M4 less(F4 a, F4 b) { return {_mm_cmplt_ps(a.v, b.v)}; }
inline M4 less_equal(F4 a, F4 b) { return {_mm_cmple_ps(a.v, b.v)}; }
inline uint32_t equal_ints(const uint32_t* p, uint32_t x) {
  const __m128i v = _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
  return uint32_t(_mm_movemask_ps(_mm_castsi128_ps(_mm_cmpeq_epi32(v, _mm_set1_epi32(int(x))))));
}
// Towards zero; the lanes must be within int's range.
inline void to_ints(F4 a, int32_t* out) { _mm_storeu_si128(reinterpret_cast<__m128i*>(out), _mm_cvttps_epi32(a.v)); }
inline void transpose(F4& a, F4& b, F4& c, F4& d) { _MM_TRANSPOSE4_PS(a.v, b.v, c.v, d.v); }
inline F4 without_lane_3(F4 a) { return {_mm_and_ps(a.v, _mm_castsi128_ps(_mm_set_epi32(0, -1, -1, -1)))}; }

#else

struct F4 {
  float v[4];
  static F4 load(const float* p) { return {{p[0], p[1], p[2], p[3]}}; }
  static F4 load3(const float* p) { return {{p[0], p[1], p[2], 0}}; }
  static F4 all(float x) { return {{x, x, x, x}}; }
  static F4 one_lane(float others, int lane, float x) {
    F4 r = all(others);
    r.v[lane] = x;
    return r;
  }
  float largest3() const {
    const float a = v[0] > v[1] ? v[0] : v[1];
    return a > v[2] ? a : v[2];
  }
  void store(float* p) const {
    for (int i = 0; i < 4; ++i) p[i] = v[i];
  }
};
template <class Operation>
F4 each(F4 a, F4 b, Operation operation) {
  F4 r;
  for (int i = 0; i < 4; ++i) r.v[i] = operation(a.v[i], b.v[i]);
  return r;
}
inline F4 operator|(F4 a, F4 b) {
  return each(a, b, [](float x, float y) {
    return std::bit_cast<float>(std::bit_cast<uint32_t>(x) | std::bit_cast<uint32_t>(y));
  });
}
struct M4 {
  uint32_t lanes;
  uint32_t bits() const { return lanes; }
};
inline M4 operator&(M4 a, M4 b) { return {a.lanes & b.lanes}; }
template <class Test>
M4 lanes(F4 a, F4 b, Test test) {
  uint32_t mask = 0;
  for (int i = 0; i < 4; ++i) mask |= uint32_t(test(a.v[i], b.v[i])) << i;
  return {mask};
}
inline F4 operator+(F4 a, F4 b) {
  return each(a, b, [](float x, float y) { return x + y; });
}
inline F4 operator-(F4 a, F4 b) {
  return each(a, b, [](float x, float y) { return x - y; });
}
inline F4 operator*(F4 a, F4 b) {
  return each(a, b, [](float x, float y) { return x * y; });
}
inline F4 operator/(F4 a, F4 b) {
  return each(a, b, [](float x, float y) { return x / y; });
}
inline F4 min(F4 a, F4 b) {
  return each(a, b, [](float x, float y) { return x < y ? x : y; });
}
inline F4 max(F4 a, F4 b) {
  return each(a, b, [](float x, float y) { return x > y ? x : y; });
}
inline F4 absolute(F4 a) {
  return each(a, a, [](float x, float) { return std::bit_cast<float>(std::bit_cast<uint32_t>(x) & 0x7fffffffu); });
}
inline M4 less(F4 a, F4 b) {
  return lanes(a, b, [](float x, float y) { return x < y; });
}
inline M4 less_equal(F4 a, F4 b) {
  return lanes(a, b, [](float x, float y) { return x <= y; });
}
inline uint32_t equal_ints(const uint32_t* p, uint32_t x) {
  uint32_t mask = 0;
  for (int i = 0; i < 4; ++i) mask |= uint32_t(p[i] == x) << i;
  return mask;
}
inline void to_ints(F4 a, int32_t* out) {
  for (int i = 0; i < 4; ++i) out[i] = int32_t(a.v[i]);
}
inline void transpose(F4& a, F4& b, F4& c, F4& d) {
  F4* const rows[4] = {&a, &b, &c, &d};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j) {
      const float kept = rows[i]->v[j];
      rows[i]->v[j] = rows[j]->v[i], rows[j]->v[i] = kept;
    }
}
inline F4 without_lane_3(F4 a) { return {{a.v[0], a.v[1], a.v[2], 0}}; }

#endif

// Comparisons of wider ones give the bits themselves.
inline uint32_t bits_of(M4 m) { return m.bits(); }
inline uint32_t bits_of(uint32_t bits) { return bits; }

#if defined(__AVX2__) && !defined(CANDELA_SIMD_SCALAR)

struct F8 {
  __m256 v;
  static F8 load(const float* p) { return {_mm256_load_ps(p)}; }  // p on 32 bytes
  static F8 all(float x) { return {_mm256_set1_ps(x)}; }
  void store(float* p) const { _mm256_store_ps(p, v); }
};
inline F8 operator+(F8 a, F8 b) { return {_mm256_add_ps(a.v, b.v)}; }
inline F8 operator-(F8 a, F8 b) { return {_mm256_sub_ps(a.v, b.v)}; }
inline F8 operator*(F8 a, F8 b) { return {_mm256_mul_ps(a.v, b.v)}; }
inline F8 operator/(F8 a, F8 b) { return {_mm256_div_ps(a.v, b.v)}; }
inline F8 min(F8 a, F8 b) { return {_mm256_min_ps(a.v, b.v)}; }
inline F8 max(F8 a, F8 b) { return {_mm256_max_ps(a.v, b.v)}; }
inline F8 absolute(F8 a) { return {_mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v)}; }
inline uint32_t less(F8 a, F8 b) { return uint32_t(_mm256_movemask_ps(_mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ))); }
inline uint32_t less_equal(F8 a, F8 b) { return uint32_t(_mm256_movemask_ps(_mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ))); }
inline F8 multiply_add(F8 a, F8 b, F8 c) { return {_mm256_fmadd_ps(a.v, b.v, c.v)}; }

#else

struct F8 {
  F4 a, b;
  static F8 load(const float* p) { return {F4::load(p), F4::load(p + 4)}; }
  static F8 all(float x) { return {F4::all(x), F4::all(x)}; }
  void store(float* p) const { a.store(p), b.store(p + 4); }
};
inline F8 operator+(F8 x, F8 y) { return {x.a + y.a, x.b + y.b}; }
inline F8 operator-(F8 x, F8 y) { return {x.a - y.a, x.b - y.b}; }
inline F8 operator*(F8 x, F8 y) { return {x.a * y.a, x.b * y.b}; }
inline F8 operator/(F8 x, F8 y) { return {x.a / y.a, x.b / y.b}; }
inline F8 multiply_add(F8 x, F8 y, F8 z) { return {x.a * y.a + z.a, x.b * y.b + z.b}; }
inline F8 min(F8 x, F8 y) { return {min(x.a, y.a), min(x.b, y.b)}; }
inline F8 max(F8 x, F8 y) { return {max(x.a, y.a), max(x.b, y.b)}; }
inline F8 absolute(F8 x) { return {absolute(x.a), absolute(x.b)}; }
inline uint32_t less(F8 x, F8 y) { return less(x.a, y.a).bits() | less(x.b, y.b).bits() << 4; }
inline uint32_t less_equal(F8 x, F8 y) { return less_equal(x.a, y.a).bits() | less_equal(x.b, y.b).bits() << 4; }

#endif

#if defined(__AVX512F__) && !defined(CANDELA_SIMD_SCALAR)

struct F16 {
  __m512 v;
  static F16 load(const float* p) { return {_mm512_load_ps(p)}; }  // p on 64 bytes
  static F16 all(float x) { return {_mm512_set1_ps(x)}; }
  void store(float* p) const { _mm512_store_ps(p, v); }
};
inline F16 operator+(F16 a, F16 b) { return {_mm512_add_ps(a.v, b.v)}; }
inline F16 operator-(F16 a, F16 b) { return {_mm512_sub_ps(a.v, b.v)}; }
inline F16 operator*(F16 a, F16 b) { return {_mm512_mul_ps(a.v, b.v)}; }
inline F16 operator/(F16 a, F16 b) { return {_mm512_div_ps(a.v, b.v)}; }
inline F16 multiply_add(F16 a, F16 b, F16 c) { return {_mm512_fmadd_ps(a.v, b.v, c.v)}; }
inline F16 min(F16 a, F16 b) { return {_mm512_min_ps(a.v, b.v)}; }
inline F16 max(F16 a, F16 b) { return {_mm512_max_ps(a.v, b.v)}; }
inline F16 absolute(F16 a) { return {_mm512_abs_ps(a.v)}; }
inline uint32_t less(F16 a, F16 b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ); }
inline uint32_t less_equal(F16 a, F16 b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LE_OQ); }
inline float least(F16 a) { return _mm512_reduce_min_ps(a.v); }
inline float largest(F16 a) { return _mm512_reduce_max_ps(a.v); }

#else

struct F16 {
  F8 a, b;
  static F16 load(const float* p) { return {F8::load(p), F8::load(p + 8)}; }
  static F16 all(float x) { return {F8::all(x), F8::all(x)}; }
  void store(float* p) const { a.store(p), b.store(p + 8); }
};
inline F16 operator+(F16 x, F16 y) { return {x.a + y.a, x.b + y.b}; }
inline F16 operator-(F16 x, F16 y) { return {x.a - y.a, x.b - y.b}; }
inline F16 operator*(F16 x, F16 y) { return {x.a * y.a, x.b * y.b}; }
inline F16 operator/(F16 x, F16 y) { return {x.a / y.a, x.b / y.b}; }
inline F16 multiply_add(F16 x, F16 y, F16 z) { return {multiply_add(x.a, y.a, z.a), multiply_add(x.b, y.b, z.b)}; }
inline F16 min(F16 x, F16 y) { return {min(x.a, y.a), min(x.b, y.b)}; }
inline F16 max(F16 x, F16 y) { return {max(x.a, y.a), max(x.b, y.b)}; }
inline F16 absolute(F16 x) { return {absolute(x.a), absolute(x.b)}; }
inline uint32_t less(F16 x, F16 y) { return less(x.a, y.a) | less(x.b, y.b) << 8; }
inline uint32_t less_equal(F16 x, F16 y) { return less_equal(x.a, y.a) | less_equal(x.b, y.b) << 8; }
inline float least(F16 x) {
  alignas(32) float lanes[8];
  min(x.a, x.b).store(lanes);
  const F4 four = min(F4::load(lanes), F4::load(lanes + 4));
  four.store(lanes);
  const float a = lanes[0] < lanes[1] ? lanes[0] : lanes[1], b = lanes[2] < lanes[3] ? lanes[2] : lanes[3];
  return a < b ? a : b;
}
inline float largest(F16 x) {
  alignas(32) float lanes[8];
  max(x.a, x.b).store(lanes);
  const F4 four = max(F4::load(lanes), F4::load(lanes + 4));
  four.store(lanes);
  const float a = lanes[0] > lanes[1] ? lanes[0] : lanes[1], b = lanes[2] > lanes[3] ? lanes[2] : lanes[3];
  return a > b ? a : b;
}

#endif

// clang-format off
}  // namespace candela::inline CANDELA_SIMD_NAME
// clang-format on
