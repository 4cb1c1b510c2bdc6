// Paths and instances of looks, jobs and options are read by one table.
#include "look/motion.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "look/look.h"

namespace candela::test::scene_look_motion {
namespace {

using Json = nlohmann::ordered_json;

std::string error_of(const auto& read) { return read ? "" : read.error().text(); }

}  // namespace

TEST(Motion, OptionsSayWhatALookSays) {
  const auto look = look_from_json(
      R"({"paths": [{"target": "camera", "points": "c.txt", "times": "t.txt", "interpolation": "cubic", "ends": "plain",
                     "look_at": [1, 2, -3], "up": [0, 0, 1]},
                    {"target": "light Lamp", "points": "l.txt", "closed": true, "constant_speed": true, "seconds": 4},
                    {"target": "node Car", "points": "k.txt", "along": true, "front": "-z", "parameter": "share"}],
          "instances": [{"node": "Rock", "file": "r.txt", "rotation": "zyx", "units": "radians", "order": "trs"}]})",
      "l.json");
  ASSERT_TRUE(look) << look.error().text();
  const auto camera =
      parse_path("--camera-path", "camera", "c.txt,times=t.txt,interpolation=cubic,ends=plain,look-at=1:2:-3,up=0:0:1");
  const auto lamp = parse_node_path("--path", "light Lamp=l.txt,closed,constant-speed=true,seconds=4");
  const auto car = parse_node_path("--path", "Car=k.txt,along,front=-z,parameter=share");
  const auto rock = parse_instances("--instances", "Rock=r.txt,rotation=zyx,units=radians,order=trs");
  ASSERT_TRUE(camera && lamp && car && rock) << error_of(camera) << error_of(lamp) << error_of(car) << error_of(rock);
  ASSERT_EQ(look->paths.size(), 3u);
  ASSERT_EQ(look->instances.size(), 1u);
  EXPECT_EQ(path_json(look->paths[0]), path_json(*camera));
  EXPECT_EQ(path_json(look->paths[1]), path_json(*lamp));
  EXPECT_EQ(path_json(look->paths[2]), path_json(*car));
  EXPECT_EQ(instances_json(look->instances[0]), instances_json(*rock));
  for (const PathRequest& path : look->paths) {
    const auto again = path_from_json(path_json(path), "");
    ASSERT_TRUE(again) << again.error().text();
    EXPECT_EQ(path_json(*again), path_json(path));
  }
  EXPECT_EQ(camera->look_at, glm::dvec3(1, 2, -3));
  EXPECT_TRUE(camera->smooth_times && !camera->touches_ends);
}

TEST(Motion, WhatIsWrongIsNamed) {
  const auto option = [](const std::string& text) { return error_of(parse_path("--camera-path", "camera", text)); };
  EXPECT_EQ(option("c.txt,close"),
            "--camera-path: unknown key 'close'; did you mean 'closed'? There are: times, seconds, "
            "closed, ends, constant_speed, parameter, interpolation, look_at, look_at_node, "
            "along, up, front");
  EXPECT_EQ(option("c.txt,times"), "--camera-path: 'times' needs a value: times=...");
  EXPECT_EQ(option("c.txt,closed,closed"), "--camera-path: 'closed' is given twice");
  EXPECT_EQ(option("c.txt,look-at=1:2"), "--camera-path: look_at: the value is not a list of three numbers: x, y, z");
  EXPECT_EQ(option("c.txt,look-at=a:b:c"), "--camera-path: look_at: the value is not a list of three numbers: x, y, z");
  EXPECT_EQ(option("c.txt,along,look-at=0:0:0"),
            "--camera-path: gives more than one of look_at, look_at_node and along");
  EXPECT_EQ(option("c.txt,times=t.txt,seconds=2"), "--camera-path: seconds: goes without times");
  EXPECT_EQ(option("c.txt,closed,ends=plain"), "--camera-path: ends: a closed path has no ends");
  EXPECT_EQ(option("c.txt,up=0:0:0"), "--camera-path: up: the value is no direction");
  EXPECT_EQ(option(""), "--camera-path: '' names no file");
  EXPECT_EQ(error_of(parse_node_path("--path", "Car")), "--path: 'Car' is not NODE=FILE");
  EXPECT_EQ(error_of(parse_instances("--instances", "Rock=r.txt,rotation=xxy")),
            "--instances: rotation: unknown value 'xxy'; did you mean 'xzy'? There are: xyz, xzy, yxz, yzx, zxy, zyx");
  const auto look = [](const std::string& text) { return error_of(look_from_json(text, "l.json")); };
  EXPECT_EQ(look(R"({"paths": [{"target": "Car", "points": "p"}]})"),
            "l.json: /paths/0/target: the value is none of camera, node NAME and light NAME");
  EXPECT_EQ(look(R"({"paths": [{"target": "camera"}]})"), "l.json: /paths/0: lacks points");
  EXPECT_EQ(look(R"({"instances": [{"node": "a"}]})"), "l.json: /instances/0: lacks file");
  EXPECT_NE(look(R"({"paths": [{"target": "camera", "points": "p", "seconds": {"keys": [[0, 1]]}}]})")
                .find("paths are the same at all times"),
            std::string::npos);
}

}  // namespace candela::test::scene_look_motion
