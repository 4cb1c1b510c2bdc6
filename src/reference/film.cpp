#include "reference/film.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <mutex>

#include "base/files.h"
#include "bvh/trace.h"

namespace candela::reference {
namespace {

constexpr int tile_px = 16;
constexpr char magic[8] = {'c', 'a', 'n', 'd', 'r', 'e', 'f', '2'};

struct FileHead {
  char magic[8];
  Hash128 identity;
  int32_t width, height;
  uint64_t samples;
  Hash128 content;  // of the sums: a file cut short or spoilt is refused
};

// Pixels of a tile that are traced side by side: a square.
constexpr int group_px = 4;
static_assert(group_px * group_px == packet_rays && tile_px % group_px == 0);

}  // namespace

Film::Film(int width_px, int height_px, FilmParts parts)
    : width_(width_px),
      height_(height_px),
      picture_px_(width_px, height_px),
      wants_lamp_shadow_(parts.lamp_shadow),
      wants_traversal_(parts.traversal),
      sums_(size_t(width_px) * size_t(height_px)),
      fog_(parts.fog ? sums_.size() : 0),
      terms_(parts.terms ? sums_.size() : 0),
      group_count_(parts.terms ? parts.light_groups : 0),
      groups_(sums_.size() * group_count_ * 3) {}

glm::dvec3 Film::term(Term term, size_t pixel) const {
  const double* v = terms_.at(pixel).light[size_t(term)];
  return glm::dvec3(v[0], v[1], v[2]) / double(std::max<uint64_t>(samples_, 1));
}

glm::dvec3 Film::light_of_group(uint32_t group, size_t pixel) const {
  const double* v = &groups_.at((pixel * group_count_ + group) * 3);
  return glm::dvec3(v[0], v[1], v[2]) / double(std::max<uint64_t>(samples_, 1));
}

double Film::shadow(size_t pixel) const { return terms_.at(pixel).shadow / double(std::max<uint64_t>(samples_, 1)); }

double Film::occlusion(size_t pixel) const {
  return terms_.at(pixel).occlusion / double(std::max<uint64_t>(samples_, 1));
}

double Film::lamp_shadow(size_t pixel) const {
  return terms_.at(pixel).lamp_shadow / double(std::max<uint64_t>(samples_, 1));
}

glm::dvec3 Film::fog_light(size_t pixel) const {
  if (fog_.empty()) return glm::dvec3(0);
  const double* v = fog_[pixel].light;
  return glm::dvec3(v[0], v[1], v[2]) / double(std::max<uint64_t>(samples_, 1));
}

glm::dvec3 Film::fog_through(size_t pixel) const {
  if (fog_.empty() || samples_ == 0) return glm::dvec3(1);
  const double* v = fog_[pixel].through;
  return glm::dvec3(v[0], v[1], v[2]) / double(samples_);
}

glm::dvec4 Film::mean(size_t pixel) const {
  const double* v = sums_[pixel].value;
  return glm::dvec4(v[0], v[1], v[2], v[3]) / double(std::max<uint64_t>(samples_, 1));
}

glm::dvec3 Film::variance(size_t pixel) const {
  if (samples_ < 2) return glm::dvec3(0);
  const double n = double(samples_);
  glm::dvec3 out;
  for (int c = 0; c < 3; ++c) {
    const double mean = sums_[pixel].value[c] / n;
    out[c] = std::max(sums_[pixel].square[c] / n - mean * mean, 0.0) / (n - 1);
  }
  return out;
}

double Film::traversal(size_t pixel) const { return sums_[pixel].traversal / double(std::max<uint64_t>(samples_, 1)); }

template <class Scale>
double Film::mean_of_halves(Scale&& scale) const {
  if (samples_ < 2) return 0;
  const double n = double(samples_), even_count = double((samples_ + 1) / 2), odd_count = double(samples_ / 2);
  double sum = 0;
  for (const Sums& s : sums_)
    for (int c = 0; c < 3; ++c) {
      const double difference = s.even[c] / even_count - (s.value[c] - s.even[c]) / odd_count;
      sum += difference * difference / 4 / scale(s.value[c] / n);
    }
  return sum / (3 * double(sums_.size()));
}

double Film::mean_square_error() const {
  return mean_of_halves([](double) { return 1.0; });
}

double Film::relative_error() const {
  constexpr double epsilon = 0.01;
  return std::sqrt(mean_of_halves([](double mean) { return mean * mean + epsilon; }));
}

bool Film::add(const Integrator& integrator, int count, const std::function<bool(double)>& keep_going) {
  const int tiles_x = (width_ + tile_px - 1) / tile_px, tiles_y = (height_ + tile_px - 1) / tile_px;
  const int tiles = tiles_x * tiles_y;
  // A batch that is given up must leave the film as it was.
  std::vector<Sums> sums = sums_;
  std::vector<FogSums> fog = fog_;
  std::vector<TermSums> terms = terms_;
  std::vector<double> groups = groups_;
  std::atomic<bool> stopped = false;
  std::mutex reporting;
  int done = 0;
  const auto add_group = [&](glm::ivec2 first) {
    std::vector<glm::ivec2> pixels;
    for (int y = first.y; y < std::min(first.y + group_px, height_); ++y)
      for (int x = first.x; x < std::min(first.x + group_px, width_); ++x) pixels.emplace_back(x, y);
    std::vector<glm::ivec2> places = pixels;
    for (glm::ivec2& place : places) place += corner_px_;
    std::vector<PixelSample> samples(pixels.size());
    std::vector<TermSample> divided;
    for (uint64_t i = samples_; i < samples_ + uint64_t(count); ++i) {
      if (!terms.empty()) divided.assign(pixels.size(), {.wants_lamp_shadow = wants_lamp_shadow_});
      integrator.sample(places, i, wants_traversal_, samples, divided);
      for (size_t k = 0; k < pixels.size(); ++k) {
        const size_t at = size_t(pixels[k].y) * size_t(width_) + size_t(pixels[k].x);
        Sums& pixel = sums[at];
        const PixelSample& s = samples[k];
        for (int c = 0; c < 3; ++c) {
          pixel.value[c] += s.radiance[c];
          pixel.square[c] += s.radiance[c] * s.radiance[c];
          if (i % 2 == 0) pixel.even[c] += s.radiance[c];
        }
        pixel.value[3] += s.alpha;
        pixel.traversal += s.traversal;
        for (int c = 0; c < 3 && !fog.empty(); ++c)
          fog[at].light[c] += s.fog_light[c], fog[at].through[c] += s.fog_through[c];
        if (terms.empty()) continue;
        TermSums& parts = terms[at];
        for (size_t t = 0; t < term_count; ++t)
          for (int c = 0; c < 3; ++c) parts.light[t][c] += divided[k].light[t][c];
        for (uint32_t g = 0; g < group_count_; ++g)
          for (int c = 0; c < 3; ++c) groups[(at * group_count_ + g) * 3 + size_t(c)] += divided[k].by_group[g][c];
        parts.shadow += divided[k].shadow;
        parts.occlusion += divided[k].occlusion;
        parts.lamp_shadow += divided[k].lamp_shadow;
      }
    }
  };
  tbb::parallel_for(0, tiles, [&](int tile) {
    if (stopped) return;
    const int left = tile % tiles_x * tile_px, top = tile / tiles_x * tile_px;
    for (int y = top; y < std::min(top + tile_px, height_); y += group_px)
      for (int x = left; x < std::min(left + tile_px, width_); x += group_px) add_group({x, y});
    const std::lock_guard lock(reporting);
    if (!keep_going(double(++done) / tiles)) stopped = true;
  });
  if (stopped) return false;
  sums_ = std::move(sums);
  fog_ = std::move(fog);
  terms_ = std::move(terms);
  groups_ = std::move(groups);
  samples_ += uint64_t(count);
  return true;
}

Expected<void> Film::save(const std::filesystem::path& path, const Hash128& identity) const {
  FileHead head{};
  std::memcpy(head.magic, magic, 8);
  head.identity = identity;
  head.width = width_, head.height = height_;
  head.samples = samples_;
  std::vector<std::byte> bytes(sizeof head);
  for (const std::span<const std::byte> sums : {std::as_bytes(std::span(sums_)), std::as_bytes(std::span(fog_)),
                                                std::as_bytes(std::span(terms_)), std::as_bytes(std::span(groups_))})
    bytes.insert(bytes.end(), sums.begin(), sums.end());
  head.content = hash128(std::span(bytes).subspan(sizeof head));
  std::memcpy(bytes.data(), &head, sizeof head);
  return write_file_atomically(path, bytes);
}

Expected<Film> Film::load(const std::filesystem::path& path, const Hash128& identity, int width_px, int height_px,
                          FilmParts parts) {
  const auto bytes = read_file(path);
  if (!bytes) return std::unexpected(bytes.error());
  FileHead head{};
  if (bytes->size() >= sizeof head) std::memcpy(&head, bytes->data(), sizeof head);
  if (std::memcmp(head.magic, magic, 8) != 0)
    return fail(ErrorKind::input, path.string(), "is not a state file of candela reference");
  if (head.identity != identity || head.width != width_px || head.height != height_px)
    return fail(
        ErrorKind::input, path.string(),
        "belongs to another picture: scene, camera, size, mode, sampler and all that decides a pixel must be the "
        "same, and so must be whether layers of single terms are asked for");
  Film film(width_px, height_px, parts);
  std::span<const std::byte> body = std::span(*bytes).subspan(sizeof head);
  const std::span<std::byte> all[] = {
      std::as_writable_bytes(std::span(film.sums_)), std::as_writable_bytes(std::span(film.fog_)),
      std::as_writable_bytes(std::span(film.terms_)), std::as_writable_bytes(std::span(film.groups_))};
  if (body.size() != all[0].size() + all[1].size() + all[2].size() || hash128(body) != head.content)
    return fail(ErrorKind::input, path.string(), "is damaged; remove it to begin anew");
  for (const std::span<std::byte> sums : all) {
    std::copy_n(body.begin(), sums.size(), sums.begin());
    body = body.subspan(sums.size());
  }
  film.samples_ = head.samples;
  if (parts.traversal && std::ranges::any_of(film.sums_, [](const Sums& s) { return std::isnan(s.traversal); }))
    return fail(ErrorKind::input, path.string(),
                "was made without the layer heatmap_traversal, which needs the cost of every sample");
  return film;
}

int next_batch(uint64_t samples, const Stop& stop) {
  // Even counts, so that halves are of the same size, growing by a quarter; not so large that an interruption costs
  // much.
  uint64_t batch = std::clamp<uint64_t>(samples / 8 * 2, 2, 16);
  if (stop.spp > 0) batch = std::min(batch, stop.spp - std::min(stop.spp, samples));
  return int(batch);
}

bool refine(Film& film, const Integrator& integrator, const Stop& stop,
            const std::function<bool(const Progress&)>& report, const std::function<void()>& after_batch) {
  return refine(
      film, [&](uint64_t) { return Moment{&integrator}; }, stop, report, after_batch);
}

bool refine(Film& film, const std::function<Moment(uint64_t)>& moment_of, const Stop& stop,
            const std::function<bool(const Progress&)>& report, const std::function<void()>& after_batch) {
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  double error = film.relative_error();
  bool in_time = true;
  const uint64_t first = film.samples();
  // Under a noise target a few samples that happen to agree must not end the work.
  constexpr uint64_t least_for_noise = 16;
  while (true) {
    if (stop.spp > 0 && film.samples() >= stop.spp) return true;
    if (stop.noise > 0 && film.samples() >= least_for_noise && error <= stop.noise) return true;
    if (stop.seconds > 0 && film.samples() > first && seconds() >= stop.seconds) return true;
    const Moment moment = moment_of(film.samples());
    if (!moment.integrator) return false;
    const int count = int(std::min<uint64_t>(uint64_t(next_batch(film.samples(), stop)), moment.end - film.samples()));
    const bool added = film.add(*moment.integrator, count, [&](double done) {
      // The time limit may cut a batch, but for the first: without it there would be no picture.
      in_time = !(stop.seconds > 0) || film.samples() == first || seconds() < stop.seconds;
      return report({film.samples(), stop.spp, done, seconds(), error}) && in_time;
    });
    if (!added) return !in_time;
    error = film.relative_error();
    if (after_batch) after_batch();
  }
}

}  // namespace candela::reference
