#include "scene/view.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "math/transforms.h"
#include "scene/fit_view.h"

#include "base/names.h"

namespace candela {
namespace {

constexpr double default_yfov_rad = std::numbers::pi / 4;
// Of the distance to what is looked at; with reversed float depth a near plane costs no precision.
constexpr double near_part = 1e-3;

double radians(double degrees) { return degrees * std::numbers::pi / 180; }
bool is_finite(glm::dvec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

struct ImageSize {
  int width_px, height_px;
  double aspect() const { return double(width_px) / double(height_px); }
};

glm::dvec3 any_perpendicular(glm::dvec3 v) {
  const glm::dvec3 a = glm::abs(v);
  const glm::dvec3 axis = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                          : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                   : glm::dvec3(0, 0, 1);
  return glm::normalize(glm::cross(v, axis));
}

glm::dvec3 direction_or_zero(glm::dvec3 v) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? v / length : glm::dvec3(0);
}

// Right, up and back of a camera node without its scale: where it looks is kept first, then which way is up; a mirrored
// node thus gives an unmirrored picture. An axis scaled to nothing is rebuilt from the other two.
glm::dmat3 camera_axes(const glm::dmat4& world, std::vector<std::string>& notes) {
  glm::dvec3 right = direction_or_zero(glm::dvec3(world[0])), up = direction_or_zero(glm::dvec3(world[1]));
  glm::dvec3 back = direction_or_zero(glm::dvec3(world[2]));
  const glm::dvec3 none(0);
  if (back == none) back = direction_or_zero(glm::cross(right, up));
  if (back == none) {
    notes.push_back(
        "the camera's node is scaled to nothing, so its direction is lost; it looks along its remaining axis or -Z");
    back = right != none ? any_perpendicular(right) : up != none ? any_perpendicular(up) : glm::dvec3(0, 0, 1);
  }
  up = direction_or_zero(up - back * glm::dot(up, back));
  if (up == none) up = direction_or_zero(glm::cross(back, right));
  if (up == none) up = any_perpendicular(back);
  return glm::dmat3(glm::cross(up, back), up, back);
}

void place(View& view, glm::dvec3 position, const glm::dmat3& axes) {
  view.position = position;
  view.view_from_relative = glm::dmat4(glm::transpose(axes));
}

void set_perspective(View& view, double yfov_rad, double near_m, ImageSize size) {
  view.perspective = true;
  view.tan_y = std::tan(yfov_rad / 2);
  view.tan_x = view.tan_y * size.aspect();
  view.near_m = near_m;
  view.clip_from_view = perspective_reversed_infinite(view.tan_x, view.tan_y, near_m);
}

View finished(View view) {
  view.clip_from_relative = view.clip_from_view * view.view_from_relative;
  return view;
}

// A finite, non-empty box to look at, whatever is (not) in the scene.
DAabb box_to_frame(const DAabb& bounds, std::vector<std::string>& notes) {
  const glm::dvec3 centre = bounds.centre();
  if (!bounds.empty() && is_finite(centre) && glm::length(bounds.extent()) > 0 &&
      std::isfinite(glm::length(bounds.extent())))
    return bounds;
  if (!bounds.empty() && is_finite(centre)) return {centre - 1.0, centre + 1.0};  // a single point
  notes.push_back("nothing to frame: the view is of the origin");
  return {glm::dvec3(-1), glm::dvec3(1)};
}

// A far plane behind everything that is drawn.
double far_from_bounds(const View& view, const DAabb& bounds) {
  double far_m = view.near_m + 1;
  if (!bounds.empty() && is_finite(bounds.extent())) {
    const DAabb in_view = transformed(bounds, view.view_from_relative * relative_from_world(view.position));
    far_m = std::max(far_m, -in_view.min.z * 1.001);
  }
  return far_m;
}

constexpr double default_azimuth_deg = 30, default_elevation_deg = 20;
constexpr double fit_margin = 0.05;
constexpr const char* framed_name = "framed bounds";

bool from_direction(const CameraRequest& request) {
  return request.azimuth_deg || request.elevation_deg || request.turn_s > 0;
}

// World bounds of outlines along the world's axes.
DAabb box_of(ViewHulls hulls) {
  DAabb box;
  for (const glm::dvec2& x : hulls.x.points())
    for (const glm::dvec2& y : hulls.y.points()) box.add(hulls.middle + glm::dvec3(x.x, y.x, x.y));
  return box;
}

// From where a viewer shows a model: its front is +Z (glTF 3.4), seen from slightly right and above. The bounding
// sphere fits into the narrower field of view, with a margin of 5 %.
View framed(const CameraRequest& request, double yfov_rad, ImageSize size, const DrawnBounds& bounds) {
  View view;
  const bool of_film = request.target && request.framing == Framing::film;
  const DAabb box = box_to_frame(of_film ? box_of(bounds.outlines(glm::dmat3(1), false)) : bounds.box(), view.notes);
  const glm::dvec3 target = request.target.value_or(box.centre());
  const double radius = glm::length(box.extent()) + glm::length(box.centre() - target);
  const double tan_y = std::tan(yfov_rad / 2), narrow = std::atan(tan_y * std::min(1.0, size.aspect()));
  const double distance = 1.05 * radius / std::sin(narrow);
  const double yaw = radians(request.azimuth_deg.value_or(default_azimuth_deg));
  const double pitch = radians(request.elevation_deg.value_or(default_elevation_deg));
  const glm::dvec3 back(std::sin(yaw) * std::cos(pitch), std::sin(pitch), std::cos(yaw) * std::cos(pitch));
  const glm::dvec3 eye = target + back * distance;
  place(view, eye, glm::dmat3(look_at_pose(back, glm::dvec3(0))));
  set_perspective(view, yfov_rad, std::min(near_part * distance, 0.5 * (distance - radius)), size);
  view.name = framed_name;
  return finished(std::move(view));
}

// Points to frame: outlines with a size, or something about a single point or the origin.
ViewHulls hulls_to_frame(ViewHulls hulls, const glm::dmat3& axes, std::vector<std::string>& notes) {
  notes.insert(notes.end(), hulls.notes.begin(), hulls.notes.end());
  const size_t count = hulls.x.points().size();
  if (count > 1 || hulls.y.points().size() > 1) return hulls;
  if (count == 0) notes.push_back("nothing to frame: the view is of the origin");
  if (count == 0) hulls.middle = glm::dvec3(0);
  for (const glm::dvec3& corner : corners_of({glm::dvec3(-1), glm::dvec3(1)})) hulls.add(glm::transpose(axes) * corner);
  return hulls;
}

// The same camera, looking the same way, from another place.
View moved_to(const Fit& fit, View view, ImageSize size, const DrawnBounds& bounds, const char* name) {
  view.position = fit.position;
  if (view.perspective) {
    view.near_m = near_part * fit.nearest_m;
    view.clip_from_view = perspective_reversed_infinite(view.tan_x, view.tan_y, view.near_m);
  } else {
    view.tan_y = fit.half_height, view.tan_x = fit.half_height * size.aspect();
    view.near_m = 0;
    view.far_m = far_from_bounds(view, bounds.box());
    view.clip_from_view = orthographic_reversed(view.tan_x, view.tan_y, view.near_m, view.far_m);
  }
  view.name = name;
  return finished(std::move(view));
}

// Where the vertices fill its picture.
View placed_by_outlines(View view, const CameraRequest& request, ImageSize size, const DrawnBounds& bounds) {
  const glm::dmat3 axes = glm::transpose(glm::dmat3(view.view_from_relative));
  ViewHulls hulls = hulls_to_frame(bounds.outlines(axes, request.turn_s > 0), axes, view.notes);
  const Fit fit = view.perspective ? fit_perspective(hulls, axes, view.tan_x, view.tan_y, fit_margin)
                                   : fit_orthographic(hulls, axes, size.aspect(), fit_margin);
  return moved_to(fit, std::move(view), size, bounds, framed_name);
}

// Where the bounds fill its picture.
View fitted(View view, const CameraRequest& request, ImageSize size, const DrawnBounds& bounds) {
  const DAabb box = box_to_frame(bounds.box(), view.notes);
  const glm::dmat3 axes = glm::transpose(glm::dmat3(view.view_from_relative));
  const std::vector<glm::dvec3> points = request.turn_s > 0 ? turned_once(box, axes[0]) : corners_of(box);
  const Fit fit = view.perspective ? fit_perspective(points, axes, view.tan_x, view.tan_y, fit_margin)
                                   : fit_orthographic(points, axes, size.aspect(), fit_margin);
  return moved_to(fit, std::move(view), size, bounds, "fitted bounds");
}

Expected<View> from_eye(const CameraRequest& request, double yfov_rad, ImageSize size, const DrawnBounds& bounds) {
  View view;
  const glm::dvec3 eye = *request.eye;
  glm::dvec3 target = request.target.value_or(eye - glm::dvec3(0, 0, 1));
  if (!request.target) {
    const DAabb box = box_to_frame(bounds.box(), view.notes);
    if (box.centre() != eye) target = box.centre();
  }
  if (eye == target)
    return fail(ErrorKind::usage, "",
                "the eye equals the target, so there is no direction to look in; move one of them");
  const double distance = glm::length(target - eye);
  if (!std::isfinite(distance) || !(distance > 0))
    return fail(ErrorKind::usage, "", "the eye and the target are too far apart or too close");
  // From the direction alone: at 1e6 m the difference is exact, while unit vectors of the positions are not.
  place(view, eye, glm::dmat3(look_at_pose((eye - target) / distance, glm::dvec3(0))));
  set_perspective(view, yfov_rad, near_part * distance, size);
  view.name = "eye and target";
  return finished(std::move(view));
}

std::string camera_names(const Scene& scene) {
  if (scene.cameras.empty()) return "the file has no cameras";
  const size_t count = scene.cameras.size();
  const bool unnamed =
      std::all_of(scene.cameras.begin(), scene.cameras.end(), [](const Camera& c) { return c.name.empty(); });
  if (unnamed)
    return count == 1 ? "there is one, without a name: take it by its index 0"
                      : fmt::format("there are {} without names: take one by its index, 0 to {}", count, count - 1);
  std::string names = "there are";
  for (size_t i = 0; i < count; ++i)
    names += fmt::format("{} {} {}", i ? "," : "", i,
                         scene.cameras[i].name.empty() ? "(no name)" : "'" + scene.cameras[i].name + "'");
  return names;
}

// The first reachable node that carries the wanted camera; -1 in `which` takes any.
int node_of_camera(const Scene& scene, int which) {
  for (int n : scene.order) {
    const int camera = scene.nodes[size_t(n)].camera;
    if (camera >= 0 && (which < 0 || camera == which)) return n;
  }
  return -1;
}

Expected<void> set_file_perspective(View& view, const Camera& camera, const CameraRequest& request, ImageSize size,
                                    const std::string& place_of) {
  const double yfov = request.yfov_deg ? radians(*request.yfov_deg) : camera.yfov_rad;
  if (!(yfov > 0 && yfov < std::numbers::pi))
    return fail(ErrorKind::input, place_of, "yfov is {} rad; it must lie between 0 and pi", yfov);
  if (!(camera.near_m > 0 && std::isfinite(camera.near_m)))
    return fail(ErrorKind::input, place_of, "znear is {} m; it must be greater than 0", camera.near_m);
  set_perspective(view, yfov, camera.near_m, size);
  if (std::isfinite(camera.far_m))
    view.notes.push_back(fmt::format("zfar {} m is ignored: the projection has no far plane", camera.far_m));
  if (camera.aspect > 0 && std::abs(camera.aspect / size.aspect() - 1) > 1e-3)
    view.notes.push_back(fmt::format("aspectRatio {:.4g} is ignored: the image has {:.4g}, and yfov is kept",
                                     camera.aspect, size.aspect()));
  return {};
}

Expected<void> set_file_orthographic(View& view, const Camera& camera, const CameraRequest& request, ImageSize size,
                                     const DrawnBounds& bounds, const std::string& place_of) {
  const double xmag = std::abs(camera.xmag), ymag = std::abs(camera.ymag);
  if (!(xmag > 0 && ymag > 0 && std::isfinite(xmag) && std::isfinite(ymag)))
    return fail(ErrorKind::input, place_of, "xmag {} and ymag {} must not be 0", camera.xmag, camera.ymag);
  if (!(camera.near_m >= 0 && std::isfinite(camera.near_m)))
    return fail(ErrorKind::input, place_of, "znear is {} m; it must not be negative", camera.near_m);
  view.perspective = false;
  view.near_m = camera.near_m;
  view.far_m = std::isfinite(camera.far_m) ? camera.far_m : far_from_bounds(view, bounds.box());
  if (!(view.far_m > view.near_m))
    return fail(ErrorKind::input, place_of, "zfar {} m must be greater than znear {} m", camera.far_m, camera.near_m);
  view.tan_y = ymag;
  view.tan_x = ymag * size.aspect();
  if (std::abs(view.tan_x / xmag - 1) > 1e-3)
    view.notes.push_back(
        fmt::format("xmag {:.4g} becomes {:.4g}: ymag is kept, and the width follows the image", xmag, view.tan_x));
  if (camera.xmag < 0 || camera.ymag < 0) view.notes.push_back("a negative xmag or ymag is taken as positive");
  if (request.yfov_deg) view.notes.push_back("yfov is ignored: the camera is orthographic");
  view.clip_from_view = orthographic_reversed(view.tan_x, view.tan_y, view.near_m, view.far_m);
  return {};
}

Expected<View> from_file(const Scene& scene, const Pose& pose, int node, const CameraRequest& request, ImageSize size,
                         const DrawnBounds& bounds) {
  const int index = scene.nodes[size_t(node)].camera;
  const Camera& camera = pose.cameras[size_t(index)];
  const std::string place_of = fmt::format("{}: /cameras/{} {}", scene.path, index, quoted_name(camera.name));
  View view;
  view.name = camera.name.empty() ? fmt::format("camera {}", index) : "camera " + quoted_name(camera.name);
  const glm::dmat4& world = pose.world_from_node[size_t(node)];
  if (!is_finite(glm::dvec3(world[3])))
    return fail(ErrorKind::input, place_of, "its node /nodes/{} has no finite position", node);
  place(view, glm::dvec3(world[3]), camera_axes(world, view.notes));
  const Expected<void> set = camera.perspective ? set_file_perspective(view, camera, request, size, place_of)
                                                : set_file_orthographic(view, camera, request, size, bounds, place_of);
  if (!set) return std::unexpected(set.error());
  return finished(std::move(view));
}

Expected<void> check_request(const CameraRequest& request, ImageSize size) {
  if (size.width_px < 1 || size.height_px < 1)
    return fail(ErrorKind::usage, "", "an image of {}x{} pixels cannot be rendered", size.width_px, size.height_px);
  if ((request.eye && !is_finite(*request.eye)) || (request.target && !is_finite(*request.target)))
    return fail(ErrorKind::usage, "", "eye and target must be finite numbers");
  if (request.yfov_deg && !(*request.yfov_deg > 0 && *request.yfov_deg < 180))
    return fail(ErrorKind::usage, "", "yfov is {} degrees; it must lie between 0 and 180", *request.yfov_deg);
  if (!request.camera.empty() && (request.eye || request.target))
    return fail(ErrorKind::usage, "", "give either camera '{}' or an eye and a target, not both", request.camera);
  if (from_direction(request) && (request.eye || !request.camera.empty()))
    return fail(ErrorKind::usage, "", "azimuth, elevation and turntable frame the bounds: not with a camera or an eye");
  if ((request.fit || request.turn_s > 0) && (request.eye || request.target))
    return fail(ErrorKind::usage, "", "fit and turntable place the camera themselves: not with an eye or a target");
  return {};
}

Expected<View> seen_from(const Scene& scene, const Pose& pose, const CameraRequest& request, ImageSize size,
                         const DrawnBounds& bounds) {
  const double yfov_rad = request.yfov_deg ? radians(*request.yfov_deg) : default_yfov_rad;
  if (request.eye) return from_eye(request, yfov_rad, size, bounds);
  if (!request.camera.empty()) {
    const Expected<int> node = find_camera_node(scene, request.camera);
    if (!node) return std::unexpected(node.error());
    return from_file(scene, pose, *node, request, size, bounds);
  }
  const int first = request.target || from_direction(request) ? -1 : node_of_camera(scene, -1);
  if (first >= 0) return from_file(scene, pose, first, request, size, bounds);
  return framed(request, yfov_rad, size, bounds);
}

}  // namespace

// A name of a camera, else of a camera's node, else an index.
Expected<int> find_camera_node(const Scene& scene, const std::string& wanted) {
  if (wanted.empty()) return node_of_camera(scene, -1);
  int camera = -1;
  for (size_t i = 0; i < scene.cameras.size() && camera < 0; ++i)
    if (scene.cameras[i].name == wanted) camera = int(i);
  if (camera < 0) {
    for (int n : scene.order)
      if (scene.nodes[size_t(n)].camera >= 0 && scene.nodes[size_t(n)].name == wanted) return n;
    int index = -1;
    const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
    const bool number = error == std::errc() && end == wanted.data() + wanted.size();
    if (number && index >= 0 && size_t(index) < scene.cameras.size()) camera = index;
  }
  if (camera < 0) return fail(ErrorKind::usage, scene.path, "no camera '{}': {}", wanted, camera_names(scene));
  const int node = node_of_camera(scene, camera);
  if (node < 0)
    return fail(
        ErrorKind::usage, scene.path,
        "camera '{}' stands nowhere: no node of the scene carries it; choose another or give --eye and --target",
        wanted);
  return node;
}

int camera_node_of(const Scene& scene, const CameraRequest& request) {
  if (request.eye || request.target || from_direction(request)) return -1;
  return find_camera_node(scene, request.camera).value_or(-1);
}

Expected<ImageWindow> look_through(View& view, const LensPoint& point, glm::dvec2 offset_px, int width_px,
                                   int height_px, int most_px) {
  ImageWindow window;
  const glm::dvec2 size(width_px, height_px);
  glm::dvec2 shift = offset_px;
  if (view.perspective && point.radius_m > 0) {
    const glm::dmat3 axes = glm::transpose(glm::dmat3(view.view_from_relative));
    view.position += point.from_middle_m.x * axes[0] + point.from_middle_m.y * axes[1];
    // What lay at a tangent t on the plane of focus lies at t - point / focus now.
    const glm::dvec2 px_per_tangent = 0.5 * size / glm::dvec2(view.tan_x, view.tan_y);
    shift += glm::dvec2(-point.from_middle_m.x, point.from_middle_m.y) / point.focus_m * px_per_tangent;
    const glm::dvec2 most = glm::ceil(point.radius_m / point.focus_m * px_per_tangent) + 1.0;
    if (!(std::max(size.x + 2 * most.x, size.y + 2 * most.y) <= most_px))
      return fail(ErrorKind::usage, "--focus",
                  "the plane of focus, {:.4g} m away, is too near for an opening of {:.4g} m: frames would have to be "
                  "{:.0f} pixels wide; focus farther away, or take a larger f-stop",
                  point.focus_m, 2 * point.radius_m, size.x + 2 * most.x);
    window.margin_px = most;
    const glm::dvec2 wider = (size + 2.0 * most) / size;
    view = with_overscan(std::move(view), wider.x, wider.y);
  }
  const glm::dvec2 whole = window.margin_px == glm::ivec2(0) ? glm::dvec2(0) : glm::round(shift);
  window.first_px = window.margin_px + glm::ivec2(whole);
  window.offset_px = shift - whole;
  return window;
}

View with_overscan(View view, double across, double down) {
  view.tan_x *= across, view.tan_y *= down;
  view.clip_from_view = view.perspective ? perspective_reversed_infinite(view.tan_x, view.tan_y, view.near_m)
                                         : orthographic_reversed(view.tan_x, view.tan_y, view.near_m, view.far_m);
  return finished(std::move(view));
}

View view_of_face(glm::dvec3 position, int face, double tan_half, double near_m) {
  glm::dvec3 back(0);
  back[face / 2] = face % 2 == 0 ? -1 : 1;
  const glm::dvec3 up = face / 2 == 1 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  View view;
  place(view, position, glm::dmat3(glm::cross(up, back), up, back));
  view.tan_x = view.tan_y = tan_half;
  view.near_m = near_m;
  view.clip_from_view = perspective_reversed_infinite(tan_half, tan_half, near_m);
  view.name = fmt::format("face {} of a cube", face);
  return finished(std::move(view));
}

Expected<View> make_view(const Scene& scene, const Pose& pose, const CameraRequest& request, int width_px,
                         int height_px, const DrawnBounds& bounds) {
  const ImageSize size{width_px, height_px};
  if (const Expected<void> checked = check_request(request, size); !checked) return std::unexpected(checked.error());
  auto view = seen_from(scene, pose, request, size, bounds);
  if (!view) return view;
  const bool places_itself = request.fit || request.turn_s > 0;
  const bool framed = !request.target && view->name == framed_name;
  if (request.framing != Framing::boxes && (places_itself || framed))
    return placed_by_outlines(std::move(*view), request, size, bounds);
  if (!places_itself) {
    if (request.framing == Framing::follow && !framed)
      view->notes.push_back(fmt::format("{} stays as it is: cameras that place themselves follow (--fit)", view->name));
    return view;
  }
  return fitted(std::move(*view), request, size, bounds);
}

ViewHulls DrawnBounds::outlines(const glm::dmat3& axes, bool turned) const {
  if (outlines_) return outlines_(axes, turned);
  ViewHulls hulls;
  if (box().empty()) return hulls;
  hulls.middle = box().centre();
  for (const glm::dvec3& corner : turned ? turned_once(box(), axes[0]) : corners_of(box()))
    hulls.add(glm::transpose(axes) * (corner - hulls.middle));
  return hulls;
}

CameraRequest camera_at(CameraRequest request, double time_s) {
  if (request.turn_s > 0)
    request.azimuth_deg =
        request.azimuth_deg.value_or(default_azimuth_deg) + 360 * std::fmod(time_s / request.turn_s, 1.0);
  return request;
}

}  // namespace candela
