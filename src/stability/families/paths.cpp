// Paths from files: points that coincide, one and two of them, times before and after, jumps, and what is refused.
#include "base/check.h"
#include "look/motion.h"
#include "stability/stage.h"

namespace candela::stability {
namespace {

const glm::dvec3 home(0, 0.75, 1.5);
using Texts = std::vector<std::pair<std::string, std::string>>;

json mover(GlbWriter& out) {
  return out.mesh("mover", out.primitive(box({0.9, 0.5, 0.3})), out.material("mover", lit({0.8, 0.6, 0.2}, 0, 0.5)));
}

// A box in the room on a path; the plain scene has it where it should stand at `time_s`.
StabilityScene moved(StabilityInput& in, const std::string& options, Texts texts, double time_s, glm::dvec3 at) {
  GlbWriter out, plain;
  Rng again = in.rng;
  lit_room(out, in.rng);
  lit_room(plain, again);
  out.node("mover", {{"mesh", mover(out)}});
  plain.node("mover", {{"mesh", mover(plain)}, {"translation", exact(at)}});
  StabilityScene scene = scene_of(out);
  scene.plain = plain.bytes();
  scene.plain_job = scene.job;
  auto path = parse_node_path("--path", "mover=points.txt" + options);
  CHECK_MSG(path, options);
  scene.job.paths.push_back(std::move(*path));
  scene.texts = std::move(texts);
  scene.time_s = time_s;
  return scene;
}

void add(Recipes& all, const char* name, const char* what, std::string options, Texts texts, double time_s = 0,
         glm::dvec3 at = home) {
  all.push_back({"paths", name, what, [=](StabilityInput& in) { return moved(in, options, texts, time_s, at); }});
}
void refused(Recipes& all, const char* name, const char* what, std::string options, Texts texts) {
  all.push_back({"paths", name, what, [=](StabilityInput& in) {
                   StabilityScene scene = moved(in, options, texts, 0, home);
                   scene.plain.clear();
                   scene.refused = true;
                   return scene;
                 }});
}

std::string lines(const std::vector<glm::dvec3>& points) {
  std::string text;
  for (const glm::dvec3& p : points) text += fmt::format("{} {} {}\n", p.x, p.y, p.z);
  return text;
}
Texts on(const std::vector<glm::dvec3>& points, const std::string& times = {}) {
  Texts texts = {{"points.txt", lines(points)}};
  if (!times.empty()) texts.emplace_back("times.txt", times);
  return texts;
}

}  // namespace

void add_paths(Recipes& all) {
  const glm::dvec3 x(1, 0, 0);
  add(all, "one point", "a place, at any time", "", on({home}), 7);
  add(all, "one point, closed", "likewise", ",closed", on({home}), 0.3);
  add(all, "one point at constant speed", "no length to go", ",constant-speed", on({home}), 0.5);
  add(all, "one point, looking along", "no way to look", ",along", on({home}), 0.5);
  add(all, "looks at where it stands", "it stays turned as it is", ",look-at=0:0.75:1.5", on({home}));
  add(all, "two points", "half-way between them", "", on({home - x, home + x}), 1.5);
  add(all, "two points, closed", "there and back, in the middle of the way back", ",closed,seconds=1",
      on({home - x, home + x}), 0.75);
  const std::string times = "10 0\n20 3\n";
  add(all, "before the first time", "it stands at the begin", ",times=times.txt", on({home, home + 9.0 * x}, times));
  add(all, "after the last time", "it stays at the end", ",times=times.txt", on({home - 9.0 * x, home}, times), 1e9);
  add(all, "at the last time", "it has come to the end", ",times=times.txt", on({home - 9.0 * x, home}, times), 20);
  add(all, "one time", "nothing to go between", ",times=times.txt", on({home - x, home, home + x}, "3 2\n"), 1);
  add(all, "hardly any time", "1e-300 s: the end", ",seconds=1e-300", on({home - 9.0 * x, home}), 1);
  const std::vector<glm::dvec3> same(6, home);
  add(all, "points that coincide", "they are one", "", on(same), 2.5);
  add(all, "points that coincide, along", "no way to look", ",along,closed", on(same), 2.5);
  add(all, "points that coincide at constant speed", "no length to go", ",constant-speed,ends=plain", on(same), 1.5);
  const std::vector<glm::dvec3> knot = {home - 2.0 * x, home, home, home, home + 2.0 * x};
  add(all, "three points that coincide", "it passes there", "", on(knot), 3);
  add(all, "three points that coincide, at constant speed", "in the middle of the length", ",constant-speed", on(knot),
      3);
  std::vector<glm::dvec3> near;
  for (int i = -3; i <= 3; ++i) near.push_back(home + 1e-13 * i * x);
  add(all, "points 1e-13 m apart", "the digits of their differences", ",constant-speed", on(near), 4);
  const std::vector<glm::dvec3> line = {home - 3.0 * x, home - 2.0 * x, home - x, home, home + x, home + 2.0 * x};
  const std::string jump = "0 0\n1 1\n1 2\n2 3\n";
  for (const char* smooth : {"", ",interpolation=cubic"}) {
    const std::string with = ",ends=plain,times=times.txt" + std::string(smooth);
    add(all, *smooth ? "a jump, smooth" : "a jump", "at a time that stands twice the later parameter counts", with,
        on(line, jump), 1);
    add(all, *smooth ? "before a jump, smooth" : "before a jump", "the last moment of the earlier", with,
        on(line, jump), std::nextafter(1, 0), home - x);
  }
  add(all, "a jump at the begin", "the later parameter", ",ends=plain,times=times.txt", on(line, "0 0\n0 2\n5 2\n"));
  add(all, "times 1e-300 s apart", "a step", ",ends=plain,times=times.txt", on(line, "0 0\n1e-300 2\n"), 1e-300);
  add(all, "times 1e300 s apart", "hardly gone", ",ends=plain,times=times.txt", on(line, "-1e300 0\n0 2\n1e300 3\n"),
      1);
  add(all, "points 1e300 m away", "not there yet", "", on({home, glm::dvec3(1e300)}));
  const std::vector<glm::dvec3> four(4, home);
  refused(all, "times out of order", "names the line", ",times=times.txt", on(four, "0 0\n2 1\n1 2\n"));
  refused(all, "a time three times", "two are a jump", ",times=times.txt", on(four, "0 0\n1 1\n1 2\n1 3\n"));
  refused(all, "a time without a parameter", "names the line", ",times=times.txt", on(four, "0 0\n1\n"));
  refused(all, "three points with plain ends", "a span needs four", ",ends=plain", on({home, home, home}));
  refused(all, "a point of two numbers", "names the line", "", {{"points.txt", "0 0 0\n1 2\n"}});
  refused(all, "a point that is no number", "names the line", "", {{"points.txt", "0 0 nan\n"}});
  refused(all, "no point", "nothing to go along", "", {{"points.txt", "# none\n\n"}});
}

}  // namespace candela::stability
