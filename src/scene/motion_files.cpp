#include "scene/motion_files.h"

#include <cmath>
#include <numbers>

#include "scene/number_file.h"

namespace candela {
namespace {

constexpr const char* point_is = "a point is three numbers: x y z";
constexpr const char* time_is = "a line is a time in seconds and a parameter";
constexpr const char* instance_is = "an instance is three lines of three numbers, or nine numbers in one";

// Turned about the node's own axes, one after the other.
glm::dquat rotation_of(glm::dvec3 angles, const InstancesRequest& request) {
  glm::dquat q(1, 0, 0, 0);
  for (int i = 0; i < 3; ++i) {
    const int axis = request.rotation[size_t(i)] - 'x';
    glm::dvec3 about(0);
    about[axis] = 1;
    // The angles stand in the order of the axes' names: x, y, z.
    const double angle = request.radians ? angles[axis] : angles[axis] * std::numbers::pi / 180;
    q = q * glm::angleAxis(angle, about);
  }
  return glm::normalize(q);
}

bool fits_float(glm::dvec3 v) {
  for (int c = 0; c < 3; ++c)
    if (!std::isfinite(float(v[c]))) return false;
  return true;
}

}  // namespace

Expected<std::vector<glm::dvec3>> read_points(const std::filesystem::path& file) {
  const auto lines = read_number_file(file, {3}, point_is);
  if (!lines) return std::unexpected(lines.error());
  std::vector<glm::dvec3> points;
  for (const NumberLine& line : *lines) points.emplace_back(line.values[0], line.values[1], line.values[2]);
  return points;
}

Expected<TimeMap> read_times(const std::filesystem::path& file) {
  const auto lines = read_number_file(file, {2}, time_is);
  if (!lines) return std::unexpected(lines.error());
  TimeMap map;
  for (const NumberLine& line : *lines) {
    const size_t count = map.time_s.size();
    if (count > 0 && line.values[0] < map.time_s.back())
      return fail(ErrorKind::input, line_place(file, line.line), "the time {} s comes before {} s; times must ascend",
                  line.values[0], map.time_s.back());
    if (count > 1 && line.values[0] == map.time_s[count - 1] && line.values[0] == map.time_s[count - 2])
      return fail(ErrorKind::input, line_place(file, line.line),
                  "the time {} s is given a third time; two lines of one time are a jump from one parameter to another",
                  line.values[0]);
    map.time_s.push_back(line.values[0]);
    map.parameter.push_back(line.values[1]);
  }
  return map;
}

Expected<Instances> read_instances(const std::filesystem::path& file, const InstancesRequest& request) {
  const auto lines = read_number_file(file, {3, 9}, instance_is);
  if (!lines) return std::unexpected(lines.error());
  Instances out;
  std::vector<double> group;
  size_t first_line = 0;
  for (const NumberLine& line : *lines) {
    if (group.empty()) first_line = line.line;
    if (!group.empty() && line.values.size() == 9)
      return fail(ErrorKind::input, line_place(file, line.line),
                  "the line holds nine numbers, within the instance that begins in line {}; {}", first_line,
                  instance_is);
    group.insert(group.end(), line.values.begin(), line.values.end());
    if (group.size() < 9) continue;
    glm::dvec3 scale(1), rotation(0), translation(0);
    for (size_t v = 0; v < 3; ++v) {
      const char what = request.order[v];
      glm::dvec3& into = what == 's' ? scale : what == 'r' ? rotation : translation;
      into = glm::dvec3(group[3 * v], group[3 * v + 1], group[3 * v + 2]);
    }
    if (!fits_float(scale) || !fits_float(translation))
      return fail(ErrorKind::input, line_place(file, first_line),
                  "the instance holds a number beyond what 32 bits hold");
    const glm::dquat q = rotation_of(rotation, request);
    out.scale.emplace_back(scale);
    out.rotation.emplace_back(float(q.w), float(q.x), float(q.y), float(q.z));
    out.translation.emplace_back(translation);
    ++out.count;
    group.clear();
  }
  if (!group.empty())
    return fail(ErrorKind::input, line_place(file, first_line), "the last instance has {} of its 3 vectors; {}",
                group.size() / 3, instance_is);
  return out;
}

}  // namespace candela
