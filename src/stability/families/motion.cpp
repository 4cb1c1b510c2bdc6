// Animation: keys at one time and nearly so, rotations by way of their opposite, splines with tangents beyond reason, a
// million keys, weights and skins that have no sum.
#include "stability/stage.h"

namespace candela::stability {
namespace {

using Fill = std::function<void(GlbWriter& out, int node)>;

json ball_mesh(GlbWriter& out) {
  return out.mesh("mover", out.primitive(box({0.9, 0.5, 0.3})), out.material("mover", lit({0.8, 0.6, 0.2}, 0, 0.5)));
}

// A box in the room that `animate` drives; the plain scene has it where it should stand at `time_s`.
void add(Recipes& all, std::string name, std::string what, double time_s, glm::dvec3 at, glm::dquat rotation,
         const Fill& animate, double bound = 1e-5) {
  all.push_back(
      {"animation", std::move(name), std::move(what), [=](StabilityInput& in) {
         GlbWriter out, plain;
         Rng again = in.rng;
         lit_room(out, in.rng);
         lit_room(plain, again);
         animate(out, out.node("mover", {{"mesh", ball_mesh(out)}, {"translation", exact(at)}}));
         plain.node("mover", {{"mesh", ball_mesh(plain)}, {"translation", exact(at)}, {"rotation", exact(rotation)}});
         StabilityScene scene = scene_of(out);
         scene.plain = plain.bytes();
         scene.time_s = time_s;
         scene.plain_bound = bound;
         return scene;
       }});
}

const glm::dquat none(1, 0, 0, 0);
const glm::dvec3 home(0, 0.75, 1.5);

std::vector<double> flat(std::initializer_list<glm::dvec3> list) {
  std::vector<double> out;
  for (const glm::dvec3& v : list) out.insert(out.end(), {v.x, v.y, v.z});
  return out;
}
std::vector<double> flat(std::initializer_list<glm::dquat> list) {
  std::vector<double> out;
  for (const glm::dquat& q : list) out.insert(out.end(), {q.x, q.y, q.z, q.w});
  return out;
}

void add_keys(Recipes& all) {
  all.push_back({"animation", "two keys at one time",
                 "no step in time has a length of 0: refused, or the later key stands, with a warning",
                 [](StabilityInput& in) {
                   GlbWriter out, plain;
                   Rng again = in.rng;
                   lit_room(out, in.rng);
                   lit_room(plain, again);
                   const int node = out.node("mover", {{"mesh", ball_mesh(out)}});
                   out.animate(node, "translation", "LINEAR", std::vector<double>{0, 1, 1, 2},
                               flat({glm::dvec3(9), glm::dvec3(-9), home, home}), 3);
                   plain.node("mover", {{"mesh", ball_mesh(plain)}, {"translation", exact(home)}});
                   StabilityScene scene = scene_of(out);
                   scene.plain = plain.bytes();
                   scene.plain_bound = 0;
                   scene.time_s = 1;
                   scene.warns = true;
                   return scene;
                 }});
  add(all, "keys 1e-7 s apart", "at the second of them", double(1.0f + 1.1920929e-7f), home, none,
      [](GlbWriter& out, int node) {
        out.animate(node, "translation", "LINEAR", std::vector<double>{0, 1, double(1.0f + 1.1920929e-7f)},
                    flat({glm::dvec3(3), glm::dvec3(-9), home}), 3);
      });
  add(
      all, "keys 1e-7 s apart, between", "half-way, from one side of the room to the other", 1e-7 / 2, home, none,
      [](GlbWriter& out, int node) {
        out.animate(node, "translation", "LINEAR", std::vector<double>{0, 1e-7},
                    flat({home - glm::dvec3(4, 0, 0), home + glm::dvec3(4, 0, 0)}), 3);
      },
      1e-3);
  add(all, "keys 1e-38 s apart", "step", 1, home, none, [](GlbWriter& out, int node) {
    out.animate(node, "translation", "STEP", std::vector<double>{0, 1.2e-38}, flat({glm::dvec3(3), home}), 3);
  });
  add(all, "a million keys", "at one of them", 524288, home, none, [](GlbWriter& out, int node) {
    std::vector<double> times, values;
    for (int i = 0; i < 1'000'000; ++i) {
      times.push_back(i);
      const glm::dvec3 v = i == 524288 ? home : glm::dvec3(std::sin(i), 5, 0);
      values.insert(values.end(), {v.x, v.y, v.z});
    }
    out.animate(node, "translation", "LINEAR", times, values, 3);
  });
  add(all, "time 1e6 s", "after the last key it stays", 1e6, home, none, [](GlbWriter& out, int node) {
    out.animate(node, "translation", "LINEAR", std::vector<double>{0, 1}, flat({glm::dvec3(3), home}), 3);
  });
  add(all, "time before the first key", "it stands there already", 0, home, none, [](GlbWriter& out, int node) {
    out.animate(node, "translation", "LINEAR", std::vector<double>{1e6, 2e6}, flat({home, glm::dvec3(3)}), 3);
  });
}

void add_rotations(Recipes& all) {
  const glm::dquat quarter = rotation_about({0, 1, 0}, pi / 2), eighth = rotation_about({0, 1, 0}, pi / 4);
  add(all, "antipodal quaternions", "q and -q are one rotation: no turn between", 0.5, home, quarter,
      [=](GlbWriter& out, int node) {
        out.animate(node, "rotation", "LINEAR", std::vector<double>{0, 1}, flat({quarter, -quarter}), 4);
      });
  add(all, "nearly antipodal", "the short way from 0 to 90 degrees, the end given as its opposite", 0.5, home, eighth,
      [=](GlbWriter& out, int node) {
        out.animate(node, "rotation", "LINEAR", std::vector<double>{0, 1}, flat({none, -quarter}), 4);
      });
  add(
      all, "half a turn", "two ways are equally short; either is finite and unit", 1, home,
      rotation_about({0, 1, 0}, pi),
      [=](GlbWriter& out, int node) {
        out.animate(node, "rotation", "LINEAR", std::vector<double>{0, 1}, flat({none, rotation_about({0, 1, 0}, pi)}),
                    4);
      },
      1e-3);
  add(
      all, "quaternions next to each other", "1e-9 rad: the sine's quotient has no digits", 0.5, home, none,
      [=](GlbWriter& out, int node) {
        out.animate(node, "rotation", "LINEAR", std::vector<double>{0, 1},
                    flat({none, rotation_about({0, 1, 0}, 1e-9)}), 4);
      },
      1e-4);
  add(all, "spline of quaternions through zero", "tangents that cancel the values: the key stands", 0.5, home, none,
      [](GlbWriter& out, int node) {
        // (2s^3-3s^2+1) v + ... at s = 1/2: (v0 + v1) / 2 + (b0 - a1) / 8 = 0.
        out.animate(node, "rotation", "CUBICSPLINE", std::vector<double>{0, 1},
                    flat({glm::dquat(0, 0, 0, 0), none, glm::dquat(-4, 0, 0, 0), glm::dquat(4, 0, 0, 0), none,
                          glm::dquat(0, 0, 0, 0)}),
                    4);
      });
}

void add_splines(Recipes& all) {
  add(all, "spline with tangents of 1e30", "at a key", 1, home, none, [](GlbWriter& out, int node) {
    const glm::dvec3 huge(1e30, -1e30, 1e30);
    out.animate(node, "translation", "CUBICSPLINE", std::vector<double>{0, 1, 2},
                flat({huge, glm::dvec3(0), huge, huge, home, -huge, huge, glm::dvec3(1), huge}), 3);
  });
  const auto far_away = [](double tangent) {
    return [=](StabilityInput& in) {
      GlbWriter out, plain;
      Rng again = in.rng;
      lit_room(out, in.rng);
      lit_room(plain, again);
      const int node = out.node("mover", {{"mesh", ball_mesh(out)}});
      const glm::dvec3 huge(tangent, tangent, 0);
      out.animate(node, "translation", "CUBICSPLINE", std::vector<double>{0, 1},
                  flat({huge, home, huge, -huge, home, huge}), 3);
      StabilityScene scene = scene_of(out);
      scene.plain = plain.bytes();  // the box is out of sight
      scene.plain_bound = 0;
      scene.time_s = 0.5;
      return scene;
    };
  };
  all.push_back({"animation", "spline far outside", "between keys, tangents of 1e30", far_away(1e30)});
  all.push_back(
      {"animation", "spline beyond floats", "between keys, tangents of 3e38: the place is no float", far_away(3e38)});
}

void add_weights(Recipes& all) {
  all.push_back({"animation", "morph weight 1e6", "of a delta of a micrometre", [](StabilityInput& in) {
                   const auto fill = [](GlbWriter& out, Rng rng, double delta, double weight) {
                     lit_room(out, rng);
                     json primitive = out.primitive(quad(1, 1));
                     std::vector<glm::dvec3> deltas(4, glm::dvec3(0, delta, 0));
                     primitive["targets"] = json::array({{{"POSITION", out.vec3_accessor(deltas, true)}}});
                     const int mesh = out.mesh("sheet", primitive, out.material("sheet", lit({0.3, 0.7, 0.9}, 0, 0.5)));
                     out.node("sheet", {{"mesh", mesh}, {"weights", {weight}}, {"translation", exact({0, 0, 1.5})}});
                   };
                   GlbWriter out, plain;
                   fill(out, in.rng, 9.5367431640625e-7, 1048576);
                   fill(plain, in.rng, 1, 1);
                   StabilityScene scene = scene_of(out);
                   scene.plain = plain.bytes();
                   return scene;
                 }});
  all.push_back(
      {"animation", "skin without weights",
       "all weights 0: the vertex stays with the first joint, or rigid, and is finite", [](StabilityInput& in) {
         GlbWriter out;
         lit_room(out, in.rng);
         const Shape shape = quad(1, 1);
         json primitive = out.primitive(shape);
         primitive["attributes"]["JOINTS_0"] =
             out.joint_accessor(std::vector<glm::u16vec4>(shape.position.size(), glm::u16vec4(0)));
         primitive["attributes"]["WEIGHTS_0"] =
             out.float_accessor(std::vector<double>(shape.position.size() * 4, 0.0), 4);
         const int mesh = out.mesh("skinned", primitive, out.material("skinned", lit({0.3, 0.7, 0.9}, 0, 0.5)));
         const int joint = out.node("joint", {{"translation", exact({0, 0.8, 1.5})}});
         out.root["skins"] = json::array({{{"joints", {joint}}}});
         out.node("skinned", {{"mesh", mesh}, {"skin", 0}});
         StabilityScene scene = scene_of(out);
         scene.warns = true;
         return scene;
       }});
  all.push_back(
      {"animation", "skin at 1e6 m", "joints far away, the picture as near", [](StabilityInput& in) {
         const auto fill = [](GlbWriter& out, Rng rng, glm::dvec3 origin) {
           lit_room(out, rng, {.origin = origin});
           const Shape shape = box({0.5, 1, 0.25});
           json primitive = out.primitive(shape);
           std::vector<glm::u16vec4> joints(shape.position.size(), glm::u16vec4(0, 1, 0, 0));
           std::vector<double> weights;
           for (const glm::dvec3& p : shape.position)
             weights.insert(weights.end(), {p.y > 0 ? 0.25 : 0.75, p.y > 0 ? 0.75 : 0.25, 0, 0});
           primitive["attributes"]["JOINTS_0"] = out.joint_accessor(joints);
           primitive["attributes"]["WEIGHTS_0"] = out.float_accessor(weights, 4);
           const int mesh = out.mesh("skinned", primitive, out.material("skinned", lit({0.3, 0.7, 0.9}, 0, 0.5)));
           const int root = out.node("root", {{"translation", exact(origin + glm::dvec3(0, 0.75, 1.5))}});
           const int tip =
               out.child(root, "tip",
                         {{"translation", exact({0, 0.25, 0})}, {"rotation", exact(rotation_about({0, 0, 1}, 0.5))}});
           out.root["skins"] = json::array({{{"joints", {root, tip}}}});
           out.node("skinned", {{"mesh", mesh}, {"skin", 0}});
         };
         GlbWriter out, plain;
         fill(out, in.rng, {1e6, 1e6, -1e6});
         fill(plain, in.rng, {0, 0, 0});
         StabilityScene scene = scene_of(out);
         scene.plain = plain.bytes();
         scene.plain_bound = 0;
         return scene;
       }});
}

}  // namespace

void add_animation(Recipes& all) {
  add_keys(all);
  add_rotations(all);
  add_splines(all);
  add_weights(all);
}

}  // namespace candela::stability
