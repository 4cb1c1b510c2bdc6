#pragma once
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "base/error.h"
#include "scene/pose.h"
#include "scene/scene.h"
#include "scene/view_hulls.h"

namespace candela {

// By what cameras that place themselves are placed.
enum class Framing : uint8_t {
  boxes,   // the corners of boxes about what is drawn at a time, each frame anew; whole spheres without fit
  film,    // the vertices as the film shows them: one camera for all frames (scene/view_hulls.h)
  follow,  // the vertices at a time, each frame anew
};
// How the command line asks for a camera: an explicit eye and target, a camera by name or index, or nothing.
struct CameraRequest {
  std::optional<glm::dvec3> eye, target;
  std::optional<double> yfov_deg;
  std::string camera;  // name or index; empty: the first camera in node order, else framing
  // A view of the bounds from a direction: degrees to the right of the front (+Z), and above the horizon.
  std::optional<double> azimuth_deg, elevation_deg;
  bool fit = false;  // moves the camera, looking the same way, until the bounds fill the picture
  Framing framing = Framing::boxes;
  double turn_s = 0;  // above 0: the azimuth grows by 360 degrees in that time, about the bounds' middle
};
// The request at a moment: a turntable's azimuth.
CameraRequest camera_at(CameraRequest request, double time_s);

// A camera placed in the world, for one image size. Depth is reversed; projections are in double.
struct View {
  glm::dvec3 position{0};            // world
  glm::dmat4 view_from_relative{1};  // rotation only: relative space has world axes and its origin at `position`
  glm::dmat4 clip_from_view{1};
  glm::dmat4 clip_from_relative{1};
  bool perspective = true;
  double near_m = 0.01, far_m = 0;  // far only for orthographic
  double tan_x = 1, tan_y = 1;      // perspective half-angle tangents, or orthographic half sizes in metres
  std::string name;                 // "camera 'Main'" or "framed bounds", for the log and the metadata
  std::vector<std::string> notes;   // for example zfar ignored
};

// World bounds of what is drawn, measured when something asks: most views do not.
class DrawnBounds {
 public:
  DrawnBounds(const DAabb& known) : box_(known) {}
  // outlines: of the camera's axes, of all that it shall show; absent: the box's.
  using Outlines = std::function<ViewHulls(const glm::dmat3& axes, bool turned)>;
  DrawnBounds(std::function<DAabb()> measure, Outlines outlines = {})
      : measure_(std::move(measure)), outlines_(std::move(outlines)) {}
  const DAabb& box() const {
    if (!box_) box_ = measure_();
    return *box_;
  }
  ViewHulls outlines(const glm::dmat3& axes, bool turned) const;

 private:
  std::function<DAabb()> measure_;
  Outlines outlines_;
  mutable std::optional<DAabb> box_;
};

// Errors (usage): unknown camera; eye equals target; (input): a camera with unusable values.
// bounds: for framing and for an orthographic far plane.
Expected<View> make_view(const Scene& scene, const Pose& pose, const CameraRequest& request, int width_px,
                         int height_px, const DrawnBounds& bounds);

// The node of the camera that a request names, or of the first one; -1: the file has none. Errors (usage): no such one.
Expected<int> find_camera_node(const Scene& scene, const std::string& camera);
// The node of the file that carries the camera of a request; -1: it is none of the file's, or there is none.
int camera_node_of(const Scene& scene, const CameraRequest& request);

// A point of a thin lens, of a radius, whose plane of focus lies that far along the view axis (infinity: far away).
struct LensPoint {
  glm::dvec2 from_middle_m{0};  // right and up
  double radius_m = 0, focus_m = std::numeric_limits<double>::infinity();
};
// Which part of a larger image is the picture, so that the plane of focus stays in its place: a whole number of pixels,
// and what is left of the shift, within half a pixel.
struct ImageWindow {
  glm::ivec2 margin_px{0};  // by which the image is wider and higher, on either side
  glm::ivec2 first_px{0};   // where the picture begins
  glm::dvec2 offset_px{0};  // of samples against the middles of the image's pixels, right and down
};
// Moves a perspective view to a point of its lens and widens it by the margin that all points need: an image of the
// margin's size shows all that a picture of width_px x height_px sheared about the plane of focus does (Haeberli and
// Akeley 1990). offset_px: that the picture's samples shall have. Orthographic views have no lens and take the offset
// alone. Error (usage): the plane of focus is so near that the image is larger than most_px.
Expected<ImageWindow> look_through(View& view, const LensPoint& point, glm::dvec2 offset_px, int width_px,
                                   int height_px, int most_px);

// The same camera with a picture that reaches beyond on all sides: by these factors as wide and as high.
View with_overscan(View view, double across, double down);

// One of the six square views about a point: along +X, -X, +Y, -Y, +Z, -Z. tan_half: tangent of the half angle.
View view_of_face(glm::dvec3 position, int face, double tan_half, double near_m);

}  // namespace candela
