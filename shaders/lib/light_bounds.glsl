// Whether a light can touch a cell of the light grid. Every test errs towards yes: volumes are inflated
// (passes/lights/light_grid.cpp) and comparisons give way by SLACK of the distances involved (the range is inflated by
// far more than its own rounding), so that rounding never loses a light; NaN counts as yes. Space: view, x right, y up,
// z forward. Needs `frame`, lib/light_cells.glsl.

// Rounding of a sum of a few products, as a fraction of the largest term.
const float SLACK = 4e-6;

// The part of a cell between two depths: tangents (or metres, orthographic) of its sides.
struct Slab {
  vec2 low, high;
  float z_near, z_far;
};

// A cell's slab cut to the depths that the light reaches; empty when z_near > z_far.
Slab cell_slab(LightBounds b, uvec2 first_tile, uvec2 last_tile, vec2 depths) {
  Slab s;
  light_tile_sides(first_tile, last_tile, s.low, s.high);
  s.z_near = max(depths.x, b.z_low);
  s.z_far = min(depths.y, b.z_high);
  return s;
}

// Field's standard: the range's ball against the slab's box in view space (Harada 2012). Cones are not looked at.
bool test_aabb(LightBounds b, Slab s) {
  const vec2 at_near = frame.perspective != 0u ? vec2(s.z_near) : vec2(1.0),
      at_far = frame.perspective != 0u ? vec2(s.z_far) : vec2(1.0);
  const vec3 low = vec3(min(s.low * at_near, s.low * at_far), s.z_near),
      high = vec3(max(s.high * at_near, s.high * at_far), s.z_far);
  const vec3 d = max(max(low - b.position, b.position - high), vec3(0.0));
  const float reach = b.radius + SLACK * length(b.position);
  return !(dot(d, d) > reach * reach);
}

// The slab's bounding ball against ball and cone (Wronski, "Cull that cone!", 2017).
bool test_cone_sphere(LightBounds b, Slab s) {
  const float f_near = frame.perspective != 0u ? s.z_near : 1.0, f_far = frame.perspective != 0u ? s.z_far : 1.0;
  const vec3 low_near = vec3(s.low * f_near, s.z_near), high_near = vec3(s.high * f_near, s.z_near);
  const vec3 low_far = vec3(s.low * f_far, s.z_far), high_far = vec3(s.high * f_far, s.z_far);
  const vec3 low = min(min(low_near, high_near), min(low_far, high_far)),
      high = max(max(low_near, high_near), max(low_far, high_far));
  const vec3 c = 0.5 * (low + high);
  const float r = 0.5 * length(high - low);
  const vec3 v = c - b.position;
  const float far = length(v), slack = SLACK * (length(b.position) + length(c) + r);
  if (far > r + b.radius + slack) return false;
  if (b.cos_outer == -2.0) return true;
  const float along = dot(v, b.direction);
  const float across = length(v - along * b.direction);
  return !(b.cos_outer * across - b.sin_outer * along > r + slack || along > r + b.radius + slack ||
      along < -r - slack);
}

// The capsule round a slab: balls whose centres run from a to a + length u and whose radii grow by
// kappa a metre.
struct Capsule {
  vec3 a, u;
  float length_m, radius, kappa;
};
Capsule slab_capsule(Slab s) {
  const vec2 middle = 0.5 * (s.low + s.high);
  const float rho = 0.5 * length(s.high - s.low);
  Capsule c;
  if (frame.perspective != 0u) {
    const vec3 axis = vec3(middle, 1.0);
    const float stretch = length(axis);
    c.a = s.z_near * axis;
    c.u = axis / stretch;
    c.length_m = (s.z_far - s.z_near) * stretch;
    c.radius = s.z_near * rho;
    c.kappa = rho / stretch;
  } else {
    c.a = vec3(middle, s.z_near);
    c.u = vec3(0.0, 0.0, 1.0);
    c.length_m = s.z_far - s.z_near;
    c.radius = rho;
    c.kappa = 0.0;
  }
  return c;
}

// The part of the axis whose balls touch the light's ball; empty when x > y. The foot of the perpendicular is at y0,
// its distance m; |q + y u|^2 <= (R + r(y))^2 is a quadratic in t = y - y0 whose discriminant has factors, so nothing
// cancels.
vec2 ball_interval(LightBounds b, Capsule c, vec3 q, float slack) {
  const float y0 = -dot(q, c.u);
  const float m = length(q + y0 * c.u);
  const float g = 1.0 - c.kappa * c.kappa, root_g = sqrt(g);
  const float r0 = b.radius + c.radius + c.kappa * y0 + slack;
  const float d = (r0 - root_g * m) * (r0 + root_g * m);
  if (d < 0.0) return vec2(1.0, 0.0);
  const float root = sqrt(d);
  vec2 t = vec2(c.kappa * r0 - root, c.kappa * r0 + root) / g;
  t += vec2(-slack, slack) + y0;
  return vec2(max(t.x, 0.0), min(t.y, c.length_m));
}

// Least of G(y) = cos * across - sin * along - r(y) over an interval: the distance of a ball to the infinite cone's
// mantle. G is convex for half angles up to 90 degrees, so its stationary point clamped to the interval is the minimum.
bool cone_touches(LightBounds b, Capsule c, vec3 q, vec2 interval, float slack) {
  const float alpha = dot(c.u, b.direction);
  const vec3 v = c.u - alpha * b.direction;
  const float beta2 = dot(v, v), beta = sqrt(beta2);
  const vec3 w = q - dot(q, b.direction) * b.direction;
  const float grows = alpha * b.sin_outer + c.kappa;
  float y = grows > 0.0 ? interval.y : interval.x;
  const float turn = beta * b.cos_outer;
  if (beta > 1e-6 && abs(grows) < turn) {
    const float y0 = -dot(w, v) / beta2;
    const float m = length(w + y0 * v);
    const float lambda = grows / sqrt((turn - grows) * (turn + grows));
    y = clamp(y0 + m / beta * lambda, interval.x, interval.y);
  }
  const vec3 p = q + y * c.u;
  const float along = dot(p, b.direction);
  const float across = length(p - along * b.direction);
  return !(b.cos_outer * across - b.sin_outer * along > c.radius + c.kappa * y + slack);
}

// Cuts an interval of the axis to the balls that reach in front of the apex: h(y) + r(y) >= 0, which is linear.
vec2 in_front_of_apex(LightBounds b, Capsule c, vec3 q, vec2 interval, float slack) {
  const float at = dot(q, b.direction) + c.radius + slack, slope = dot(c.u, b.direction) + c.kappa;
  if (at + slope * interval.x < 0.0 && at + slope * interval.y < 0.0) return vec2(1.0, 0.0);
  if (abs(slope) < 1e-6) return interval;
  const float zero = -at / slope;
  const float tolerance = 1e-5 * abs(zero);  // of the quotient
  return slope > 0.0 ? vec2(max(interval.x, zero - tolerance), interval.y)
      : vec2(interval.x, min(interval.y, zero + tolerance));
}

// Ball and cone each against the whole capsule.
bool test_capsule(LightBounds b, Slab s) {
  const Capsule c = slab_capsule(s);
  const vec3 q = c.a - b.position;
  const float slack = SLACK * (length(c.a) + length(b.position) + c.length_m);
  const vec2 touching = ball_interval(b, c, q, slack);
  if (touching.x > touching.y) return false;
  if (b.cos_outer == -2.0) return true;
  const vec2 front = in_front_of_apex(b, c, q, vec2(0.0, c.length_m), slack);
  if (front.x > front.y) return false;
  return b.cos_outer <= 1e-3 || cone_touches(b, c, q, vec2(0.0, c.length_m), slack);
}

// Ball and cone at one and the same depth: the joint interval test.
bool test_capsule_joint(LightBounds b, Slab s) {
  const Capsule c = slab_capsule(s);
  const vec3 q = c.a - b.position;
  const float slack = SLACK * (length(c.a) + length(b.position) + c.length_m);
  vec2 interval = ball_interval(b, c, q, slack);
  if (interval.x > interval.y) return false;
  if (b.cos_outer == -2.0) return true;
  interval = in_front_of_apex(b, c, q, interval, slack);
  if (interval.x > interval.y) return false;
  return b.cos_outer <= 1e-3 || cone_touches(b, c, q, interval, slack);
}

// passes/lights/light_assign.h
const int TEST_AABB = 0, TEST_CONE_SPHERE = 1, TEST_CAPSULE = 2, TEST_CAPSULE_JOINT = 3;

bool light_touches(int test, LightBounds b, Slab s) {
  if (s.z_near > s.z_far) return false;
  if (test == TEST_AABB) return test_aabb(b, s);
  if (test == TEST_CONE_SPHERE) return test_cone_sphere(b, s);
  if (test == TEST_CAPSULE) return test_capsule(b, s);
  return test_capsule_joint(b, s);
}
