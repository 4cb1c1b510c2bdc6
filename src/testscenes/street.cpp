#include "testscenes/street.h"

#include <algorithm>
#include <map>

#include "testscenes/light_arrays.h"
#include "testscenes/table.h"

// A city at night. Cells are added from the camera outwards, 64 lights each, and what a cell holds depends on its place
// and the seed alone: the city of few lights is the inner part of the city of many, and lights a square metre are the
// same in both.
namespace candela {
namespace {

using namespace street;

constexpr int street_lights = 256;
constexpr double street_end_s = 300;      // of the animations; the cars stop then
constexpr double hold_s = 1.0 / 1024;     // in which cars jump back by one cell, where the next ones have come
constexpr std::array speeds_s{6.4, 8.0};  // for one cell: 10 and 8 m/s

struct CityCell {
  int x, z;
  glm::dvec3 centre() const { return {(x + 0.5) * cell_m, 0, (z + 0.5) * cell_m}; }
};

// The nearest ones to a place in front of the camera.
std::vector<CityCell> cells_outwards(int count) {
  const glm::dvec3 focus(1, 0, -63);
  const int reach = int(std::ceil(std::sqrt(double(count)))) + 2;
  std::vector<CityCell> cells;
  for (int z = -reach; z <= reach; ++z)
    for (int x = -reach; x <= reach; ++x) cells.push_back({x, z - 1});
  const auto key = [&](const CityCell& c) {
    const glm::dvec3 d = c.centre() - focus;
    return std::tuple(glm::dot(d, d), c.z, c.x);
  };
  std::ranges::sort(cells, {}, key);
  cells.resize(size_t(count));
  return cells;
}

Rng rng_at(uint64_t seed, int a, int b) {
  Rng rng(seed ^ (uint64_t(uint32_t(a)) << 32 | uint32_t(b)));
  return Rng(rng.next());
}

json mesh_instances(GlbWriter& out, const std::vector<double>& translation, const std::vector<double>& rotation = {},
                    const std::vector<double>& scale = {}) {
  out.use_extension("EXT_mesh_gpu_instancing");
  json attributes = {{"TRANSLATION", out.float_accessor(translation, 3)}};
  if (!rotation.empty()) attributes["ROTATION"] = out.float_accessor(rotation, 4);
  if (!scale.empty()) attributes["SCALE"] = out.float_accessor(scale, 3);
  return {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}};
}

// All cars that drive one way at one speed. Their node moves by one cell and jumps back; a lane holds the same cars in
// every cell, so nothing is seen of it.
struct Traffic {
  std::map<int, std::vector<double>> translation;  // by mesh
  LightArrays head_lamps;
};

class City {
 public:
  City(GlbWriter& out, uint64_t seed) : out_(out), seed_(seed), rng_(seed), parts_(make_parts(out, rng_)) {
    houses_.resize(parts_.blocks.size());
  }

  void add(const CityCell& cell, int lights) {
    Rng rng = rng_at(seed_, cell.x, cell.z);
    // Spots and points in turn, lamps and cars, windows and signs, so that a cell cut short has its fraction of each.
    int lamps = 0, head_lamps = 0, windows = 0, signs = 0;
    for (int i = 0; i < lights; ++i) {
      const int half = i / 2;
      if (i % 2 == 0)
        ++(half % 2 == 0 ? lamps : head_lamps);
      else
        ++(half % 8 == 1 || half % 8 == 4 || half % 8 == 6 ? signs : windows);
    }
    add_street(cell, lamps, rng);
    add_houses(cell, windows, signs, rng);
    for (int way = 0; way < lanes_a_cell; ++way) {
      add_lane(cell, way, std::min(head_lamps, 2 * cars_a_lane));
      head_lamps -= std::min(head_lamps, 2 * cars_a_lane);
    }
  }

  // Points anywhere over the cells, up to the height of the signs: lights that have no lamp, window or sign of their
  // own.
  void scatter(const std::vector<CityCell>& cells, int count) {
    Rng rng = rng_at(seed_, int(cells.size()), 920);
    for (int i = 0; i < count; ++i) {
      const glm::dvec3 corner = cells[size_t(i) % cells.size()].centre() - glm::dvec3(cell_m / 2, 0, cell_m / 2);
      const double x = rng.uniform(0, cell_m), y = rng.uniform(0.5, 9), z = rng.uniform(0, cell_m);
      push(scattered_.translation, corner + glm::dvec3(x, y, z));
      const double warmth = rng.uniform();
      push(scattered_.color, glm::dvec3(1, 0.6 + 0.3 * warmth, 0.3 + 0.6 * warmth));
      scattered_.intensity.push_back(rng.uniform(0.5, 2));
      scattered_.range.push_back(6 * rng.uniform(0.8, 1.2));
      push(scattered_.modulation, {0.3, 3, rng.uniform()});
    }
  }

  void write() {
    for (size_t b = 0; b < houses_.size(); ++b) {
      const Houses& h = houses_[b];
      if (!h.translation.empty())
        out_.node("blocks", {{"mesh", parts_.blocks[b].mesh},
                             {"extensions", mesh_instances(out_, h.translation, h.rotation, h.scale)}});
    }
    out_.node("streets", {{"mesh", parts_.street_mesh}, {"extensions", mesh_instances(out_, streets_)}});
    lamps_.write(out_, "street lamps", spot("street lamp", {1, 1, 1}, 1, 16, 0.45, 1.1));
    windows_.write(out_, "windows", point("window", 6));
    signs_.write(out_, "signs", point("sign", 7));
    if (!scattered_.intensity.empty()) scattered_.write(out_, "scattered", point("scattered", 6));
    write_traffic();
  }

 private:
  struct Houses {
    std::vector<double> translation, rotation, scale;
  };

  void add_street(const CityCell& cell, int lamps, Rng& rng) {
    push(streets_, cell.centre());
    for (int i = 0; i < lamps_a_cell; ++i) {
      const Lamp& lamp = parts_.lamps[size_t(i)];
      // A street along Z has the masts 0, 2, ...; its lamps are all sodium or all white, along its whole length.
      const bool along_z = i % 4 < 2;
      const bool is_white = rng_at(seed_, along_z ? cell.x : cell.z, along_z ? 901 : 902).next() % 3 == 1;
      const bool is_faulty = rng.next() % 24 == 0;
      const double intensity = rng.uniform(420, 620), phase = rng.uniform();
      const glm::dvec3 tilt(rng.uniform(-0.05, 0.05), 0, rng.uniform(-0.05, 0.05));
      if (i >= lamps) continue;
      push(lamps_.translation, cell.centre() + lamp.at);
      push(lamps_.direction, glm::normalize(lamp.direction + tilt));
      push(lamps_.color, is_white ? glm::dvec3(0.86, 0.93, 1) : glm::dvec3(1, 0.68, 0.36));
      lamps_.intensity.push_back(intensity);
      push(lamps_.modulation, is_faulty ? glm::dvec3(0.85, 0.7, phase) : glm::dvec3(0.12, 2.5, phase));
    }
  }

  void add_houses(const CityCell& cell, int windows, int signs, Rng& rng) {
    const size_t which = size_t(rng.next() % parts_.blocks.size());
    const int quarters = int(rng.next() % 4);
    const double height = 0.85 + 0.1 * double(rng.next() % 5);
    const street::Block& block = parts_.blocks[which];
    Houses& h = houses_[which];
    push(h.translation, cell.centre());
    const glm::dquat rotation = rotation_about({0, 1, 0}, quarters * 1.5707963267948966);
    h.rotation.insert(h.rotation.end(), {rotation.x, rotation.y, rotation.z, rotation.w});
    push(h.scale, {1, height, 1});
    const auto fixture = [&](LightArrays& lights, const Fixture& f, bool is_on, double least, double most,
                             glm::dvec3 modulation) {
      const double intensity = rng.uniform(least, most), range = rng.uniform(0.8, 1.2), phase = rng.uniform();
      if (!is_on) return;
      push(lights.translation, cell.centre() + turned(quarters, f.at * glm::dvec3(1, height, 1)));
      push(lights.color, f.color);
      lights.intensity.push_back(intensity);
      lights.range.push_back(range * (&lights == &windows_ ? 6 : 7));
      push(lights.modulation, modulation + glm::dvec3(0, 0, phase));
    };
    for (int i = 0; i < windows_a_cell; ++i)
      fixture(windows_, block.windows[size_t(i)], i < windows, 3, 9, {0.4, 4 + i % 5, 0});
    for (int i = 0; i < signs_a_cell; ++i)
      fixture(signs_, block.signs[size_t(i)], i < signs, 8, 20, {0.7, 1.5 + i % 4, 0});
  }

  // Ways: 0 drives to -Z, 1 to -X, 2 to +Z, 3 to +X. Positions are in the space of the way's node, where they drive to
  // -Z.
  void add_lane(const CityCell& cell, int way, int head_lamps) {
    const bool along_z = way % 2 == 0;
    Rng lane = rng_at(seed_, along_z ? cell.x : cell.z, 910 + way);
    const CarPair& cars = parts_.cars[size_t(lane.next() % parts_.cars.size())];
    Traffic& traffic = traffic_[size_t(way)][size_t(lane.next() % speeds_s.size())];
    const double ahead = lane.uniform(-cell_m / 2, cell_m / 2), brightness = lane.uniform(500, 900);
    const glm::dvec3 street =
        cell.centre() + (along_z ? glm::dvec3(-street_centre_m, 0, 0) : glm::dvec3(0, 0, street_centre_m));
    const glm::dvec3 at = turned(4 - way, street) + glm::dvec3(road_m / 4, 0, -ahead);
    push(traffic.translation[cars.mesh], at);
    for (int i = 0; i < head_lamps; ++i) {
      push(traffic.head_lamps.translation,
           at + glm::dvec3(i % 2 ? 0.62 : -0.62, head_lamp_height_m, cars.z[size_t(i / 2)] - 2.2));
      push(traffic.head_lamps.direction, glm::normalize(glm::dvec3(0, -0.09, -1)));
      traffic.head_lamps.intensity.push_back(brightness);
    }
  }

  int spot(const char* name, glm::dvec3 color, double intensity, double range, double inner, double outer) {
    return out_.light({{"name", name},
                       {"type", "spot"},
                       {"color", vector_json(color)},
                       {"intensity", number(intensity)},
                       {"range", number(range)},
                       {"spot", {{"innerConeAngle", number(inner)}, {"outerConeAngle", number(outer)}}}});
  }
  int point(const char* name, double range) {
    return out_.light({{"name", name}, {"type", "point"}, {"range", number(range)}});
  }

  // From half a cell behind to half a cell ahead, again and again.
  void drive(int node, size_t speed) {
    int& sampler = samplers_[speed];
    if (sampler >= 0) {
      json& channels = out_.root["animations"][0]["channels"];
      channels.push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", "translation"}}}});
      return;
    }
    std::vector<double> times, values;
    for (double t = 0; t < street_end_s; t += speeds_s[speed]) {
      times.insert(times.end(), {t == 0 ? 0 : t + hold_s, t + speeds_s[speed]});
      push(values, {0, 0, cell_m / 2});
      push(values, {0, 0, -cell_m / 2});
    }
    out_.animate(node, "translation", "LINEAR", times, values, 3);
    sampler = int(out_.root["animations"][0]["samplers"].size()) - 1;
  }

  void write_traffic() {
    const int light = spot("head lamp", {1, 0.95, 0.86}, 1, 20, 0.15, 0.42);
    for (int way = 0; way < lanes_a_cell; ++way)
      for (size_t speed = 0; speed < speeds_s.size(); ++speed) {
        const Traffic& traffic = traffic_[size_t(way)][speed];
        if (traffic.translation.empty()) continue;
        const int turn =
            out_.node("way", {{"rotation", quaternion_json(rotation_about({0, 1, 0}, way * 1.5707963267948966))}});
        const int node = out_.child(turn, "traffic", json::object());
        for (const auto& [mesh, translation] : traffic.translation)
          out_.child(node, "cars", {{"mesh", mesh}, {"extensions", mesh_instances(out_, translation)}});
        if (!traffic.head_lamps.translation.empty())
          out_.child(node, "head lamps", {{"extensions", traffic.head_lamps.extension(out_, light)}});
        drive(node, speed);
      }
  }

  GlbWriter& out_;
  uint64_t seed_;
  Rng rng_;
  Parts parts_;
  std::vector<Houses> houses_;
  std::vector<double> streets_;
  LightArrays lamps_, windows_, signs_, scattered_;
  std::array<std::array<Traffic, speeds_s.size()>, lanes_a_cell> traffic_;
  std::array<int, speeds_s.size()> samplers_{-1, -1};
};

void add_street_camera(GlbWriter& out) { out.camera_node({2.5, 5.8, 10}, {7.5, 0, -13}, 0.87); }

}  // namespace

void make_street(GlbWriter& out, SceneOptions& options) {
  const int lights = options.lights > 0 ? options.lights : street_lights;
  City city(out, options.rng.next());
  int left = lights;
  for (const CityCell& cell : cells_outwards((lights + lights_a_cell - 1) / lights_a_cell)) {
    city.add(cell, std::min(left, lights_a_cell));
    left -= std::min(left, lights_a_cell);
  }
  city.write();
  add_street_camera(out);
}

void make_street_dense(GlbWriter& out, SceneOptions& options) {
  // Where the street has 1,024 lights.
  constexpr int cells = 16;
  const int lights = options.lights > 0 ? options.lights : street_lights;
  City city(out, options.rng.next());
  const std::vector<CityCell> all = cells_outwards(cells);
  int placed = 0;
  for (int i = 0; i < cells; ++i) {
    // As even as whole numbers are.
    const int fraction =
        int(std::min<int64_t>(int64_t(lights) * (i + 1) / cells - int64_t(lights) * i / cells, lights_a_cell));
    city.add(all[size_t(i)], fraction);
    placed += fraction;
  }
  city.scatter(all, lights - placed);
  city.write();
  add_street_camera(out);
}

}  // namespace candela
