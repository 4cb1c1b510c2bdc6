// Bodies of metaballs at the ends of what a file may say: thresholds of nothing and above all, balls that touch and
// that are in one place, cells larger than balls, the camera inside.
#include "stability/stage.h"

namespace candela::stability {
namespace {

struct Ball {
  glm::dvec3 at{0};
  double radius = 0.6, strength = 1;
};
struct Body {
  std::vector<Ball> balls;
  double threshold = 0.3, cell = 0.02;
  bool double_sided = false;
};

void add_body(GlbWriter& out, const Body& body, glm::dvec3 at = {0, 0.7, 1.2}) {
  json material = lit({0.3, 0.6, 0.4}, 0, 0.6);
  material["doubleSided"] = body.double_sided;
  const int node = out.node("body", {{"translation", exact(at)}});
  json balls = json::array();
  for (const Ball& ball : body.balls)
    balls.push_back({{"node", out.child(node, "ball", {{"translation", exact(ball.at)}})},
                     {"radius", ball.radius},
                     {"strength", ball.strength}});
  out.use_extension("CANDELA_metaballs");
  out.root["nodes"][size_t(node)]["extensions"]["CANDELA_metaballs"] = {{"threshold", body.threshold},
                                                                        {"cell", body.cell},
                                                                        {"material", out.material("body", material)},
                                                                        {"balls", balls}};
}

// Against the surface itself: polygons are off by the square of the cell, and at outlines a sample is on one side or
// the other.
void add(Recipes& all, std::string name, std::string what, const Body& body, double bound = 1e-3,
         double strays = 2e-2) {
  all.push_back({"metaballs", std::move(name), std::move(what), [=](StabilityInput& in) {
                   StabilityScene scene = filled(in, [&](GlbWriter& out) { add_body(out, body); });
                   scene.bound = bound, scene.stray_fraction = strays, scene.energy_bound = 2e-3;
                   return scene;
                 }});
}

void add_alike(Recipes& all, std::string name, std::string what, const Fill& fill, const Fill& plain) {
  all.push_back({"metaballs", std::move(name), std::move(what),
                 [=](StabilityInput& in) { return filled_alike(in, fill, plain, 0); }});
}

const Fill nothing = [](GlbWriter&) {};
Fill of(Body body, glm::dvec3 at = {0, 0.7, 1.2}) {
  return [=](GlbWriter& out) { add_body(out, body, at); };
}

}  // namespace

void add_metaballs(Recipes& all) {
  const std::vector<Ball> two = {{{-0.25, 0, 0}}, {{0.25, 0.1, 0}}};
  add(all, "two", "balls that flow together", {two});
  add(all, "hollow", "a strength below 0 cuts into a ball", {{{{0, 0, 0}}, {{0.15, 0.2, 0.4}, 0.4, -1.5}}});
  add(all, "single", "the largest strength and threshold in the file's range that leave a ball",
      {{{{0, 0, 0}, 0.6, 1e6}}, 3e5});
  // The field leaves 0 with its third power: a vertex may lie anywhere on its edge.
  add(all, "threshold 0", "the surface of the supports", {two, 0, 0.01}, 2e-2, 3e-2);
  add_alike(all, "threshold of all", "above every sum: nothing is there", of({two, 2}), nothing);
  add_alike(all, "no strength", "balls of strength 0", of({{{{0, 0, 0}, 0.6, 0}}}), nothing);
  add_alike(all, "negative", "nothing but strengths below 0", of({{{{0, 0, 0}, 0.6, -1}}, 0}), nothing);
  add(all, "touching", "supports that share a point", {{{{-0.4, 0, 0}, 0.4}, {{0.4, 0, 0}, 0.4}}, 0.01});
  add_alike(all, "coincident", "two balls in one place are one of twice the strength", of({{{{0, 0, 0}}, {{0, 0, 0}}}}),
            of({{{{0, 0, 0}, 0.6, 2}}}));
  add_alike(all, "cancelling", "two in one place whose strengths cancel", of({{{{0, 0, 0}}, {{0, 0, 0}, 0.6, -1}}}),
            nothing);
  add_alike(all, "cell of a room", "a cell larger than the ball, whose nodes lie outside it",
            of({{{{0.5, 0.5, 0.5}, 0.4}}, 0.3, 4}), nothing);
  add_alike(all, "tiny ball", "a ball of a millionth of the cell", of({{{{0.5, 0.5, 0.5}, 4e-6}}, 0.3, 4}), nothing);
  add_alike(all, "around the camera", "the camera inside a single-sided ball sees through it",
            of({{{{0, 0, 0}, 2}}, 0.3, 0.1}, {0.5, 1.75, 4.5}), nothing);
  add(all, "around the camera, both sides", "the same, double sided: nothing else is seen",
      {{{{0.5, 1.05, 3.3}, 2}}, 0.3, 0.03, true});
}

}  // namespace candela::stability
