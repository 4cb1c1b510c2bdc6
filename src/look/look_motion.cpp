// Paths and instances of look files, jobs and options: one table of keys for all three.
#include <charconv>

#include "look/look_rows.h"

namespace candela {
namespace look_rows {
namespace {

const std::vector<std::string>& axis_orders() {
  static const std::vector<std::string> orders = {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"};
  return orders;
}
const std::vector<std::string>& vector_orders() {
  static const std::vector<std::string> orders = {"srt", "str", "rst", "rts", "tsr", "trs"};
  return orders;
}

// Words that say which of two it is.
template <class T>
Row<T> either_row(std::string name, std::string if_false, std::string if_true, bool T::*member, std::string help) {
  LookKey key = key_of(std::move(name), LookKey::Kind::text, {}, std::move(help));
  key.choices = {std::move(if_false), std::move(if_true)};
  const std::vector<std::string> choices = key.choices;
  return {std::move(key), [=](const Json& j, const std::string& place, T& into) -> Expected<void> {
            const std::string word = j.is_string() ? j.get<std::string>() : "";
            if (word != choices[0] && word != choices[1]) return wrong(place, unknown_name("value", word, choices));
            into.*member = word == choices[1];
            return {};
          }};
}

const Rows<PathRequest>& path_rows() {
  using P = PathRequest;
  static const Rows<P> rows = {
      text_row<P>("target", {}, &P::target, "camera, node NAME or light NAME: what is moved"),
      text_row<P>("points", {}, &P::points, "file of control points, x y z a line"),
      text_row<P>("times", {}, &P::times, "file of pairs of time in seconds and parameter"),
      fixed_row(number_row<P>("seconds", above_zero(), &P::seconds,
                              "without times: how long the whole path takes; else a second a span")),
      flag_row<P>("closed", &P::closed, "the path comes back to its beginning"),
      either_row<P>("ends", "plain", "touch", &P::touches_ends,
                    "of an open path: touch triples the first and the last point, so that it begins and ends there"),
      flag_row<P>("constant_speed", &P::constant_speed, "the parameter goes by the path's length"),
      either_row<P>("parameter", "spans", "share", &P::by_share,
                    "spans: from 0 to the count of spans; share: from 0 to 1"),
      either_row<P>("interpolation", "linear", "cubic", &P::smooth_times,
                    "between the pairs of times; cubic is monotone between them"),
      point_row<P>("look_at", &P::look_at, "a point in world space that the target looks at"),
      text_row<P>("look_at_node", {}, &P::look_at_node, "the name of a node that the target looks at"),
      flag_row<P>("along", &P::along, "the target looks along the path"),
      point_row<P>("up", &P::up, "which way is up, world space"),
      text_row<P>("front", {"auto", "-z", "+z"}, &P::front,
                  "the axis that looks; auto: -z of cameras and lights, +z of all else"),
  };
  return rows;
}

const Rows<InstancesRequest>& instances_rows() {
  using I = InstancesRequest;
  static const Rows<I> rows = {
      text_row<I>("node", {}, &I::node, "the name of the node whose mesh is drawn many times"),
      text_row<I>("file", {}, &I::file, "three vectors an instance"),
      text_row<I>("rotation", axis_orders(), &I::rotation,
                  "the axes it is turned about one after the other, each as the one before left it"),
      either_row<I>("units", "degrees", "radians", &I::radians, "of rotations"),
      text_row<I>("order", vector_orders(), &I::order, "of the vectors: scale, rotation, translation"),
  };
  return rows;
}

Expected<void> check_path(const std::string& place, const PathRequest& path) {
  if (path.target.empty()) return wrong(place, "lacks target");
  if (path.target != "camera" && !path.target.starts_with("node ") && !path.target.starts_with("light "))
    return wrong(place + "/target", "the value is none of camera, node NAME and light NAME");
  if (path.points.empty()) return wrong(place, "lacks points");
  if (path.seconds && !path.times.empty()) return wrong(place + "/seconds", "goes without times");
  if (path.closed && !path.touches_ends) return wrong(place + "/ends", "a closed path has no ends");
  if (int(path.look_at.has_value()) + int(!path.look_at_node.empty()) + int(path.along) > 1)
    return wrong(place, "gives more than one of look_at, look_at_node and along");
  if (!(glm::length(path.up) > 0)) return wrong(place + "/up", "the value is no direction");
  return {};
}

Expected<void> check_instances(const std::string& place, const InstancesRequest& instances) {
  if (instances.node.empty()) return wrong(place, "lacks node");
  if (instances.file.empty()) return wrong(place, "lacks file");
  return {};
}

}  // namespace

Row<Look> paths_row() {
  return objects_row<Look, PathRequest>(
      "paths", most_motion_files, path_rows(),
      [](const Json&, const std::string& place, PathRequest& path, Look& look) -> Expected<void> {
        if (auto fine = check_path(place, path); !fine) return fine;
        look.paths.push_back(path);
        return {};
      },
      "paths from files that move the camera, nodes and lights");
}

Row<Look> instances_row() {
  return objects_row<Look, InstancesRequest>(
      "instances", most_motion_files, instances_rows(),
      [](const Json&, const std::string& place, InstancesRequest& instances, Look& look) -> Expected<void> {
        if (auto fine = check_instances(place, instances); !fine) return fine;
        look.instances.push_back(instances);
        return {};
      },
      "nodes whose meshes are drawn many times, by files");
}

}  // namespace look_rows

namespace {

using namespace look_rows;

Json point_json(glm::dvec3 v) { return Json::array({v.x, v.y, v.z}); }

template <class T>
const LookKey* key_named(const Rows<T>& rows, const std::string& name) {
  for (const Row<T>& row : rows)
    if (row.key.name == name) return &row.key;
  return nullptr;
}

std::optional<double> number_of(const std::string& text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return value;
}

// A value of an option as the JSON that the key takes; text where it is none, for the reader says what is wrong.
Json value_of(const LookKey& key, const std::string& text) {
  switch (key.kind) {
    case LookKey::Kind::flag:
      return text == "true" ? Json(true) : text == "false" ? Json(false) : Json(text);
    case LookKey::Kind::number:
      if (const auto number = number_of(text)) return *number;
      return text;
    case LookKey::Kind::numbers: {
      Json list = Json::array();
      for (const std::string& part : split(text, ':'))
        if (const auto number = number_of(part))
          list.push_back(*number);
        else
          return text;
      return list;
    }
    default:
      return text;
  }
}

// The first of the words is the value of `first`; the others are KEY=VALUE or a flag's name. An underscore may be
// written as a hyphen.
template <class T>
Expected<Json> json_of(const std::string& option, const Rows<T>& rows, const char* first, const std::string& text) {
  Json j = Json::object();
  const std::vector<std::string> words = split(text, ',');
  if (words.front().empty()) return fail(ErrorKind::usage, option, "'{}' names no file", text);
  j[first] = words.front();
  for (size_t i = 1; i < words.size(); ++i) {
    const size_t equals = words[i].find('=');
    std::string name = words[i].substr(0, equals);
    std::replace(name.begin(), name.end(), '-', '_');
    const LookKey* key = key_named(rows, name);
    if (!key || j.contains(name)) {
      std::vector<std::string> names;
      for (const Row<T>& row : rows)
        if (row.key.name != "target" && row.key.name != "node" && row.key.name != first) names.push_back(row.key.name);
      return fail(ErrorKind::usage, option, "{}",
                  key ? fmt::format("'{}' is given twice", name) : unknown_name("key", name, names));
    }
    if (equals == std::string::npos && key->kind != LookKey::Kind::flag)
      return fail(ErrorKind::usage, option, "'{}' needs a value: {}=...", name, name);
    j[name] = equals == std::string::npos ? Json(true) : value_of(*key, words[i].substr(equals + 1));
  }
  return j;
}

Error as_usage(const std::string& option, const Error& error) {
  return {ErrorKind::usage, error.place.size() > 1 ? error.place.substr(1) + ": " + error.message : error.message,
          option};
}

// "NAME=FILE,...": the name may hold no equals sign, and the file's may.
Expected<std::pair<std::string, std::string>> named(const std::string& option, const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || text.find(',') < equals)
    return fail(ErrorKind::usage, option, "'{}' is not NODE=FILE", text);
  return std::pair(text.substr(0, equals), text.substr(equals + 1));
}

}  // namespace

Json path_json(const PathRequest& path) {
  const PathRequest plain;
  Json j;
  j["target"] = path.target;
  j["points"] = path.points;
  if (!path.times.empty()) j["times"] = path.times;
  if (path.seconds) j["seconds"] = *path.seconds;
  if (path.closed) j["closed"] = true;
  if (!path.touches_ends) j["ends"] = "plain";
  if (path.constant_speed) j["constant_speed"] = true;
  if (path.by_share) j["parameter"] = "share";
  if (path.smooth_times) j["interpolation"] = "cubic";
  if (path.look_at) j["look_at"] = point_json(*path.look_at);
  if (!path.look_at_node.empty()) j["look_at_node"] = path.look_at_node;
  if (path.along) j["along"] = true;
  if (path.up != plain.up) j["up"] = point_json(path.up);
  if (path.front != plain.front) j["front"] = path.front;
  return j;
}

Json instances_json(const InstancesRequest& instances) {
  const InstancesRequest plain;
  Json j;
  j["node"] = instances.node;
  j["file"] = instances.file;
  if (instances.rotation != plain.rotation) j["rotation"] = instances.rotation;
  if (instances.radians) j["units"] = "radians";
  if (instances.order != plain.order) j["order"] = instances.order;
  return j;
}

Expected<PathRequest> path_from_json(const Json& j, const std::string& place) {
  PathRequest path;
  if (auto read = read_rows(j, place, path_rows(), path); !read) return std::unexpected(read.error());
  if (auto fine = check_path(place, path); !fine) return std::unexpected(fine.error());
  return path;
}

Expected<InstancesRequest> instances_from_json(const Json& j, const std::string& place) {
  InstancesRequest instances;
  if (auto read = read_rows(j, place, instances_rows(), instances); !read) return std::unexpected(read.error());
  if (auto fine = check_instances(place, instances); !fine) return std::unexpected(fine.error());
  return instances;
}

Expected<PathRequest> parse_path(const std::string& option, const std::string& target, const std::string& text) {
  auto j = json_of(option, path_rows(), "points", text);
  if (!j) return std::unexpected(j.error());
  if (j->contains("target")) return fail(ErrorKind::usage, option, "the target is said before the file");
  (*j)["target"] = target;
  auto path = path_from_json(*j, "");
  if (!path) return std::unexpected(as_usage(option, path.error()));
  return path;
}

Expected<PathRequest> parse_node_path(const std::string& option, const std::string& text) {
  const auto parts = named(option, text);
  if (!parts) return std::unexpected(parts.error());
  const auto& [name, rest] = *parts;
  const bool says_kind = name == "camera" || name.starts_with("node ") || name.starts_with("light ");
  return parse_path(option, says_kind ? name : "node " + name, rest);
}

Expected<InstancesRequest> parse_instances(const std::string& option, const std::string& text) {
  const auto parts = named(option, text);
  if (!parts) return std::unexpected(parts.error());
  auto j = json_of(option, instances_rows(), "file", parts->second);
  if (!j) return std::unexpected(j.error());
  if (j->contains("node")) return fail(ErrorKind::usage, option, "the node is said before the file");
  (*j)["node"] = parts->first;
  auto instances = instances_from_json(*j, "");
  if (!instances) return std::unexpected(as_usage(option, instances.error()));
  return instances;
}

}  // namespace candela
