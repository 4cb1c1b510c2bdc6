#pragma once
#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"

namespace candela {

// A path that drives a node (docs/using/paths.md): a uniform cubic B-spline over the points of a file. What is given in
// world space is of the file's axes, before --up turns them.
struct PathRequest {
  std::string target;             // "camera", "node NAME", or "light NAME": the node that carries the light
  std::string points;             // file of control points: of the camera in world space, else in the node's parent's
  std::string times;              // file of pairs of time and parameter; empty: evenly, in `seconds`
  std::optional<double> seconds;  // of the whole path; absent: a second a span
  bool closed = false;
  bool touches_ends = true;     // of an open one: its ends are tripled
  bool constant_speed = false;  // the parameter is of the path's length, not of its spans
  bool by_share = false;        // the parameter runs from 0 to 1, not over the count of spans
  bool smooth_times = false;    // monotone cubic between the pairs, not linear
  // Which way the node looks; nothing: as it does without the path. At most one of the three.
  std::optional<glm::dvec3> look_at;  // a point, world
  std::string look_at_node;           // by its name
  bool along = false;                 // the path's own direction
  glm::dvec3 up{0, 1, 0};             // world
  std::string front = "auto";         // the node's axis that looks: auto (-z of cameras and lights, else +z), -z or +z
  bool operator==(const PathRequest&) const = default;
};

// Instances of a node from a file (docs/using/paths.md): each is three vectors.
struct InstancesRequest {
  std::string node, file;
  std::string rotation = "xyz";  // axes about which it is turned one after the other, each as the one before left it
  bool radians = false;
  std::string order = "srt";  // of the three vectors: scale, rotation, translation
  bool operator==(const InstancesRequest&) const = default;
};

// Both as JSON, as a look and a job hold them. Keys that say what is so anyway are left out.
nlohmann::ordered_json path_json(const PathRequest& path);
nlohmann::ordered_json instances_json(const InstancesRequest& instances);
// Errors (input) name the key.
Expected<PathRequest> path_from_json(const nlohmann::ordered_json& j, const std::string& place);
Expected<InstancesRequest> instances_from_json(const nlohmann::ordered_json& j, const std::string& place);

// "FILE[,KEY=VALUE ...]" of an option, with the target that it is for; flags may stand without a value. A point is
// X:Y:Z. Errors (usage).
Expected<PathRequest> parse_path(const std::string& option, const std::string& target, const std::string& text);
// "NODE=FILE[,KEY=VALUE ...]".
Expected<PathRequest> parse_node_path(const std::string& option, const std::string& text);
Expected<InstancesRequest> parse_instances(const std::string& option, const std::string& text);

}  // namespace candela
