#include "bench/error_parts.h"

#include <array>
#include <memory>

#include "base/log.h"
#include "bench/edges.h"
#include "metrics/numeric.h"
#include "passes/surfaces/terms.h"
#include "render/outputs.h"
#include "render/reference_layers.h"

namespace candela {
namespace {

using Colour = std::array<const std::vector<float>*, 3>;

// Empty pointers where the image has no such layer.
Colour colour_of(const FloatImage& image, const std::string& layer) {
  Colour colour{};
  for (size_t c = 0; c < 3; ++c) {
    const Channel* channel = image.find(layer.empty() ? std::string(1, "RGB"[c]) : layer + "." + "RGB"[c]);
    if (!channel) return {};
    colour[c] = &channel->f;
  }
  return colour;
}

// Shares of light that arrive, and the terms that they dim.
struct Share {
  const char *layer, *term, *part;
};
constexpr Share shares[] = {{"shadow_sun", "direct_sun", "shadow.direct_sun"},
                            {"shadow_local", "direct_point", "shadow.direct_point"},
                            {"shadow_local", "direct_spot", "shadow.direct_spot"},
                            {"occlusion", "ambient_diffuse", "occlusion"}};

// Of a term's error what comes from a fraction: the fraction's error times the term without it, which is known best
// where more of it arrives.
double error_of_share(double true_fraction, double fraction, double truth, double value) {
  if (true_fraction == fraction) return 0;
  return (fraction - true_fraction) * (true_fraction > fraction ? truth / true_fraction : value / fraction);
}

}  // namespace

std::vector<std::string> gpu_part_layers() {
  std::vector<std::string> names = edge_layers();
  for (const LayerName& term : Terms::layers) names.emplace_back(term.name);
  for (const char* fraction : {"shadow_sun", "shadow_local", "occlusion"}) names.emplace_back(fraction);
  return names;
}

std::vector<std::string> reference_part_layers(bool with_air) {
  std::vector<std::string> names = edge_layers();
  for (const std::string& term : term_layer_names())
    if (with_air || term != "volumetric") names.push_back(term);
  if (with_air) names.emplace_back("fog");
  return names;
}

std::map<std::string, double> error_parts(const FloatImage& reference, const FloatImage& picture) {
  const Edges edges(reference);
  const Colour beauty = colour_of(reference, {}), seen = colour_of(picture, {});
  if (!edges.known() || !beauty[0] || !seen[0] || reference.width != picture.width ||
      reference.height != picture.height)
    return {};
  struct Term {
    Colour reference, picture;
    double* sum;
    const std::vector<float>*true_fraction = nullptr, *fraction = nullptr;  // null: 1 everywhere
    double* share_sum = nullptr;                                            // null: nothing dims the term
  };
  std::map<std::string, double> parts;
  double &all = parts["part.all"], &at_edges = parts["part.edges"];
  std::vector<Term> terms;
  for (const std::string& name : reference_part_layers(true))
    if (const Colour colour = colour_of(reference, name); colour[0]) {
      Term& term = terms.emplace_back(colour, colour_of(picture, name), &parts["part." + name]);
      for (const Share& fraction : shares) {
        const Channel *truth = reference.find(fraction.layer + std::string(".Y")),
                      *seen_fraction = picture.find(fraction.layer + std::string(".Y"));
        if (name != fraction.term || (!truth && !seen_fraction)) continue;
        term.true_fraction = truth ? &truth->f : nullptr, term.fraction = seen_fraction ? &seen_fraction->f : nullptr;
        term.share_sum = &parts[std::string("part.") + fraction.part];
      }
    }
  if (terms.empty()) return {};
  for (int y = 0; y < reference.height; ++y)
    for (int x = 0; x < reference.width; ++x) {
      const size_t i = size_t(y) * size_t(reference.width) + size_t(x);
      const bool edge = edges.at(x, y);
      for (size_t c = 0; c < 3; ++c) {
        const double truth = (*beauty[c])[i], scale = truth * truth + relmse_epsilon, d = (*seen[c])[i] - truth;
        if (!std::isfinite(d / scale)) continue;
        all += d * d / scale;
        if (edge) {
          at_edges += d * d / scale;
          continue;
        }
        for (const Term& term : terms) {
          const double of_reference = (*term.reference[c])[i], value = term.picture[0] ? (*term.picture[c])[i] : 0.0f;
          double rest = value - of_reference;
          if (term.share_sum) {
            const double of_fraction = error_of_share(term.true_fraction ? (*term.true_fraction)[i] : 1.0f,
                                                      term.fraction ? (*term.fraction)[i] : 1.0f, of_reference, value);
            *term.share_sum += of_fraction * of_fraction / scale;
            rest -= of_fraction;
          }
          *term.sum += rest * rest / scale;
        }
      }
    }
  for (auto& [name, sum] : parts) sum /= 3 * double(reference.width) * double(reference.height);
  return parts;
}

void divide_errors(std::span<BenchRow> rows, std::span<const Job> jobs, double time_s, std::span<const Truth> truths,
                   const RunSettings& settings, const std::function<bool()>& stop) {
  std::map<std::string, std::shared_ptr<const FloatImage>> exact;  // by technique
  for (size_t i = 0; i < rows.size(); ++i) {
    BenchRow& row = rows[i];
    if (jobs[i].scene.empty() || (stop && stop())) continue;
    auto made = picture_with_parts(jobs[i], time_s, settings);
    if (!made) {
      log::warning("{}: its error is not divided: {}", row_title(row), made.error().text());
      continue;
    }
    const auto picture = std::make_shared<const FloatImage>(std::move(*made));
    if (row.quality == "exact") exact[row.technique] = picture;
    for (const SameWork& same : row.same_work)
      if (same.suite == "whole" && same.quality == "exact") exact[same.technique] = picture;
    for (PictureError& error : row.errors) {
      if (error.metrics.empty()) continue;
      if (error.reference == exact_reference) {
        const auto own = exact.find(row.technique);
        if (own != exact.end()) error.metrics.merge(error_parts(*own->second, *picture));
      } else if (const auto own = std::ranges::find(truths, error.reference, &Truth::name); own != truths.end()) {
        error.metrics.merge(error_parts(own->divided, *picture));
      }
    }
  }
}

Expected<FloatImage> picture_with_parts(Job job, double time_s, const RunSettings& settings) {
  job.layers = gpu_part_layers();
  if (!job.look.empty())
    for (const char* layer : {"fog", "volumetric"}) job.layers.emplace_back(layer);
  job.exr_float = true;
  const auto session = Session::open(job, {.linear = true, .display = false}, settings);
  if (!session) return std::unexpected(session.error());
  const auto frame = (*session)->render(time_s);
  if (!frame) return std::unexpected(frame.error());
  NonFinite nonfinite;
  return linear_image(*frame, job, **session, std::nullopt, FrameRate{}, nonfinite);
}

}  // namespace candela
