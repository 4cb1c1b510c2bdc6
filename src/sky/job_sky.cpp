#include "sky/job_sky.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <span>

#include "base/check.h"
#include "base/input.h"
#include "base/log.h"
#include "base/scratch.h"
#include "image/cube_faces.h"
#include "image/environment_file.h"
#include "image/sky_rows.h"
#include "image/sky_texel.h"
#include "job/background.h"
#include "scene/atmosphere.h"
#include "scene/gradient_sky.h"
#include "scene/neutral_light.h"
#include "scene/scene_images.h"
#include "scene/studio.h"
#include "sky/sky_pyramid.h"

namespace candela {
namespace {

namespace fs = std::filesystem;

enum class Source : uint8_t { none, file, gradient, atmosphere, studio };

// What comes first: the command line, then the look.
Source source_of(const Job& job, const Look& look) {
  if (job.sky == "none") return Source::none;
  if (job.sky == "atmosphere") return Source::atmosphere;
  if (job.sky == studio_sky) return Source::studio;
  if (job.sky == neutral_sky) return Source::none;
  if ((!job.sky.empty() && job.sky != auto_sky) || !look.sky.image.empty()) return Source::file;
  return look.sky.gradient ? Source::gradient : look.sky.atmosphere ? Source::atmosphere : Source::none;
}
bool has_second(const Job& job, const Look& look) {
  return look.sky.second && job.sky != "none" && job.sky != studio_sky && job.sky != neutral_sky;
}

// What --sky auto gives files without any light, whatever is lit at a time.
bool wants_studio(const Job& job, const Look& look, const Scene& scene) {
  if (job.sky != auto_sky || job.effects == "none" || source_of(job, look) != Source::none || has_second(job, look) ||
      has_light(scene))
    return false;
  const auto takes_light = [&](const MeshSection& section) {
    return section.material < 0 || !scene.materials[size_t(section.material)].unlit;
  };
  return std::ranges::any_of(scene.meshes,
                             [&](const Mesh& mesh) { return std::ranges::any_of(mesh.sections, takes_light); });
}

// A file that the look names, from the look's folder.
Expected<std::string> named_by_look(const Job& job, const std::string& name) {
  const fs::path folder = fs::path(job.look).parent_path(), file = folder / name;
  std::vector<fs::path> files = {file};
  if (names_cube_faces(file)) {
    const auto faces = cube_face_files(file);
    if (!faces) return std::unexpected(faces.error());
    files.assign(faces->begin(), faces->end());
  }
  for (const fs::path& one : files)
    if (auto allowed = check_named_file(one, folder.empty() ? "." : folder, job.look); !allowed)
      return fail(ErrorKind::input, job.look + ": /sky", "{}", allowed.error().message);
  return file.string();
}

// Half the texels each way.
DecodedImage halved(const DecodedImage& image) {
  const SkyLevel half = std::move(sky_pyramid(sky_level(image))[1]);
  DecodedImage out{half.width, half.height, DecodedImage::Format::rgba32f, 3, {}};
  const auto bytes = std::as_bytes(std::span(half.texels));
  out.pixels.assign(bytes.begin(), bytes.end());
  return out;
}

std::shared_ptr<SkyImage> as_part(DecodedImage image, std::optional<DecodedImage> coarse = {}, bool passing = false) {
  auto part = std::make_shared<SkyImage>();
  part->coarse = std::move(coarse), part->passing = passing;
  part->sh = project_environment(image);
  part->content = hash128(fmt::format("{}x{} {}", image.width, image.height, hash128(image.pixels).hex()));
  part->image = std::move(image);
  return part;
}

constexpr float most_half = 65504;

// Wide skies are kept in half floats, which are within 2^-11 of each texel, unless they do not hold all of them: bright
// ones beyond their range, or so dark ones that the sum of all errors is more than 2^-11 of the sky.
DecodedImage narrowed(DecodedImage image) {
  if (image.width <= most_sky_width / 2) return image;
  DecodedImage out{image.width, image.height, DecodedImage::Format::rgba16f, image.source_channels, {}};
  out.pixels.resize(image.pixels.size() / 2);
  struct Row {
    double sum = 0, error = 0;
    bool beyond = false;
  };
  std::vector<Row> rows(size_t(image.height));
  tbb::parallel_for(0, image.height, [&](int y) {
    Row& row = rows[size_t(y)];
    const size_t first = size_t(y) * size_t(image.width) * 4;
    const auto* from = reinterpret_cast<const float*>(image.pixels.data()) + first;
    auto* to = reinterpret_cast<uint16_t*>(out.pixels.data()) + first;
    for (size_t i = 0; i < size_t(image.width) * 4; ++i) {
      to[i] = float_to_half(from[i]);
      row.beyond |= from[i] > most_half;
      if (i % 4 < 3) row.sum += double(from[i]), row.error += std::abs(double(half_to_float(to[i])) - double(from[i]));
    }
  });
  Row all;
  for (const Row& row : rows) all.sum += row.sum, all.error += row.error, all.beyond |= row.beyond;
  return all.beyond || all.error > all.sum / 2048 ? std::move(image) : std::move(out);
}

// As the background shows a single sky of half floats, where they hold its sun.
std::optional<DecodedImage> seen_as_halves(const std::vector<SkyPart>& parts) {
  const SkyImage& sky = *parts[0].image;
  if (parts.size() != 1 || parts[0].weight != glm::vec3(1) || sky.image.format != DecodedImage::Format::rgba16f ||
      std::ranges::any_of(sky.sun_texels, [](const SkyTexelBefore& before) {
        return glm::any(glm::greaterThan(before.radiance, glm::vec3(most_half)));
      }))
    return {};
  DecodedImage out = sky.image;
  auto* halves = reinterpret_cast<uint16_t*>(out.pixels.data());
  for (const SkyTexelBefore& before : sky.sun_texels)
    for (int c = 0; c < 3; ++c) halves[4 * size_t(before.place) + size_t(c)] = float_to_half(before.radiance[c]);
  return out;
}

size_t texel_count(const DecodedImage& image) { return size_t(image.width) * size_t(image.height); }

// Decided by the image alone, and so once for all frames. Without word of the look what is a sun by its light, contrast
// and size; asked for, the brightest spot that is narrow enough.
std::shared_ptr<const SkyImage> as_part_without_sun(DecodedImage image, std::optional<bool> wanted) {
  std::optional<SkySun> sun = wanted.value_or(true) ? find_sun(image) : std::nullopt;
  if (!sun || !(wanted ? sun->is_narrow() : sun->is_sun())) return as_part(narrowed(std::move(image)));
  std::vector<SkyTexelBefore> before = take_sun(image, *sun);
  const std::shared_ptr<SkyImage> part = as_part(narrowed(std::move(image)));
  part->content = hash128(fmt::format("{} {}", part->content.hex(), hash128(std::as_bytes(std::span(before))).hex()));
  part->sun = std::move(sun), part->sun_texels = std::move(before);
  return part;
}

glm::vec4 texel(const DecodedImage& image, int x, int y) {
  x = (x % image.width + image.width) % image.width;
  y = std::clamp(y, 0, image.height - 1);
  glm::vec4 t;
  std::memcpy(&t, image.pixels.data() + (size_t(y) * size_t(image.width) + size_t(x)) * 16, 16);
  return t;
}

// Bilinear, to more texels.
DecodedImage enlarged(DecodedImage image, int width, int height) {
  if (image.width == width && image.height == height) return image;
  DecodedImage out{width, height, DecodedImage::Format::rgba32f, 3, {}};
  out.pixels.resize(size_t(width) * size_t(height) * 16);
  tbb::parallel_for(0, height, [&](int y) {
    const double v = (y + 0.5) / height * image.height - 0.5;
    const int y0 = int(std::floor(v));
    for (int x = 0; x < width; ++x) {
      const double u = (x + 0.5) / width * image.width - 0.5;
      const int x0 = int(std::floor(u));
      const float fx = float(u - x0), fy = float(v - y0);
      const glm::vec4 t = glm::mix(glm::mix(texel(image, x0, y0), texel(image, x0 + 1, y0), fx),
                                   glm::mix(texel(image, x0, y0 + 1), texel(image, x0 + 1, y0 + 1), fx), fy);
      std::memcpy(out.pixels.data() + (size_t(y) * size_t(width) + size_t(x)) * 16, &t, 16);
    }
  });
  return out;
}

constexpr double degree = std::numbers::pi / 180;

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace

AmbientSh FrameSky::ambient() const {
  if (is_plain()) return turned(parts[0].image->sh, glm::radians(rotation_deg), intensity);
  AmbientSh sum{};
  for (const SkyPart& part : parts)
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += part.weight * part.image->sh[i];
  return turned(sum, glm::radians(rotation_deg), intensity);
}

Hash128 FrameSky::key() const {
  Scratch scratch;
  ScratchVector<uint64_t> words(&scratch);
  for (const SkyPart& part : parts) {
    for (const uint64_t word : {part.image->content.lo, part.image->content.hi}) words.push_back(word);
    for (int c = 0; c < 3; ++c) words.push_back(std::bit_cast<uint64_t>(double(part.weight[c])));
  }
  return hash128(std::as_bytes(std::span(words)));
}

DecodedImage sum_of(const std::vector<SkyPart>& parts) {
  const DecodedImage& first = parts.front().image->image;
  DecodedImage out{first.width, first.height, DecodedImage::Format::rgba32f, 3, {}};
  out.pixels.resize(texel_count(first) * sizeof(SkyTexel));
  sum_of(parts, out.pixels);
  return out;
}

void sum_of(const std::vector<SkyPart>& parts, std::span<std::byte> texels) {
  const size_t count = texels.size() / sizeof(SkyTexel);
  for (const SkyPart& part : parts) CHECK(texel_count(part.image->image) == count);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 4096), [&](const auto& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      SkyTexel sum{};
      for (const SkyPart& part : parts)
        sum += SkyTexel{part.weight.x, part.weight.y, part.weight.z, 0} * sky_texel(part.image->image, i);
      sum[3] = 1;
      std::memcpy(texels.data() + i * sizeof sum, &sum, sizeof sum);
    }
  });
}

DecodedImage seen_sum_of(const std::vector<SkyPart>& parts) {
  if (const auto halves = seen_as_halves(parts)) return *halves;
  DecodedImage out = sum_of(parts);
  const auto texel_of = [&](uint32_t place) { return out.pixels.data() + size_t(place) * 16; };
  for (const SkyPart& part : parts)
    for (const SkyTexelBefore& before : part.image->sun_texels) {
      const SkyTexel texel = sky_texel(part.image->image, before.place);
      const glm::vec3 left(texel[0], texel[1], texel[2]);
      glm::vec3 sum;
      std::memcpy(&sum, texel_of(before.place), 12);
      sum = parts.size() == 1 ? part.weight * before.radiance : sum + part.weight * (before.radiance - left);
      std::memcpy(texel_of(before.place), &sum, 12);
    }
  return out;
}

bool has_sky(const Job& job, const Look& look) {
  const Source source = source_of(job, look);
  return (source != Source::none && source != Source::studio) || has_second(job, look);
}
bool shows_through(const Job& job, const Look& look) {
  const auto background = parse_background(job.background);
  return background && background->transparent() && !has_sky(job, look);
}

Expected<std::vector<std::string>> sky_files(const Job& job, const Look& look) {
  std::vector<std::string> files;
  if (source_of(job, look) == Source::file) {
    if (!job.sky.empty() && job.sky != auto_sky) {
      files.push_back(job.sky);
    } else {
      const auto file = named_by_look(job, look.sky.image);
      if (!file) return std::unexpected(file.error());
      files.push_back(*file);
    }
  }
  if (has_second(job, look)) {
    const auto file = named_by_look(job, look.sky.second->image);
    if (!file) return std::unexpected(file.error());
    files.push_back(*file);
  }
  return files;
}

Expected<JobSky> JobSky::read_logged(const Job& job, const Look& look, const Scene& scene) {
  std::vector<std::string> warnings;
  auto sky = read(job, look, scene, warnings);
  for (const std::string& warning : warnings) log::warning("{}", warning);
  return sky;
}

Expected<JobSky> JobSky::read(const Job& job, const Look& look, const Scene& scene,
                              std::vector<std::string>& warnings) {
  JobSky sky;
  sky.for_want_of_light_ = wants_studio(job, look, scene);
  const Source source = sky.for_want_of_light_ ? Source::studio : source_of(job, look);
  sky.first_ = First(source);
  const auto files = sky_files(job, look);
  if (!files) return std::unexpected(files.error());
  auto bytes = files->empty() ? Expected<uint64_t>(0) : decoded_bytes(scene);
  if (!bytes) return std::unexpected(bytes.error());
  std::vector<DecodedImage> images;
  for (const std::string& file : *files) {
    auto image = read_environment(file, warnings, *bytes);
    if (!image) return std::unexpected(image.error());
    *bytes += sky_bytes(image->width, image->height);
    sky.width_ = std::max(sky.width_, image->width), sky.height_ = std::max(sky.height_, image->height);
    images.push_back(std::move(*image));
  }
  const auto part = [&](DecodedImage& image) {
    return as_part_without_sun(enlarged(std::move(image), sky.width_, sky.height_), look.sky.extract_sun);
  };
  if (source == Source::file) sky.image_ = part(images.front());
  if (has_second(job, look)) sky.second_ = part(images.back());
  // Without images: gradients do not depend on the longitude, and air is smooth but for the horizon.
  if (images.empty() && source == Source::gradient) sky.width_ = 4, sky.height_ = 512;
  if (images.empty() && source == Source::atmosphere) sky.width_ = atmosphere_width, sky.height_ = atmosphere_width / 2;
  if (source == Source::studio) {
    sky.width_ = 512, sky.height_ = 256;  // five texels across the narrowest edge
    sky.image_ = as_part(studio_image(sky.width_, sky.height_));
  }
  return sky;
}

void add_sky_suns(const FrameSky& sky, FrameData& data) {
  for (const FrameSky::Sun& sun : sky.suns) {
    LightItem light{};
    light.type = LightType::directional;
    light.direction = glm::vec3(-sun.direction);
    light.intensity = glm::vec3(sun.illuminance);
    light.range_m = std::numeric_limits<float>::infinity();
    light.radius_rad = sun.radius_rad;
    data.lights.push_back(light);
  }
}

void size_suns(const Look& look, FrameData& data) {
  if (!look.sun) return;
  for (LightItem& light : data.lights)
    if (light.type == LightType::directional) light.radius_rad = glm::radians(look.sun->angular_radius_deg);
}

std::optional<glm::dvec3> first_sun(const FrameData& data) {
  if (!data.first_sun) return std::nullopt;
  return -glm::normalize(glm::dvec3(data.first_sun->direction));
}

std::shared_ptr<const SkyImage> JobSky::gradient_band(int band, double exponent) const {
  const std::string key = fmt::format("gradient {} {:a}", band, exponent);
  for (const auto& [made, image] : made_)
    if (made == key) return image;
  std::optional<DecodedImage> coarse;
  if (!second_) coarse = gradient_image(band, exponent, width_, height_ / 4);
  keep(key, as_part(gradient_image(band, exponent, width_, height_), std::move(coarse)));
  return gradient_band(band, exponent);
}

// One lux of sun above the air; the newest images are kept by what they show.
std::shared_ptr<const SkyImage> JobSky::air_image(const Atmosphere& a, glm::dvec3 to_sun) const {
  const std::string air = fmt::format("{:a} {:a} {:a} {:a}", a.haze, a.ozone, a.ground_albedo, a.altitude_m);
  const std::string key = fmt::format("air {} {:a} {:a} {:a}", air, to_sun.x, to_sun.y, to_sun.z);
  for (const auto& [made, image] : made_)
    if (made == key) return image;
  if (!air_ || air_key_ != air) air_ = std::make_shared<Air>(a), air_key_ = air;
  const int width = std::min(width_, atmosphere_width);
  DecodedImage image = air_->image(to_sun, width, width / 2);
  std::optional<DecodedImage> coarse;
  if (!second_) coarse = halved(image);  // with an image beside it both are filtered alike
  keep(key, as_part(enlarged(image, width_, height_), std::move(coarse), true));
  return air_image(a, to_sun);
}

void JobSky::keep(std::string key, std::shared_ptr<const SkyImage> image) const {
  made_.emplace_back(std::move(key), std::move(image));
  constexpr size_t most = 12;
  if (made_.size() > most) made_.erase(made_.begin());
}

// By what the image says alone, so that all frames of a film say the same.
void JobSky::add_suns(FrameSky& sky, const Look& look, std::vector<std::string>& notes) const {
  for (const SkyPart& part : sky.parts) {
    const bool is_first = part.image == image_;
    const std::string_view whose = is_first ? "the sky image" : "the second sky image";
    const std::optional<SkySun>& sun = part.image->sun;
    if (!sun) {
      if (look.sky.extract_sun.value_or(false))
        notes.push_back(
            fmt::format("{} has no spot that is bright and narrow enough for a sun: none is taken out", whose));
      continue;
    }
    notes.push_back(
        fmt::format("{}'s sun is a directional light: {:.1f} degrees up, {:.2f} wide, {:.0f} % of the light on a "
                    "surface that faces "
                    "it (sky.extract_sun of the look: false leaves it in the image)",
                    whose, glm::degrees(std::asin(glm::clamp(sun->direction.y, -1.0, 1.0))),
                    glm::degrees(2 * sun->radius_rad), 100 * sun->share));
    const double turn = glm::radians(sky.rotation_deg), c = std::cos(turn), s = std::sin(turn);
    const glm::dvec3 d = sun->direction;
    const glm::dvec3 illuminance = glm::dvec3(part.weight) * sky.intensity * sun->illuminance;
    if (illuminance != glm::dvec3(0))
      sky.suns.push_back({{c * d.x + s * d.z, d.y, c * d.z - s * d.x}, illuminance, sun->radius_rad});
  }
}

FrameSky JobSky::at(const Look& look, const FrameData& data, std::vector<std::string>& notes) const {
  FrameSky sky;
  sky.rotation_deg = look.sky.rotation_deg, sky.intensity = look.sky.intensity, sky.blur_deg = look.sky.blur_deg;
  const std::optional<glm::dvec3> sun = first_sun(data);
  float first = 1;
  if (second_ && look.sky.second) {
    const SecondSky& second = *look.sky.second;
    double weight = second.weight;
    if (second.follows_sun) {
      if (!sun)
        notes.emplace_back("the second sky follows the sun, and the scene has no directional light: its weight is 0");
      weight =
          sun ? 1 - smoothstep(second.from_deg, second.to_deg, glm::degrees(std::asin(glm::clamp(sun->y, -1., 1.))))
              : 0;
    }
    first = float(1 - weight);
    if (weight > 0 || first_ == First::none)
      sky.parts.push_back({second_, glm::vec3(float(weight * second.intensity))});
  }
  if (first > 0 && first_ == First::image) sky.parts.insert(sky.parts.begin(), {image_, glm::vec3(first)});
  add_suns(sky, look, notes);
  if (!(first > 0)) return sky;
  if (first_ == First::studio) {
    sky.parts.insert(sky.parts.begin(), {image_, glm::vec3(first)});
    sky.studio = true;
    if (for_want_of_light_)
      notes.emplace_back(
          "the file has neither lights nor a sky: a studio lights it (--sky FILE, or none for no light)");
  }
  if (first_ == First::gradient) {
    const SkyGradient& g = look.sky.gradient ? *look.sky.gradient : SkyGradient{};
    const glm::dvec3 colors[] = {g.zenith, g.horizon, g.ground};
    for (int band = 0; band < 3; ++band)
      sky.parts.push_back({gradient_band(band, g.exponent), first * glm::vec3(colors[band]), true});
    sky.gradient = g, sky.gradient_weight = first;
  }
  if (first_ == First::atmosphere) {
    const Atmosphere air = look.sky.atmosphere.value_or(Atmosphere{});
    if (!sun)
      notes.emplace_back(
          "the scene has no directional light: the sky is that of a sun of 10 lux, 35 degrees up towards +X, and "
          "lights "
          "the scene alone");
    // The image's sun stands above its middle, and the image is turned, so that a sun that goes round costs nothing.
    glm::dvec3 to_sun = sun.value_or(glm::dvec3(std::cos(35 * degree), std::sin(35 * degree), 0));
    const double across = std::hypot(to_sun.x, to_sun.z);
    const double azimuth_deg = across > 1e-9 ? glm::degrees(std::atan2(-to_sun.z, to_sun.x)) : 0;
    if (second_) {
      const double by = glm::radians(azimuth_deg - sky.rotation_deg);  // another image turns with it
      to_sun = {across * std::cos(by), to_sun.y, -across * std::sin(by)};
    } else {
      sky.rotation_deg = azimuth_deg;
      to_sun = {across, to_sun.y, 0};
    }
    const glm::dvec3 lux =
        air.sun_lux.value_or(data.first_sun ? glm::dvec3(data.first_sun->intensity) : glm::dvec3(10));
    sky.parts.push_back({air_image(air, to_sun), first * glm::vec3(lux)});
  }
  return sky;
}

}  // namespace candela
