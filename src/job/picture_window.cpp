#include "job/picture_window.h"

#include <charconv>
#include <cmath>

#include "base/text.h"
#include "job/job.h"

namespace candela {
namespace {

// 16384 is the image size that every Vulkan 1.3 desktop driver offers; lavapipe stops there.
constexpr int max_side_px = 16384;

struct Margin {
  int x_px, y_px;
};
Margin margin_of(const Job& job) {
  const auto of = [&](int side) {
    const double px = job.overscan.percent ? side * job.overscan.amount / 100 : job.overscan.amount;
    return int(std::ceil(std::min(px, 1e6)));
  };
  return {of(job.width_px), of(job.height_px)};
}

}  // namespace

PictureWindow picture_window(const Job& job) {
  const Margin margin = margin_of(job);
  PictureWindow w;
  w.display_width = job.width_px, w.display_height = job.height_px;
  w.width_px = job.width_px + 2 * margin.x_px, w.height_px = job.height_px + 2 * margin.y_px;
  w.data = job.region.value_or(PixelRect{-margin.x_px, -margin.y_px, w.width_px, w.height_px});
  w.part = moved(w.data, margin.x_px, margin.y_px);
  return w;
}

Expected<void> check_window(const Job& job) {
  if (job.width_px < 1 || job.height_px < 1 || job.width_px > max_side_px || job.height_px > max_side_px)
    return fail(ErrorKind::usage, "--size", "{}x{} is outside 1x1 to {}x{}", job.width_px, job.height_px, max_side_px,
                max_side_px);
  if (!(job.overscan.amount >= 0) || !std::isfinite(job.overscan.amount))
    return fail(ErrorKind::usage, "--overscan", "{} is not a number of pixels", job.overscan.amount);
  const PictureWindow w = picture_window(job);
  if (w.width_px > max_side_px || w.height_px > max_side_px)
    return fail(ErrorKind::usage, "--overscan", "the picture of {}x{} with overscan is {}x{}, more than {}x{}",
                job.width_px, job.height_px, w.width_px, w.height_px, max_side_px, max_side_px);
  if (!job.region) return {};
  const PixelRect& r = *job.region;
  if (r.width < 1 || r.height < 1)
    return fail(ErrorKind::usage, "--region", "{}x{} is an empty region; width and height must be at least 1", r.width,
                r.height);
  if (!holds({0, 0, w.width_px, w.height_px}, w.part))
    return fail(ErrorKind::usage, "--region", "{},{},{},{} reaches beyond the picture, which is {}x{}{}", r.x, r.y,
                r.width, r.height, job.width_px, job.height_px,
                w.width_px > job.width_px ? fmt::format(" and reaches to {},{}", w.data.x, w.data.y) : "");
  return {};
}

Expected<PixelRect> parse_pixel_rect(const std::string& text) {
  const std::vector<std::string> parts = split(text, ',');
  PixelRect r;
  int* const values[] = {&r.x, &r.y, &r.width, &r.height};
  bool fine = parts.size() == 4;
  for (size_t i = 0; fine && i < 4; ++i) {
    const char* const end = parts[i].data() + parts[i].size();
    const auto [at, error] = std::from_chars(parts[i].data(), end, *values[i]);
    fine = error == std::errc{} && at == end && std::abs(*values[i]) <= 1 << 20;
  }
  if (fine) return r;
  return fail(ErrorKind::usage, "",
              "'{}' is not a part of a picture; write X,Y,WIDTH,HEIGHT in pixels, for example "
              "0,0,640,360",
              text);
}

Expected<Overscan> parse_overscan(const std::string& text) {
  Overscan o;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, o.amount);
  o.percent = error == std::errc{} && at != end && *at == '%';
  if (error == std::errc{} && at + (o.percent ? 1 : 0) == end && o.amount >= 0 && std::isfinite(o.amount) &&
      (o.percent || o.amount == std::floor(o.amount)))
    return o;
  return fail(ErrorKind::usage, "", "'{}' is not an overscan; write pixels, for example 64, or a percentage, 10%",
              text);
}

Expected<LightGroupRequest> parse_light_group(const std::string& text) {
  const size_t equals = text.find('=');
  LightGroupRequest group;
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    return fail(ErrorKind::usage, "",
                "'{}' is not a group of lights; write NAME=NODE,NODE with names of nodes, in which * "
                "stands for any letters",
                text);
  group.name = text.substr(0, equals);
  group.nodes = split(text.substr(equals + 1), ',');
  return group;
}

}  // namespace candela
