// Traces the same rays through candela's trees and through Embree's, at equal quality, round by round, and prints JSON:
//   embree_rays [--rounds N] [--size WxH] [--builders NAME,...] [--threads N,...] SCENE[@EX,EY,EZ@TX,TY,TZ]...
// `equal-counts` stands against Embree's low quality (Morton codes), `sah` against its medium and `sbvh` against its
// high one. Both get one ray at a time, and again sixteen at a time, in the order of squares of 4 x 4 pixels. Embree's
// default kernels let rays slip through edges; its robust ones, like candela's, do not: both are timed.
#include <embree3/rtcore.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/rng.h"
#include "base/statistics.h"
#include "base/text.h"
#include "bench/measured.h"
#include "bvh/trace.h"
#include "gltf/gltf.h"
#include "reference/accel.h"
#include "scene/view.h"

using namespace candela;
using nlohmann::ordered_json;

namespace {

double ms_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

// The frame's triangles as one indexed mesh in relative space, in the order of items.
struct Mesh3 {
  std::vector<glm::vec3> position;
  std::vector<uint32_t> index;
  std::vector<uint32_t> item_first;  // triangle

  Mesh3(const Scene& scene, const FrameData& frame, const Accel& accel) {
    for (const DrawItem& item : frame.items) {
      item_first.push_back(uint32_t(index.size() / 3));
      const MeshSection& s = scene.meshes[item.mesh].sections[item.section];
      if (s.topology != Topology::triangles) continue;
      const uint32_t first = uint32_t(position.size());
      const bool skinned = item.deformed >= 0 && frame.deformations[size_t(item.deformed)].joint_count > 0;
      for (glm::vec3 p : item.deformed >= 0 ? accel.deformed(item.deformed).position : s.position)
        position.push_back(skinned ? p : glm::vec3(frame.relative_from_local[item.transform] * glm::vec4(p, 1.0f)));
      for (uint32_t i : s.index) index.push_back(first + i);
    }
    position.emplace_back(0);  // Embree reads 16 bytes of the last vertex
  }
};

class Embree {
 public:
  Embree(const Mesh3& mesh, RTCBuildQuality quality, bool robust, int threads) {
    device_ = rtcNewDevice(threads > 0 ? ("threads=" + std::to_string(threads)).c_str() : nullptr);
    scene_ = rtcNewScene(device_);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.position.data(), 0, 12,
                               mesh.position.size() - 1);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.index.data(), 0, 12,
                               mesh.index.size() / 3);
    rtcSetGeometryBuildQuality(geometry, quality);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneBuildQuality(scene_, quality);
    rtcSetSceneFlags(scene_, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    const auto begin = std::chrono::steady_clock::now();
    rtcCommitScene(scene_);
    build_ms = ms_since(begin);
  }
  ~Embree() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Embree(const Embree&) = delete;

  uint32_t closest(const Ray& ray, float& t) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit hit;
    fill(ray, hit.ray);
    hit.hit.geomID = hit.hit.primID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &hit);
    t = hit.ray.tfar;
    return hit.hit.primID;
  }
  bool occluded(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay r;
    fill(ray, r);
    rtcOccluded1(scene_, &context, &r);
    return r.tfar < 0;
  }

  // Sixteen at once, as coherent rays; returns a sum that depends on all answers.
  uint64_t closest16(const Ray* rays, int count) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    RTCRayHit16 hits;
    alignas(64) int valid[16];
    fill16(rays, count, hits.ray, valid);
    for (int i = 0; i < 16; ++i) hits.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect16(valid, scene_, &context, &hits);
    uint64_t sum = 0;
    for (int i = 0; i < count; ++i) sum += hits.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID ? 0 : hits.hit.primID[i];
    return sum;
  }
  uint64_t occluded16(const Ray* rays, int count) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    RTCRay16 r;
    alignas(64) int valid[16];
    fill16(rays, count, r, valid);
    rtcOccluded16(valid, scene_, &context, &r);
    uint64_t sum = 0;
    for (int i = 0; i < count; ++i) sum += r.tfar[i] < 0;
    return sum;
  }

  double build_ms = 0;

 private:
  static void fill16(const Ray* rays, int count, RTCRay16& r, int* valid) {
    for (int i = 0; i < 16; ++i) {
      const Ray& ray = rays[std::min(i, count - 1)];
      valid[i] = i < count ? -1 : 0;
      r.org_x[i] = ray.origin.x, r.org_y[i] = ray.origin.y, r.org_z[i] = ray.origin.z;
      r.dir_x[i] = ray.direction.x, r.dir_y[i] = ray.direction.y, r.dir_z[i] = ray.direction.z;
      r.tnear[i] = ray.t_min, r.tfar[i] = ray.t_max, r.time[i] = 0, r.mask[i] = 0xffffffffu, r.id[i] = 0,
      r.flags[i] = 0;
    }
  }
  static void fill(const Ray& ray, RTCRay& r) {
    r.org_x = ray.origin.x, r.org_y = ray.origin.y, r.org_z = ray.origin.z;
    r.dir_x = ray.direction.x, r.dir_y = ray.direction.y, r.dir_z = ray.direction.z;
    r.tnear = ray.t_min, r.tfar = ray.t_max, r.time = 0, r.mask = 0xffffffffu, r.id = 0, r.flags = 0;
  }
  RTCDevice device_;
  RTCScene scene_;
};

struct RayKind {
  const char* name;
  bool any;
  std::vector<Ray> rays;
};

std::vector<RayKind> make_rays(const Accel& accel, const FrameData&, const View& view, const Aabb& bounds, int width,
                               int height) {
  std::vector<RayKind> kinds = {{"primary", false, {}}, {"shadow_sun", true, {}}, {"diffuse", false, {}}};
  const glm::dmat3 relative_from_view = glm::transpose(glm::dmat3(view.view_from_relative));
  const glm::vec3 light = bounds.centre() + glm::vec3(0, 0.6f, 0) * bounds.extent();
  Rng rng(1);
  // By squares of 4 x 4 pixels, so that sixteen rays in a row are those of one.
  constexpr int square = 4;
  const int columns = (width + square - 1) / square, rows = (height + square - 1) / square;
  for (int s = 0; s < columns * rows; ++s)
    for (int in = 0; in < square * square; ++in) {
      const int x = s % columns * square + in % square, y = s / columns * square + in / square;
      if (x >= width || y >= height) continue;
      const double u = (x + 0.5) / width * 2 - 1, v = 1 - (y + 0.5) / height * 2;
      Ray ray;
      ray.direction = glm::vec3(relative_from_view * glm::normalize(glm::dvec3(u * view.tan_x, v * view.tan_y, -1)));
      kinds[0].rays.push_back(ray);
      const auto hit = accel.closest(ray);
      if (!hit) continue;
      SurfacePoint p = accel.surface(*hit);
      if (glm::dot(p.geometric_normal, ray.direction) > 0) p.geometric_normal = -p.geometric_normal;
      Ray shadow;
      shadow.origin = leaving_origin(p, p.geometric_normal);
      shadow.direction = light - shadow.origin, shadow.t_max = 0.9999f;
      kinds[1].rays.push_back(shadow);
      const double r = std::sqrt(rng.uniform()), phi = 2 * M_PI * rng.uniform();
      const glm::vec3 n = p.geometric_normal;
      const glm::vec3 tangent =
          glm::normalize(std::abs(n.x) > 0.5f ? glm::cross(n, {0, 1, 0}) : glm::cross(n, {1, 0, 0}));
      Ray diffuse;
      diffuse.origin = shadow.origin;
      diffuse.direction = tangent * float(r * std::cos(phi)) + glm::cross(n, tangent) * float(r * std::sin(phi)) +
                          n * float(std::sqrt(1 - r * r));
      kinds[2].rays.push_back(diffuse);
    }
  return kinds;
}

// trace(from, to): of a range of the rays, a sum of what they meet.
template <class Trace>
double time_rays(size_t first, size_t last, int threads, Trace trace) {
  const auto run = [&](size_t from, size_t to) {
    static std::atomic<uint64_t> sink;
    sink += trace(from, to);
  };
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
  const auto begin = std::chrono::steady_clock::now();
  if (threads > 1)
    tbb::parallel_for(tbb::blocked_range<size_t>(first, last, 2048), [&](const auto& r) { run(r.begin(), r.end()); });
  else
    run(first, last);
  return ms_since(begin);
}

ordered_json spread(const std::vector<double>& samples) {
  return {{"median", median(samples)}, {"mad", mad(samples)}, {"count", samples.size()}};
}

// What both say about every ray. Rays whose answers differ graze an edge, or meet surfaces that lie in one another,
// where the rounding of t decides; `far` counts those where neither explains it: t differs by more than a hundred
// thousandth.
ordered_json compare(const RayKind& kind, const Accel& accel, const Embree& peer, const Mesh3& mesh) {
  size_t same = 0, tied = 0, missed = 0, extra = 0, nearer = 0, farther = 0;
  for (const Ray& ray : kind.rays) {
    if (kind.any) {
      const bool a = accel.occluded(ray), b = peer.occluded(ray);
      same += a == b, missed += b && !a, extra += a && !b;
      continue;
    }
    float t;
    const uint32_t other = peer.closest(ray, t);
    const auto hit = accel.closest(ray);
    if (!hit || other == RTC_INVALID_GEOMETRY_ID) {
      same += !hit && other == RTC_INVALID_GEOMETRY_ID;
      missed += !hit && other != RTC_INVALID_GEOMETRY_ID, extra += hit && other == RTC_INVALID_GEOMETRY_ID;
    } else if (mesh.item_first[hit->item] + hit->primitive == other) {
      ++same;
    } else if (std::abs(hit->t - t) <= 1e-5f * t) {
      ++tied;
    } else {
      ++(hit->t < t ? nearer : farther);
    }
  }
  const double count = double(kind.rays.size());
  return {{"same", double(same) / count},
          {"same_t_other_triangle", double(tied) / count},
          {"only_embree", double(missed) / count},
          {"only_candela", double(extra) / count},
          {"candela_nearer", double(nearer) / count},
          {"embree_nearer", double(farther) / count}};
}

struct Quality {
  const char* name;
  BvhBuilder builder;
  RTCBuildQuality embree;
};
constexpr Quality qualities[] = {{"equal-counts", BvhBuilder::equal_counts, RTC_BUILD_QUALITY_LOW},
                                 {"sah", BvhBuilder::sah, RTC_BUILD_QUALITY_MEDIUM},
                                 {"sbvh", BvhBuilder::sbvh, RTC_BUILD_QUALITY_HIGH}};

// What is measured, as the command line says.
struct Plan {
  int rounds = 9, width = 640, height = 360;
  std::vector<std::string> builders = {"equal-counts", "sah", "sbvh"};
  std::vector<int> threads = {1, 2};
};

std::string threads_name(int threads) {
  return threads == 1 ? "one_thread" : threads == 2 ? "two_threads" : std::to_string(threads) + "_threads";
}

ordered_json time_builds(const Quality& q, const Scene& scene, const Pose& pose, const FrameData& frame,
                         const Mesh3& mesh, const Plan& plan) {
  ordered_json out;
  AccelOptions options;
  options.tree.builder = q.builder;
  for (const int threads : plan.threads) {
    std::vector<double> ours, theirs;
    for (int i = 0; i < plan.rounds; ++i) {
      tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
      ours.push_back(Accel(scene, pose, frame, options).statistics().build_ms);
      theirs.push_back(Embree(mesh, q.embree, false, threads).build_ms);
    }
    const double least = *std::min_element(ours.begin(), ours.end());
    const double their_least = *std::min_element(theirs.begin(), theirs.end());
    out[threads_name(threads)] = {{"candela_ms", spread(ours)},
                                  {"embree_ms", spread(theirs)},
                                  {"candela_least_ms", least},
                                  {"embree_least_ms", their_least},
                                  {"ratio", least / their_least}};
  }
  return out;
}

// The tracers in turn over pieces of the rays, many times. A busy machine only ever takes longer, so a piece's time is
// its least one; the ratios of thirds of the rounds say how well that is known.
ordered_json time_traversal(const Quality& q, const RayKind& kind, const Accel& accel, const Embree& fast,
                            const Embree& robust, const Plan& plan) {
  enum Tracer { ours, theirs, robusts, our_packets, their_packets, robust_packets, tracers };
  const auto trace = [&](int tracer, size_t from, size_t to) {
    const Embree& peer = tracer == theirs || tracer == their_packets ? fast : robust;
    uint64_t sum = 0;
    switch (tracer) {
      case ours:
        for (size_t i = from; i < to; ++i) {
          if (kind.any) {
            sum += accel.occluded(kind.rays[i]);
          } else {
            const auto hit = accel.closest(kind.rays[i]);
            sum += hit ? hit->primitive : 0;
          }
        }
        break;
      case theirs:
      case robusts:
        for (size_t i = from; i < to; ++i) {
          float t;
          sum += kind.any ? peer.occluded(kind.rays[i]) : peer.closest(kind.rays[i], t);
        }
        break;
      case our_packets:
        for (size_t i = from; i < to; i += packet_rays) {
          const std::span rays(&kind.rays[i], std::min(size_t(packet_rays), to - i));
          if (kind.any) {
            std::array<bool, packet_rays> blocked;
            accel.occluded(rays, blocked);
            for (size_t k = 0; k < rays.size(); ++k) sum += blocked[k];
          } else {
            std::array<std::optional<Hit>, packet_rays> hits;
            accel.closest(rays, hits);
            for (size_t k = 0; k < rays.size(); ++k) sum += hits[k] ? hits[k]->primitive : 0;
          }
        }
        break;
      default:
        for (size_t i = from; i < to; i += packet_rays) {
          const int count = int(std::min(size_t(packet_rays), to - i));
          sum += kind.any ? peer.occluded16(&kind.rays[i], count) : peer.closest16(&kind.rays[i], count);
        }
    }
    return sum;
  };
  constexpr int thirds = 3;
  // What stands over what, by names of the file.
  struct Over {
    const char* name;
    Tracer above, below;
  };
  constexpr Over overs[] = {{"time_ratio", ours, theirs},
                            {"time_ratio_robust", ours, robusts},
                            {"packets_time_ratio_robust", our_packets, robusts},
                            {"packets_time_ratio_packets", our_packets, their_packets},
                            {"packets_time_ratio_robust_packets", our_packets, robust_packets}};
  ordered_json out;
  for (const int threads : plan.threads) {
    const size_t piece = threads == 1 ? 4096 : 32768, pieces = (kind.rays.size() + piece - 1) / piece;
    const auto total = [&](const std::vector<double>& least) {
      double sum = 0;
      for (const double ms : least) sum += ms;
      return sum;
    };
    std::vector<double> least[tracers];
    std::vector<double> ratios[std::size(overs)];
    for (std::vector<double>& l : least) l.assign(pieces, std::numeric_limits<double>::infinity());
    for (int third = 0; third < thirds; ++third) {
      std::vector<double> now[tracers];
      for (std::vector<double>& l : now) l.assign(pieces, std::numeric_limits<double>::infinity());
      for (int round = 0; round < plan.rounds; ++round)
        for (size_t i = 0; i < pieces; ++i)
          for (int t = 0; t < tracers; ++t) {
            const double ms = time_rays(i * piece, std::min((i + 1) * piece, kind.rays.size()), threads,
                                        [&](size_t from, size_t to) { return trace(t, from, to); });
            now[t][i] = std::min(now[t][i], ms);
          }
      for (size_t r = 0; r < std::size(overs); ++r)
        ratios[r].push_back(total(now[overs[r].above]) / total(now[overs[r].below]));
      for (int t = 0; t < tracers; ++t)
        for (size_t i = 0; i < pieces; ++i) least[t][i] = std::min(least[t][i], now[t][i]);
    }
    const auto mray_s = [&](Tracer t) { return double(kind.rays.size()) / 1e3 / total(least[t]); };
    ordered_json& row = out[threads_name(threads)];
    row = {{"candela_mray_s", mray_s(ours)},
           {"embree_mray_s", mray_s(theirs)},
           {"embree_robust_mray_s", mray_s(robusts)},
           {"candela_packets_mray_s", mray_s(our_packets)},
           {"embree_packets_mray_s", mray_s(their_packets)},
           {"embree_robust_packets_mray_s", mray_s(robust_packets)}};
    std::fprintf(stderr, "  %s %-8s %d threads: %.2f and %.2f Mray/s", q.name, kind.name, threads, mray_s(ours),
                 mray_s(our_packets));
    for (size_t r = 0; r < std::size(overs); ++r) {
      const double ratio = total(least[overs[r].above]) / total(least[overs[r].below]);
      const auto [low, high] = std::minmax_element(ratios[r].begin(), ratios[r].end());
      row[overs[r].name] = ratio;
      row[std::string(overs[r].name) + "_range"] = {*low, *high};
      std::fprintf(stderr, ", %s %.3f [%.3f, %.3f]", overs[r].name, ratio, *low, *high);
    }
    std::fprintf(stderr, "\n");
  }
  return out;
}

glm::dvec3 parse_point(const std::string& text) {
  glm::dvec3 p(0);
  std::sscanf(text.c_str(), "%lf,%lf,%lf", &p.x, &p.y, &p.z);
  return p;
}

Expected<ordered_json> measure(const std::string& what, const Plan& plan) {
  const int width = plan.width, height = plan.height;
  std::vector<std::string> parts;
  std::istringstream stream(what);
  for (std::string part; std::getline(stream, part, '@');) parts.push_back(part);
  const auto scene = load_gltf(parts[0]);
  if (!scene) return std::unexpected(scene.error());
  const Pose pose = evaluate_pose(*scene, {}, 0);
  CameraRequest camera;
  if (parts.size() == 3) camera.eye = parse_point(parts[1]), camera.target = parse_point(parts[2]);
  const DAabb world = world_bounds(*scene, pose);
  const auto view = make_view(*scene, pose, camera, width, height, world);
  if (!view) return std::unexpected(view.error());
  const FrameData frame = make_frame_data(*scene, pose, *view);
  const Aabb bounds{glm::vec3(world.min - view->position), glm::vec3(world.max - view->position)};

  AccelOptions options;
  const Accel first(*scene, pose, frame, options);
  const Mesh3 mesh(*scene, frame, first);
  const std::vector<RayKind> kinds = make_rays(first, frame, *view, bounds, width, height);
  const std::filesystem::path file = std::filesystem::absolute(parts[0]);
  ordered_json out = {{"scene", (file.stem() == "scene" ? file.parent_path() : file).stem().string()},
                      {"triangles", mesh.index.size() / 3},
                      {"view", view->name}};
  if (parts.size() == 3) out["eye"] = parts[1], out["target"] = parts[2];
  std::fprintf(stderr, "%s: %zu triangles\n", out["scene"].get<std::string>().c_str(), mesh.index.size() / 3);
  for (const Quality& q : qualities) {
    if (std::find(plan.builders.begin(), plan.builders.end(), q.name) == plan.builders.end()) continue;
    options.tree.builder = q.builder, options.measure_cost = true;
    const Accel accel(*scene, pose, frame, options);
    const Embree fast(mesh, q.embree, false, 0), robust(mesh, q.embree, true, 0);
    ordered_json& result = out[q.name];
    result["references"] = accel.statistics().references;
    result["sah_cost"] = accel.statistics().sah_cost;
    result["bytes"] = accel.statistics().bytes;
    result["build"] = time_builds(q, *scene, pose, frame, mesh, plan);
    for (const auto& [name, build] : result["build"].items())
      std::fprintf(stderr, "  %s build, %s: ratio %.2f\n", q.name, name.c_str(), build["ratio"].get<double>());
    for (const RayKind& kind : kinds) {
      ordered_json& row = result["rays"][kind.name];
      row = time_traversal(q, kind, accel, fast, robust, plan);
      row["rays"] = kind.rays.size();
      TraceCounts counts;
      for (const Ray& ray : kind.rays)
        kind.any ? void(accel.occluded(ray, nullptr, &counts)) : void(accel.closest(ray, nullptr, &counts));
      row["nodes_a_ray"] = double(counts.nodes) / double(kind.rays.size());
      row["triangles_a_ray"] = double(counts.triangles) / double(kind.rays.size());
      row["agreement"] = compare(kind, accel, fast, mesh);
      row["agreement_robust"] = compare(kind, accel, robust, mesh);
    }
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  Plan plan;
  ordered_json scenes = ordered_json::array();
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--rounds" && i + 1 < argc) {
      plan.rounds = std::max(1, std::atoi(argv[++i]));
    } else if (argument == "--size" && i + 1 < argc) {
      if (std::sscanf(argv[++i], "%dx%d", &plan.width, &plan.height) != 2) return 2;
    } else if (argument == "--builders" && i + 1 < argc) {
      plan.builders = split(argv[++i], ',');
    } else if (argument == "--threads" && i + 1 < argc) {
      plan.threads.clear();
      for (const std::string& n : split(argv[++i], ',')) plan.threads.push_back(std::max(1, std::atoi(n.c_str())));
    } else {
      const auto result = measure(argument, plan);
      if (!result) {
        std::fprintf(stderr, "%s\n", result.error().text().c_str());
        return int(result.error().kind);
      }
      scenes.push_back(*result);
    }
  }
  const ordered_json all = {{"version", "candela " CANDELA_VERSION},
                            {"embree", RTC_VERSION_STRING},
                            {"cpu", processor_name()},
                            {"cpu_cores", tbb::info::default_concurrency()},
                            {"kernels", best_kernels().name},
                            {"size", {plan.width, plan.height}},
                            {"rounds", plan.rounds},
                            {"scenes", scenes}};
  std::printf("%s\n", all.dump(1).c_str());
}
