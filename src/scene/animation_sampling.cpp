#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "scene/pose.h"

// glTF 2.0, appendix C: interpolation of one animation sampler at one time, in double.
namespace candela {
namespace {

struct Keys {
  const AnimationChannel& channel;
  // One of the three parts of a cubic spline's key (0 in-tangent, 1 value, 2 out-tangent), or the value of another key.
  double at(size_t key, int part, int component) const {
    const size_t n = size_t(channel.components);
    if (channel.interpolation == Interpolation::cubic_spline)
      return channel.values[(key * 3 + size_t(part)) * n + size_t(component)];
    return channel.values[key * n + size_t(component)];
  }
  double value(size_t key, int component) const { return at(key, 1, component); }
};

double length_squared(std::span<const double> v) {
  double sum = 0;
  for (double x : v) sum += x * x;
  return sum;
}

// Unit length in place; false when there is no direction left.
bool normalise(std::span<double> q) {
  const double l2 = length_squared(q);
  if (!(l2 > 1e-24) || !std::isfinite(l2)) return false;
  const double scale = 1.0 / std::sqrt(l2);
  for (double& x : q) x *= scale;
  return true;
}

void copy_key(const Keys& keys, size_t key, std::span<double> out) {
  for (size_t c = 0; c < out.size(); ++c) out[c] = keys.value(key, int(c));
}

// The rotation of one key; a zero quaternion turns nothing.
void copy_rotation(const Keys& keys, size_t key, std::span<double> out) {
  copy_key(keys, key, out);
  if (!normalise(out)) out[0] = out[1] = out[2] = 0, out[3] = 1;
}

// Shortest arc (Shoemake, "Animating Rotation with Quaternion Curves", 1985). Close to each other, where sin loses its
// digits, the normalised straight line differs by less than 1e-6 rad.
void slerp(const Keys& keys, size_t key, double s, std::span<double> out) {
  double a[4], b[4];
  copy_rotation(keys, key, a);
  copy_rotation(keys, key + 1, b);
  double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  if (cosine < 0) {
    cosine = -cosine;
    for (double& x : b) x = -x;
  }
  double weight_a = 1 - s, weight_b = s;
  if (cosine <= 0.9995) {
    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
    weight_a = std::sin((1 - s) * angle) / std::sin(angle);
    weight_b = std::sin(s * angle) / std::sin(angle);
  }
  for (int c = 0; c < 4; ++c) out[size_t(c)] = weight_a * a[c] + weight_b * b[c];
  normalise(out);
}

// Hermite segment; tangents are per second, so they scale with the distance of the keys.
void cubic(const Keys& keys, size_t key, double s, double dt, std::span<double> out) {
  const double s2 = s * s, s3 = s2 * s;
  for (size_t i = 0; i < out.size(); ++i) {
    const int c = int(i);
    out[i] = (2 * s3 - 3 * s2 + 1) * keys.value(key, c) + dt * (s3 - 2 * s2 + s) * keys.at(key, 2, c) +
             (3 * s2 - 2 * s3) * keys.value(key + 1, c) + dt * (s3 - s2) * keys.at(key + 1, 0, c);
  }
}

}  // namespace

void sample_channel(const AnimationChannel& channel, double time_s, std::span<double> out) {
  const size_t count = channel.times_s.size(), n = size_t(channel.components);
  const size_t per_key = channel.interpolation == Interpolation::cubic_spline ? 3 * n : n;
  CHECK(count > 0 && out.size() == n && channel.values.size() >= count * per_key);
  const Keys keys{channel};
  const bool rotation = channel.path == TargetPath::node_rotation && n == 4;
  const auto hold = [&](size_t key) { rotation ? copy_rotation(keys, key, out) : copy_key(keys, key, out); };

  // upper_bound leaves t_k <= time < t_(k+1), so of several keys at one time the last stands and dt is never zero.
  const auto after = std::upper_bound(channel.times_s.begin(), channel.times_s.end(), time_s,
                                      [](double time, float key) { return time < double(key); });
  const size_t next = size_t(after - channel.times_s.begin());
  if (next == 0) return hold(0);
  if (next == count) return hold(count - 1);
  const size_t key = next - 1;
  const double dt = double(channel.times_s[next]) - double(channel.times_s[key]);
  const double s = (time_s - double(channel.times_s[key])) / dt;
  switch (channel.interpolation) {
    case Interpolation::step:
      return hold(key);
    case Interpolation::linear:
      if (rotation) return slerp(keys, key, s, out);
      for (size_t c = 0; c < n; ++c) out[c] = (1 - s) * keys.value(key, int(c)) + s * keys.value(next, int(c));
      return;
    case Interpolation::cubic_spline:
      cubic(keys, key, s, dt, out);
      if (rotation && !normalise(out)) copy_rotation(keys, key, out);
      return;
  }
}

}  // namespace candela
