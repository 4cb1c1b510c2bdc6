#include "render/traced_frames.h"

#include <bit>
#include <cmath>

#include "image/prepare.h"
#include "image/seal.h"
#include "job/background.h"
#include "job/job_look.h"
#include "job/light_groups.h"
#include "job/picture_camera.h"
#include "job/picture_window.h"
#include "plan/ask_frame.h"
#include "reference/display.h"
#include "render/count_view.h"
#include "render/metadata.h"
#include "render/reference_layers.h"
#include "render/view_picture.h"
#include "session/timings.h"
#include "sky/job_sky.h"
#include "techniques/technique.h"

namespace candela {
namespace fs = std::filesystem;

Expected<void> check_finite(const reference::Film& film, const Job& job) {
  size_t count = 0, first = 0;
  for (size_t i = 0; i < film.pixels(); ++i) {
    const glm::dvec4 m = film.mean(i);
    // As files hold it: what floats cannot hold is as bad as what doubles cannot.
    if (std::isfinite(float(m.x)) && std::isfinite(float(m.y)) && std::isfinite(float(m.z)) &&
        std::isfinite(float(m.w)))
      continue;
    if (count++ == 0) first = i;
  }
  if (count == 0 || job.allow_nonfinite) return {};
  return fail(ErrorKind::nonfinite, "",
              "{} pixels are not finite, the first at x {}, y {} of layer beauty; nothing was written", count,
              first % size_t(film.width()), first / size_t(film.width()));
}

Expected<void> check_metering(const Job& job, const Look& look, bool display) {
  if (picture_window(job).is_whole() || !look.exposure.automatic || !display) return {};
  return fail(ErrorKind::usage, "--region",
              "automatic exposure of the look meters the whole picture, of which only a part is traced; write EXR, or "
              "take a look with a fixed exposure");
}

DisplayImage traced_display(const reference::Film& film, const ReferenceFrame& frame, const Job& job,
                            const std::string& view, const reference::SamplerSettings& sampler) {
  if (view.starts_with("heatmap_"))
    return count_view(reference_counts(film, frame, view), film.width(), film.height(), count_title(view));
  FloatImage layer;
  if (view != "beauty") {
    Job exact = job;
    exact.exr_float = true;
    layer = reference_image(film, frame, exact, "", {view}, {}, {}, sampler);
    // Cryptomatte's channels have numbers behind the name, and a group's name may begin with another's.
    const std::vector<std::string> groups = light_group_layers(job);
    const std::string start = std::ranges::find(groups, view) == groups.end() ? view : view + ".";
    std::erase_if(layer.channels, [&](const Channel& c) { return !c.name.starts_with(start); });
    if (layer_form(view) != LayerForm::light) return layer_view(layer, layer_form(view), view);
  }
  const DisplayLook look = display_look(job, frame.look);
  reference::DisplaySettings display{.curve = look.curve,
                                     .exposure_ev = look.exposure_ev,
                                     .agx_min_ev = look.agx_min_ev,
                                     .agx_max_ev = look.agx_max_ev,
                                     .bits = job.png_bits};
  if (frame.look.exposure.automatic) {
    std::vector<glm::dvec4> pixels;
    for (size_t i = 0; i < film.pixels(); ++i) pixels.push_back(film.mean(i));
    display.exposure_ev += reference::automatic_ev(pixels, *frame.look.exposure.automatic);
  }
  const uint64_t noise = job.seed ^ std::bit_cast<uint64_t>(frame.time_s);
  display.dither = job.dither;
  if (shows_through(job, frame.look)) display.behind_rgb = parse_background(job.background)->display_rgb;
  display.corner_px = film.corner();
  display.alpha = shows_through(job, frame.look) && !display.behind_rgb;
  display.seed = uint32_t(noise ^ (noise >> 32));
  if (view == "beauty") return reference::display_image(film, display);
  display.alpha = false, display.behind_rgb = {};
  std::vector<glm::dvec4> pixels(film.pixels(), glm::dvec4(1));
  for (size_t i = 0; i < pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) pixels[i][c] = double(layer.channels[size_t(c)].f[i]);
  return reference::display_image(pixels, film.width(), display);
}

std::vector<std::string> kept_layers(std::vector<std::string> layers, const std::string& view) {
  if (view != "beauty") layers.push_back(view);
  return layers;
}

BegunFilm begin_film(const Job& job, const ReferenceFrame& frame, const TraceRequest& request,
                     const std::vector<std::string>& layers) {
  reference::FilmParts parts = film_parts(frame, layers);
  parts.light_groups = uint32_t(light_group_layers(job).size());
  parts.terms |= parts.light_groups > 0;
  Hash128 identity = film_identity(job, frame, request.settings, request.accel, parts.terms);
  if (parts.lamp_shadow) identity = hash128(identity.hex() + " shadow_local");
  // Which samples are of which moment depends on their number.
  if (const auto camera = picture_camera(job, frame.look); camera && camera->shutter_s > 0)
    identity = hash128(fmt::format("{} {} spp", identity.hex(), request.stop.spp));
  const PictureWindow window = picture_window(job);
  BegunFilm begun{reference::Film(window.part.width, window.part.height, parts), identity, parts};
  begun.film.place_in({window.width_px, window.height_px}, {window.part.x, window.part.y});
  return begun;
}

Expected<TracedMoments> TracedMoments::open(const ReferenceFrame& frame, const Job& job, const TraceRequest& request) {
  TracedMoments moments;
  moments.frame_ = &frame, moments.job_ = job, moments.request_ = request;
  const auto camera = picture_camera(job, frame.look);
  if (!camera) return std::unexpected(camera.error());
  if (!(camera->shutter_s > 0)) return moments;
  Job drawn = job;
  drawn.technique = Job().technique;
  drawn.settings.push_back({std::string(SubframesKnobs::name), "gather", "0"});
  const GeometryLayout none;
  PlanContext context{frame.scene(), none};
  if (frame.loaded->look) context.look = &*frame.loaded->look;
  const auto frames = subframes_of(drawn, context, frame.time_s);
  if (!frames) return std::unexpected(frames.error());
  for (const Subframe& subframe : *frames)
    if (subframe.role == SubframePart::Role::subframe) moments.times_s_.push_back(subframe.time_s);
  if (request.stop.spp == 0)
    return fail(ErrorKind::usage, "--spp", "an open shutter shares the samples out to {} moments: give their number",
                moments.times_s_.size());
  if (request.stop.spp < moments.times_s_.size()) {
    // As many moments as samples, spread over the shutter.
    std::vector<double> fewer;
    for (uint64_t i = 0; i < request.stop.spp; ++i)
      fewer.push_back(moments.times_s_[(2 * i + 1) * moments.times_s_.size() / (2 * request.stop.spp)]);
    moments.times_s_ = std::move(fewer);
  }
  return moments;
}

reference::Moment TracedMoments::at(uint64_t sample) {
  const uint64_t count = times_s_.size(), spp = request_.stop.spp;
  const auto integrator_of = [&](const ReferenceFrame& frame) {
    const PictureWindow window = picture_window(job_);
    integrator_.emplace(*frame.world, request_.settings, window.width_px, window.height_px);
  };
  if (count == 0) {
    if (!integrator_) integrator_of(*frame_);
    return {&*integrator_};
  }
  // Moment m has samples [m spp / count, (m + 1) spp / count).
  size_t moment = size_t(sample * count / spp);
  while ((moment + 1) * spp / count <= sample) ++moment;
  if (moment != at_) {
    integrator_.reset(), posed_.reset();
    auto posed = pose_reference(frame_->loaded, job_, times_s_[moment], request_.accel, request_.settings.mode);
    if (!posed) {
      error_ = posed.error();
      return {};
    }
    posed_ = std::move(*posed), at_ = moment;
    integrator_of(*posed_);
  }
  return {&*integrator_, (moment + 1) * spp / count};
}

Expected<std::unique_ptr<TracedFrames>> TracedFrames::open(const Job& job, const TraceRequest& request, FrameRate rate,
                                                           const WantedOutputs& wanted) {
  auto loaded = load_reference(job, request.settings.mode);
  if (!loaded) return std::unexpected(loaded.error());
  return std::unique_ptr<TracedFrames>(new TracedFrames(job, request, rate, wanted, std::move(*loaded)));
}

std::string TracedFrames::request_text() const {
  std::string text = settings_json(request_.settings, request_.accel);
  if (request_.stop.spp > 0) text += fmt::format(" {} spp", request_.stop.spp);
  if (request_.stop.noise > 0) text += fmt::format(" noise {}", request_.stop.noise);
  return text;
}

Expected<void> TracedFrames::begin(double time_s) {
  time_s_ = time_s;
  return {};
}

Expected<std::optional<FinishedFrame>> TracedFrames::finish(int64_t number) {
  FinishedFrame finished{.frame = {}, .number = number, .traced = nullptr};
  FrameResult& result = finished.frame;
  StageTimer timer(result.timings, "trace");
  const auto frame = pose_reference(loaded_, job_, time_s_, request_.accel, request_.settings.mode);
  if (!frame) return std::unexpected(frame.error());
  if (auto added = add_time_before(**frame, job_, kept_layers(job_.layers, job_.view)); !added)
    return std::unexpected(added.error());
  result.window = picture_window(job_);
  result.width_px = result.window.part.width, result.height_px = result.window.part.height, result.time_s = time_s_;
  if (auto fine = check_metering(job_, (*frame)->look, wanted_.display); !fine) return std::unexpected(fine.error());
  result.notes = (*frame)->notes, result.warnings = (*frame)->warnings;
  reference::Film film = begin_film(job_, **frame, request_, kept_layers(job_.layers, job_.view)).film;
  auto moments = TracedMoments::open(**frame, job_, request_);
  if (!moments) return std::unexpected(moments.error());
  reference::refine(
      film, [&](uint64_t sample) { return moments->at(sample); }, request_.stop,
      [&](const reference::Progress&) { return !stop_ || stop_->load() == 0; });
  if (moments->error()) return std::unexpected(*moments->error());
  if (stop_ && stop_->load() != 0) return std::nullopt;
  if (auto finite = check_finite(film, job_); !finite) return std::unexpected(finite.error());
  auto picture = std::make_shared<TracedPicture>();
  if (wanted_.linear) {
    picture->linear = reference_image(film, **frame, job_, settings_json(request_.settings, request_.accel),
                                      job_.layers, number, rate_, request_.settings.sampler);
    picture->linear.metadata.push_back(text_entry(identity_name, identity(time_s_, number, rate_)));
    picture->linear.metadata.push_back(text_entry(seal_name.data(), open_seal()));
  }
  if (wanted_.display) picture->display = traced_display(film, **frame, job_, job_.view, request_.settings.sampler);
  finished.traced = std::move(picture);
  return finished;
}

std::string TracedFrames::identity(double time_s, int64_t number, FrameRate rate) const {
  return file_identity(job_, loaded_->content.hex(), traced_technique, request_text(), time_s, number, rate);
}

// The planes, and the file in the making, which is no larger.
uint64_t TracedFrames::bytes_in_hand(const FinishedFrame& finished) const {
  uint64_t bytes = finished.traced->display.pixels.size();
  for (const Channel& channel : finished.traced->linear.channels)
    bytes += channel.f.size() * sizeof(float) + channel.u.size() * sizeof(uint32_t);
  return 2 * bytes;
}

Expected<PreparedOutputs> TracedFrames::prepare(FinishedFrame& finished, FrameRate rate,
                                                const std::vector<fs::path>& paths, bool display_wanted) const {
  StageTimer timer(finished.frame.timings, "encode", "encode");
  const TracedPicture& picture = *finished.traced;
  PreparedOutputs prepared;
  for (const fs::path& path : paths) {
    const auto format = output_format(path);
    if (!format) return std::unexpected(format.error());
    auto file = *format == OutputFormat::exr
                    ? prepare_exr(path, picture.linear, job_.exr_compression)
                    : prepare_png(path, view_of(picture.display),
                                  {{"candela:reference", settings_json(request_.settings, request_.accel)},
                                   {identity_name, identity(finished.frame.time_s, finished.number, rate)},
                                   {std::string(seal_name), open_seal()}});
    if (!file) return std::unexpected(file.error());
    prepared.files.push_back(std::move(*file));
  }
  if (display_wanted) prepared.display = picture.display;
  return prepared;
}

}  // namespace candela
