#pragma once
#include <filesystem>
#include <functional>
#include <vector>

#include "base/error.h"
#include "base/hash.h"
#include "reference/integrator.h"

namespace candela::reference {

// What a film keeps beside the radiance.
struct FilmParts {
  bool fog = false, terms = false;
  bool lamp_shadow = false;   // with terms
  bool traversal = false;     // costs of camera rays
  uint32_t light_groups = 0;  // with terms: the light of so many groups of lights
};

// Sums over the samples of each pixel, in double, added in the order of the samples: any sharing of the work gives the
// same bytes, and so does an interruption.
class Film {
 public:
  Film(int width_px, int height_px, FilmParts parts = {});
  // The film is a part of a larger picture, which is the integrator's.
  void place_in(glm::ivec2 picture_px, glm::ivec2 corner_px) { picture_px_ = picture_px, corner_px_ = corner_px; }
  glm::ivec2 picture() const { return picture_px_; }
  glm::ivec2 corner() const { return corner_px_; }
  int width() const { return width_; }
  int height() const { return height_; }
  uint64_t samples() const { return samples_; }  // of every pixel

  glm::dvec4 mean(size_t pixel) const;      // premultiplied radiance, alpha
  glm::dvec3 variance(size_t pixel) const;  // of that mean: sample variance over the count; 0 for one sample
  double traversal(size_t pixel) const;     // mean cost of the camera ray; NaN where a sample was not counted
  bool has_fog() const { return !fog_.empty(); }
  glm::dvec3 fog_light(size_t pixel) const;    // mean light of fog, a part of mean(); 0 without fog
  glm::dvec3 fog_through(size_t pixel) const;  // mean transmittance; 1 without fog
  bool has_terms() const { return !terms_.empty(); }
  glm::dvec3 term(Term term, size_t pixel) const;  // mean of one; with fog_light() they sum to mean()
  glm::dvec3 light_of_group(uint32_t group, size_t pixel) const;
  double shadow(size_t pixel) const;       // mean TermSample::shadow
  double occlusion(size_t pixel) const;    // mean TermSample::occlusion
  double lamp_shadow(size_t pixel) const;  // mean TermSample::lamp_shadow
  size_t pixels() const { return size_t(width_) * size_t(height_); }

  // What is left of noise, from two independent halves of the samples: a quarter of the mean squared
  // difference of their means, over all pixels and channels. 0 for fewer than two samples.
  double mean_square_error() const;
  // The same with every difference taken relative to the pixel's value, its square plus 0.01 as in relMSE, and the root
  // of it: what
  // --noise asks for. Its square is the floor below which a relMSE against this film says nothing.
  double relative_error() const;

  // Adds samples [samples(), samples() + count) of every pixel. keep_going is asked after every tile and may stop the
  // work: then nothing of this call counts and the answer is false.
  bool add(const Integrator& integrator, int count, const std::function<bool(double done)>& keep_going);

  // The file that a later run goes on from. `identity` says which picture and settings it belongs to.
  Expected<void> save(const std::filesystem::path& path, const Hash128& identity) const;
  static Expected<Film> load(const std::filesystem::path& path, const Hash128& identity, int width_px, int height_px,
                             FilmParts parts = {});

 private:
  struct Sums {
    double value[4] = {}, square[3] = {}, even[3] = {}, traversal = 0;
  };
  struct FogSums {
    double light[3] = {}, through[3] = {};
  };
  struct TermSums {
    double light[term_count][3] = {}, shadow = 0, occlusion = 0, lamp_shadow = 0;
  };
  // The mean over pixels and channels of a quarter of the squared difference of the halves over scale(mean).
  template <class Scale>
  double mean_of_halves(Scale&& scale) const;

  int width_, height_;
  glm::ivec2 picture_px_, corner_px_{0};
  bool wants_lamp_shadow_, wants_traversal_;
  uint64_t samples_ = 0;
  std::vector<Sums> sums_;
  std::vector<FogSums> fog_;     // empty: none
  std::vector<TermSums> terms_;  // empty: none
  uint32_t group_count_;
  std::vector<double> groups_;  // three for each group of a pixel
};

// How long a film is made better. Every limit may be given; the first that is reached ends the work.
struct Stop {
  uint64_t spp = 0;    // 0: no limit
  double seconds = 0;  // 0: no limit; at least one batch is made
  double noise = 0;    // 0: no limit; Film::relative_error()
};
struct Progress {
  uint64_t samples = 0, of_samples = 0;  // of_samples 0: not known
  double done = 0;                       // of the batch in hand
  double seconds = 0, relative_error = 0;
};
// Counts at which limits are looked at: they depend on the count alone, so a noise target ends at the same count on
// every machine and after every interruption.
int next_batch(uint64_t samples, const Stop& stop);
// report is called often, from one thread at a time, and returns false to stop early; the batch in hand is then given
// up. after_batch may save. Returns whether a limit was reached.
bool refine(Film& film, const Integrator& integrator, const Stop& stop,
            const std::function<bool(const Progress&)>& report, const std::function<void()>& after_batch = {});
// The same where samples are of different moments. integrator_of: for samples from that one on, up to `end`; null ends
// the work.
struct Moment {
  const Integrator* integrator = nullptr;
  uint64_t end = std::numeric_limits<uint64_t>::max();
};
bool refine(Film& film, const std::function<Moment(uint64_t sample)>& moment_of, const Stop& stop,
            const std::function<bool(const Progress&)>& report, const std::function<void()>& after_batch = {});

}  // namespace candela::reference
