// Geometry: triangles without area or a thousand times longer than wide, normals that are none, transforms that are
// singular, mirrored or tiny, very many triangles in a pixel, meshes that are no manifolds.
#include "stability/stage.h"

namespace candela::stability {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

using Fill = std::function<void(GlbWriter& out, Rng& rng)>;
void add(Recipes& all, std::string name, std::string what, const Fill& fill,
         const std::function<void(StabilityScene&)>& more = {}) {
  all.push_back({"geometry", std::move(name), std::move(what), [=](StabilityInput& in) {
                   GlbWriter out;
                   lit_room(out, in.rng);
                   fill(out, in.rng);
                   StabilityScene scene = scene_of(out);
                   if (more) more(scene);
                   return scene;
                 }});
}

// What is added must not be seen: the plain scene is the room alone.
void add_unseen(Recipes& all, std::string name, std::string what, const Fill& fill, double bound = 0) {
  all.push_back({"geometry", std::move(name), std::move(what),
                 [=](StabilityInput& in) { return beside_plain(in, {}, bound, fill); }});
}

const json clay = lit({0.7, 0.5, 0.4}, 0, 0.6);
const std::vector<glm::dvec3> square = {{-0.7, 0, 0}, {0.7, 0, 0}, {0.7, 1.4, 0}, {-0.7, 1.4, 0}};
const std::vector<uint32_t> two = {0, 1, 2, 0, 2, 3};
const json in_front = {{"translation", {0, 0.1, 1.5}}};

void square_with_normals(GlbWriter& out, glm::dvec3 normal) {
  raw_node(out, raw_primitive(out, square, std::vector<glm::dvec3>(4, normal), two), clay, in_front);
}

void needles(GlbWriter& out, Rng& rng, double width) {
  std::vector<glm::dvec3> p, n;
  for (int i = 0; i < 400; ++i) {
    const double angle = rng.uniform(0, 2 * pi), y = rng.uniform(0.2, 1.5);
    const glm::dvec3 along(std::cos(angle), 0.2 * std::sin(3 * angle), std::sin(angle)),
        from(rng.uniform(-1, 1), y, 1.5);
    p.push_back(from - 5.0 * along), p.push_back(from + 5.0 * along),
        p.push_back(from + 5.0 * along + glm::dvec3(0, width, 0));
    n.insert(n.end(), 3, {0, 0, 1});
  }
  std::vector<uint32_t> index(p.size());
  for (uint32_t i = 0; i < index.size(); ++i) index[i] = i;
  raw_node(out, raw_primitive(out, p, n, index), clay);
}

// A ball of `triangles` far away, smaller than a pixel, around a sample.
StabilityScene dense_ball(StabilityInput& in) {
  const int rings = in.large ? 1600 : 160, segments = in.large ? 3200 : 320;  // 10^7, or 10^5
  GlbWriter out;
  lit_room(out, in.rng);
  const glm::dvec3 eye(0.5, 1.75, 4.5), target(0, 0.5, 0), forward = glm::normalize(target - eye);
  place(out, sphere(2e-3, segments, rings), clay, eye + 1.5 * forward);
  StabilityScene scene = scene_of(out);
  scene.stray_fraction =
      2e-3;  // triangles smaller than the roundings of their corners: any of them may hold the pixel's centre
  return scene;
}

// The same ball near: every triangle is far smaller than a sample's fraction of a pixel.
StabilityScene dense_near(StabilityInput& in) {
  GlbWriter out;
  lit_room(out, in.rng);
  place(out, sphere(0.6, 320, 160), lit({0.7, 0.5, 0.4}, 0, 0.6), {0, 0.75, 1.5});
  return scene_of(out);
}

StabilityScene refused(const std::function<void(GlbWriter&)>& fill) {
  GlbWriter out;
  fill(out);
  StabilityScene scene = scene_of(out);
  scene.refused = true;
  return scene;
}
void add_refused(Recipes& all, std::string name, std::string what, const std::function<void(GlbWriter&)>& fill) {
  all.push_back({"geometry", std::move(name), std::move(what), [=](StabilityInput&) { return refused(fill); }});
}

void add_triangles(Recipes& all) {
  add_unseen(all, "triangles without area", "three corners in one place or in a row", [](GlbWriter& out, Rng&) {
    raw_node(out,
             raw_primitive(out, {{0, 1, 1}, {0, 1, 1}, {0, 1, 1}, {-1, 1, 1}, {0, 1, 1}, {1, 1, 1}}, {},
                           {0, 1, 2, 3, 4, 5, 0, 0, 0}),
             clay);
  });
  add_unseen(all, "corners shared twice", "indices (0, 0, 1)", [](GlbWriter& out, Rng&) {
    raw_node(out, raw_primitive(out, square, std::vector<glm::dvec3>(4, {0, 0, 1}), {0, 0, 1, 2, 2, 2, 1, 3, 3}), clay,
             in_front);
  });
  // Between samples by nearly all, hit by chance where rounding says so.
  add(all, "needles 1e-6 m wide", "400 of 10 m", [](GlbWriter& out, Rng& rng) { needles(out, rng, 1e-6); });
  add(all, "needles 3 mm wide", "400 of 10 m", [](GlbWriter& out, Rng& rng) { needles(out, rng, 3e-3); });
  // What is interpolated over a triangle is a float's fraction of it off: half a millimetre here, from which the lamp
  // is two metres away.
  add(all, "triangle of 1e4 m", "a plain under a lamp", [](GlbWriter& out, Rng&) {
    raw_node(out,
             raw_primitive(out, {{-1e4, -0.25, 1e4}, {1e4, -0.25, 1e4}, {0, -0.25, -1e4}},
                           std::vector<glm::dvec3>(3, {0, 1, 0}), {0, 1, 2}),
             clay);
  });
  all.push_back({"geometry", "very many triangles in a pixel", "10^5 (--large: 10^7)", dense_ball});
  all.push_back({"geometry", "very small triangles", "10^5 over a part of the picture", dense_near});
  add(
      all, "three faces on an edge", "no manifold, and one face twice in one place",
      [](GlbWriter& out, Rng&) {
        const std::vector<glm::dvec3> p = {
            {0, 0.1, 1.5}, {0, 1.4, 1.5}, {0.9, 0.7, 1.9}, {-0.9, 0.7, 1.9}, {0.05, 0.7, 0.6}};
        raw_node(out, raw_primitive(out, p, {}, {0, 1, 2, 0, 1, 3, 0, 1, 4, 0, 1, 2, 2, 1, 0}), clay);
      },
      [](StabilityScene& s) { s.stray_fraction = 2e-3; });
}

void add_normals(Recipes& all) {
  add(
      all, "normals of zero", "they face the viewer",
      [](GlbWriter& out, Rng&) {
        square_with_normals(out, {0, 0, 0});
      },
      [](StabilityScene& s) { s.warns = true; });
  add(all, "normals of 1e-20", "as good as unit ones", [](GlbWriter& out, Rng&) {
    square_with_normals(out, {0, 0, 1e-20});
  });
  add(all, "normals of 1e20", "as good as unit ones", [](GlbWriter& out, Rng&) {
    square_with_normals(out, {0, 0, 1e20});
  });
  add(
      all, "normals of 1e-40", "smaller than normal floats",
      [](GlbWriter& out, Rng&) {
        square_with_normals(out, {0, 0, 1e-40});
      },
      [](StabilityScene& s) { s.reference = false; });
  add(all, "opposite normals", "they cancel in the middle of the triangle", [](GlbWriter& out, Rng&) {
    raw_node(out, raw_primitive(out, square, {{0, 0, 1}, {0, 0, -1}, {0, 0, 1}, {0, 0, -1}}, two), clay, in_front);
  });
  add(all, "normals along the surface", "perpendicular to the triangle's own", [](GlbWriter& out, Rng&) {
    square_with_normals(out, {1, 0, 0});
  });
  add_refused(all, "NaN position", "refused, with its place", [](GlbWriter& out) {
    raw_node(out, raw_primitive(out, {{0, 0, 0}, {1, nan, 0}, {0, 1, 0}}, {}, {0, 1, 2}), clay);
  });
  add_refused(all, "infinite position", "refused, with its place", [](GlbWriter& out) {
    raw_node(out, raw_primitive(out, {{0, 0, 0}, {1, infinity, 0}, {0, 1, 0}}, {}, {0, 1, 2}), clay);
  });
  add_refused(all, "index out of range", "refused, with its place", [](GlbWriter& out) {
    raw_node(out, raw_primitive(out, square, {}, {0, 1, 4000}), clay);
  });
}

// The square by a node's scale and vertices that undo it.
void add_scaled(Recipes& all, std::string name, glm::dvec3 scale) {
  all.push_back({"geometry", std::move(name), "and vertices that undo it", [=](StabilityInput& in) {
                   const auto fill = [&](GlbWriter& out, Rng rng, glm::dvec3 by) {
                     lit_room(out, rng);
                     Shape ball = sphere(0.6, 48, 32);
                     for (glm::dvec3& p : ball.position) p = p / by;
                     // A mirrored transform turns the front side over (glTF 3.7.4).
                     if (by.x * by.y * by.z < 0)
                       for (size_t i = 0; i < ball.index.size(); i += 3) std::swap(ball.index[i], ball.index[i + 1]);
                     for (glm::dvec3& n : ball.normal) n = glm::normalize(n * by);
                     place(out, ball, clay, {0, 0.75, 1.5}, by);
                   };
                   GlbWriter out, plain;
                   fill(out, in.rng, scale);
                   fill(plain, in.rng, {1, 1, 1});
                   StabilityScene scene = scene_of(out);
                   scene.plain = plain.bytes();
                   scene.plain_bound = 1e-4;
                   return scene;
                 }});
}

}  // namespace

void add_geometry(Recipes& all) {
  add_triangles(all);
  add_normals(all);
}

void add_transforms(Recipes& all) {
  add_unseen(all, "scale 0", "nothing is left", [](GlbWriter& out, Rng&) {
    place(out, sphere(0.6, 24, 16), clay, {0, 1, 1}, {0, 0, 0});
  });
  add_unseen(all, "scale 1e-8", "a grain of six nanometres between samples", [](GlbWriter& out, Rng&) {
    place(out, sphere(0.6, 24, 16), clay, {0, 1, 1}, glm::dvec3(1e-8));
  });
  add(all, "scale 0 along z", "a ball pressed flat, its normals with it", [](GlbWriter& out, Rng&) {
    place(out, sphere(0.6, 48, 32), clay, {0, 0.75, 1.5}, {1, 1, 0});
  });
  add_scaled(all, "scale 1e-8 against 1e8", glm::dvec3(1e-8));
  add_scaled(all, "scale 1e8 against 1e-8", glm::dvec3(1e8));
  add_scaled(all, "scale 1e-15 against 1e15", glm::dvec3(1e-15));
  add_scaled(all, "scale 1e15 against 1e-15", glm::dvec3(1e15));
  add_scaled(all, "scale 1, 1e-6, 1e6", {1, 1e-6, 1e6});
  add_scaled(all, "scale -1 in all axes", {-1, -1, -1});
  add_scaled(all, "scale -1e-8 in one axis", {-1e-8, 1e-8, 1e-8});
  // A bow of 20 chained scales, each undone by the next but one.
  all.push_back({"geometry", "chained scales", "1e-4 and 1e4 in turn, twenty deep", [](StabilityInput& in) {
                   const auto fill = [&](GlbWriter& out, Rng rng, int depth) {
                     lit_room(out, rng);
                     const int mesh = out.mesh("ball", out.primitive(sphere(0.6, 48, 32)), out.material("clay", clay));
                     int node = out.node("root", {{"translation", exact({0, 0.75, 1.5})}});
                     for (int i = 0; i < depth; ++i)
                       node = out.child(node, "step", {{"scale", exact(glm::dvec3(i % 2 ? 1e4 : 1e-4))}});
                     out.child(node, "ball", {{"mesh", mesh}});
                   };
                   GlbWriter out, plain;
                   fill(out, in.rng, 20);
                   fill(plain, in.rng, 0);
                   StabilityScene scene = scene_of(out);
                   scene.plain = plain.bytes();
                   return scene;
                 }});
}

}  // namespace candela::stability
