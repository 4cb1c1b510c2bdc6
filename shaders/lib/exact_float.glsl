#pragma once
// Arithmetic on sums of two floats, which hold what doubles would (Dekker, "A Floating-Point Technique for Extending
// the Available Precision", 1971): devices need not have doubles. Nothing here may be contracted or reordered.

struct Pair {
  float high, low;  // |low| is at most half a unit in the last place of high
};

Pair exact_sum(float a, float b) {
  precise float high = a + b;
  precise float from_b = high - a;
  precise float low = (a - (high - from_b)) + (b - from_b);
  return Pair(high, low);
}
// Factors below 2^100.
Pair exact_product(float a, float b) {
  precise float high = a * b;
  precise float wide_a = 4097.0 * a;
  precise float wide_b = 4097.0 * b;
  precise float a1 = wide_a - (wide_a - a);
  precise float b1 = wide_b - (wide_b - b);
  precise float a2 = a - a1;
  precise float b2 = b - b1;
  precise float low = ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2;
  return Pair(high, low);
}
Pair pair_sum(Pair a, Pair b) {
  const Pair high = exact_sum(a.high, b.high), low = exact_sum(a.low, b.low);
  precise float rest = high.low + low.high;
  const Pair once = exact_sum(high.high, rest);
  precise float last = once.low + low.low;
  return exact_sum(once.high, last);
}
Pair pair_times(Pair a, float b) {
  const Pair high = exact_product(a.high, b);
  precise float low = high.low + a.low * b;
  return exact_sum(high.high, low);
}
// a b - c d.
Pair difference_of_products(float a, float b, float c, float d) {
  const Pair minus = exact_product(c, d);
  return pair_sum(exact_product(a, b), Pair(-minus.high, -minus.low));
}
// Rounded as a division in floats is; devices may be off by two units in the last place.
float rounded_quotient(float a, float b) {
  precise float q = a / b;
  const Pair product = exact_product(q, b);
  precise float rest = (a - product.high) - product.low;
  precise float better = q + rest / b;
  return abs(better) <= 3.4e38 ? better : q;  // not of factors too large to be split
}
