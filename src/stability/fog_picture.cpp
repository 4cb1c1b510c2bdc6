#include "stability/fog_picture.h"

#include <cstring>

#include "job/job_look.h"
#include "reference/display.h"
#include "reference/film.h"
#include "render/reference_frame.h"

namespace candela {

Expected<FogPicture> fog_picture(const Job& job, reference::Mode mode,
                                 const std::function<glm::dvec3(glm::dvec3)>& known) {
  const auto frame = open_reference(job, 0, {});
  if (!frame) return std::unexpected(frame.error());
  const reference::World& world = *(*frame)->world;
  const bool direct = mode == reference::Mode::direct;
  const int samples = direct ? 1 : 256;
  reference::TraceSettings settings;
  settings.mode = mode;
  settings.sampler = {reference::SamplerKind::uniform, 1, 0};  // every sample at the pixel's centre
  settings.most_bounces = direct ? 0 : 1;
  settings.fog_steps = 4096;
  reference::Film film(job.width_px, job.height_px, {.fog = true});
  film.add(reference::Integrator(world, settings, film.width(), film.height()), samples, [](double) { return true; });

  FogPicture made;
  made.beauty = {film.width(), film.height(), 16, std::vector<std::byte>(film.pixels() * 16)};
  TruePicture truth{film.width(), film.height(), {}, {}, {}};
  for (size_t i = 0; i < film.pixels(); ++i) {
    const glm::vec4 pixel = film.mean(i);
    std::memcpy(made.beauty.bytes.data() + i * 16, &pixel, 16);
    if (!known) continue;
    const glm::dvec2 centre = glm::dvec2(i % size_t(film.width()), i / size_t(film.width())) + 0.5;
    const glm::dvec3 direction = glm::normalize(world.camera_ray(centre, film.width(), film.height()).direction);
    truth.centre.emplace_back(known(direction), pixel.w);  // alpha has no closed form here
  }
  if (known) {
    truth.low = truth.high = truth.centre;
    made.known = std::move(truth);
  }
  const DisplayLook look = display_look(job, {});
  reference::DisplaySettings display{.curve = look.curve, .exposure_ev = look.exposure_ev, .bits = 8};
  made.display = reference::display_image(film, display);
  return made;
}

}  // namespace candela
