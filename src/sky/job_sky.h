#pragma once
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/hash.h"
#include "image/io.h"
#include "job/job.h"
#include "look/look.h"
#include "scene/atmosphere.h"
#include "scene/environment.h"
#include "scene/frame_data.h"
#include "scene/scene.h"
#include "sky/sky_sun.h"

namespace candela {

// An equirectangular image (scene/environment.h) that skies are made of.
struct SkyImage {
  DecodedImage image;  // rgba32f, wide ones rgba16f; without the sun that is taken out of it
  // What is filtered instead, of skies so smooth that fewer texels hold what surfaces reflect.
  std::optional<DecodedImage> coarse;
  const DecodedImage& to_filter() const { return coarse ? *coarse : image; }
  AmbientSh sh{};
  Hash128 content;
  bool passing = false;  // of one moment: not worth room on disk
  // Taken out: it shines as a light, and the background shows the texels as they were.
  std::optional<SkySun> sun;
  std::vector<SkyTexelBefore> sun_texels;
};
struct SkyPart {
  std::shared_ptr<const SkyImage> image;
  glm::vec3 weight{1};
  bool of_gradient = false;  // one of the three bands of FrameSky::gradient
};

// The sky of one frame: a sum of images of one size. Everything that is made of a sky is linear in it, so the sum of
// what was made of the parts is that of the sky: nothing is filtered again when weights alone change.
struct FrameSky {
  std::vector<SkyPart> parts;  // empty: no sky
  double rotation_deg = 0, intensity = 1, blur_deg = 0;
  // For the reference, which knows its formula.
  std::optional<SkyGradient> gradient;
  double gradient_weight = 0;
  bool studio = false;  // scene/studio.h: lights and is mirrored, and is no background
  // Taken out of its images, as the world has them: towards it, its illuminance, and the radius of its disc.
  struct Sun {
    glm::dvec3 direction{0, 1, 0}, illuminance{0};
    double radius_rad = 0;
  };
  std::vector<Sun> suns;
  bool shows_suns = true;  // the background does; not that of a probe, whose surfaces have them as lights
  explicit operator bool() const { return !parts.empty(); }
  bool is_plain() const { return parts.size() == 1 && parts[0].weight == glm::vec3(1); }
  AmbientSh ambient() const;  // turned, times intensity
  Hash128 key() const;        // of parts and weights
};
DecodedImage sum_of(const std::vector<SkyPart>& parts);
void sum_of(const std::vector<SkyPart>& parts, std::span<std::byte> texels);  // as large as an image of the parts
// The same as the background shows it, with its suns.
DecodedImage seen_sum_of(const std::vector<SkyPart>& parts);

// Whether the job has a sky that is seen, whatever the time: the studio is not.
bool has_sky(const Job& job, const Look& look);
// Whether pictures are transparent where nothing is: by the job and not by the pixels, so that all frames of a sequence
// have the same channels.
bool shows_through(const Job& job, const Look& look);
// The files that its sky is read from, and the error (input) of a name that a look may not name.
Expected<std::vector<std::string>> sky_files(const Job& job, const Look& look);

// A job's sky: what is read and made once, and each frame's sum of it.
class JobSky {
 public:
  // Images are charged on top of the scene's (base/input.h). look: at any time; says which skies there are.
  static Expected<JobSky> read(const Job& job, const Look& look, const Scene& scene,
                               std::vector<std::string>& warnings);
  // The same, its warnings logged.
  static Expected<JobSky> read_logged(const Job& job, const Look& look, const Scene& scene);
  // notes: suns that are lights, and what the look asks for and the scene does not have.
  FrameSky at(const Look& look, const FrameData& data, std::vector<std::string>& notes) const;

 private:
  enum class First : uint8_t { none, image, gradient, atmosphere, studio };
  std::shared_ptr<const SkyImage> gradient_band(int band, double exponent) const;
  std::shared_ptr<const SkyImage> air_image(const Atmosphere& air, glm::dvec3 to_sun) const;
  void add_suns(FrameSky& sky, const Look& look, std::vector<std::string>& notes) const;
  void keep(std::string key, std::shared_ptr<const SkyImage> image) const;

  First first_ = First::none;
  std::shared_ptr<const SkyImage> image_, second_;
  bool for_want_of_light_ = false;  // the studio, taken without being asked for
  int width_ = 0, height_ = 0;      // of all parts
  // Images by what they are made from, the newest last; a few, so that frames in any order find theirs.
  mutable std::vector<std::pair<std::string, std::shared_ptr<const SkyImage>>> made_;
  mutable std::shared_ptr<const Air> air_;
  mutable std::string air_key_;
};

// Suns that were taken out of a sky's images shine as lights of the scene do.
void add_sky_suns(const FrameSky& sky, FrameData& data);

// Every directional light is a disc as wide as the look says; where it says nothing, those of the sky as wide as they
// are.
void size_suns(const Look& look, FrameData& data);

// The direction towards the first directional light; absent where there is none.
std::optional<glm::dvec3> first_sun(const FrameData& data);

}  // namespace candela
