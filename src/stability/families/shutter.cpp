// Shutters and lenses: open for nothing and for a whole frame, focused at the near plane and far away, openings wider
// than the room and narrower than a float's last digit, what moves faster than the picture is wide, and cuts.
#include "stability/stage.h"

namespace candela::stability {
namespace {

constexpr double frame_s = 1.0 / 24;

// The lit room, a box in it that moves at so many metres a second, and the job's shutter and lens.
StabilityScene moving(StabilityInput& in, double speed_m_s, const std::function<void(Job&)>& set, double near_m = 0.1) {
  GlbWriter out;
  lit_room(out, in.rng, {.near_m = near_m});
  const int node = out.node("mover", {{"mesh", out.mesh("mover", out.primitive(box({0.9, 0.5, 0.3})),
                                                        out.material("mover", lit({0.8, 0.6, 0.2}, 0, 0.5)))},
                                      {"translation", exact(glm::dvec3(0, 0.75, 1.5))}});
  std::vector<double> places;
  push(places, {-speed_m_s, 0.75, 1.5}), push(places, {speed_m_s, 0.75, 1.5});
  out.animate(node, "translation", "LINEAR", std::vector<double>{0, 2}, places, 3);
  StabilityScene scene = scene_of(out);
  scene.time_s = 1;
  scene.reference = false;  // it has one moment here; tests compare pictures over a shutter
  set(scene.job);
  return scene;
}

void add(Recipes& all, const char* name, const char* what, double speed_m_s, std::function<void(Job&)> set,
         double near_m = 0.1) {
  all.push_back({"shutter", name, what, [=](StabilityInput& in) {
                   StabilityScene scene = moving(
                       in, speed_m_s,
                       [&](Job& job) {
                         job.settings.push_back({"subframes", "n", "3"});
                         set(job);
                       },
                       near_m);
                   return scene;
                 }});
}

// As the picture without shutter and lens, within a bound.
void add_alike(Recipes& all, const char* name, const char* what, double bound, std::function<void(Job&)> set) {
  all.push_back({"shutter", name, what, [=](StabilityInput& in) {
                   Rng again = in.rng;
                   StabilityScene scene = moving(in, 3, set);
                   StabilityInput same{again, in.large};
                   StabilityScene plain = moving(same, 3, [](Job&) {});
                   scene.plain = plain.file, scene.plain_job = plain.job;
                   scene.plain_time_s = 1, scene.plain_bound = bound;
                   return scene;
                 }});
}

std::function<void(Job&)> lens(double f_stop, const char* focus, double sensor_mm = 24) {
  return [=](Job& job) { job.f_stop = f_stop, job.focus = focus, job.sensor_mm = sensor_mm; };
}
std::function<void(Job&)> shutter(double frames) {
  return [=](Job& job) { job.shutter_s = frames * frame_s; };
}

}  // namespace

void add_shutter(Recipes& all) {
  add_alike(all, "shutter 0", "no time: the picture without", 0, shutter(0));
  add_alike(all, "one subframe", "the middle of shutter, lens and pixel: the picture without, cut out of a wider one",
            1e-4, [](Job& job) {
              shutter(1)(job), lens(1.4, "4")(job);
              job.settings.push_back({"subframes", "n", "1"});
            });
  add_alike(all, "f/1e12", "an opening of no width: likewise", 1e-4, [](Job& job) {
    lens(1e12, "4")(job);
    job.settings.push_back({"subframes", "n", "1"});
  });
  add(all, "shutter of a whole frame", "a box at 20 m/s", 20, shutter(1));
  add(all, "a box at 1e9 m/s", "behind both walls within a frame", 1e9, shutter(1));
  add(all, "a box at 1e30 m/s", "beyond what a float holds when squared", 1e30, shutter(1));
  add(all, "1e-12 s", "a shutter of a picosecond", 20, [](Job& job) { job.shutter_s = 1e-12; });
  add(all, "focus at the near plane", "everything is out of focus", 3, lens(16, "0.1"));
  add(all, "focus at infinity", "what is near is blurred", 3, lens(0.5, "inf"));
  add(all, "focus at 1e30 m", "as at infinity", 3, lens(0.5, "1e30"));
  add(all, "focus at the moving box", "a node's name", 3, lens(2, "mover"));
  add(all, "an opening of a metre", "eyes inside what stands before the camera", 3, lens(0.03, "6"));
  add(all, "a sensor of a kilometre", "an opening wider than the room", 3, lens(2e4, "5", 1e6));
  add(all, "shutter and lens", "with a box at 5 m/s", 5, [](Job& job) { shutter(0.5)(job), lens(0.2, "5")(job); });
  add(all, "gathered motion", "one frame along its motion, a box at 5 m/s", 5, [](Job& job) {
    shutter(0.5)(job);
    job.settings.push_back({"subframes", "gather", "1"});
  });
  add(all, "gathered motion of 1e9 m/s", "longer than the picture", 1e9, [](Job& job) {
    shutter(1)(job);
    job.settings.push_back({"subframes", "gather", "1"});
  });
  all.push_back({"shutter", "focus at 1e-9 m", "frames would be larger than any image", [](StabilityInput& in) {
                   StabilityScene scene = moving(in, 3, lens(1.4, "1e-9"));
                   scene.refused = true;
                   return scene;
                 }});
  all.push_back({"shutter", "focus at what is not there", "a node's name that no node has", [](StabilityInput& in) {
                   StabilityScene scene = moving(in, 3, lens(1.4, "nobody"));
                   scene.refused = true;
                   return scene;
                 }});
}

}  // namespace candela::stability
