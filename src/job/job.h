#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/hash.h"
#include "base/knob.h"
#include "base/pixel_rect.h"
#include "image/io.h"
#include "job/frame_list.h"
#include "look/motion.h"
#include "scene/view.h"

namespace candela {

// Frames per second as a fraction, so that frame/fps is exact in double: 24, 23.976 (= 24000/1001), 30000/1001.
struct FrameRate {
  int64_t numerator = 24, denominator = 1;
  double seconds(int64_t frame) const { return double(frame) * double(denominator) / double(numerator); }
  std::string text() const;
};
Expected<FrameRate> parse_frame_rate(const std::string& text);

// How far a picture extends beyond its size: pixels on each side, or a percentage of the width on the left
// and right and of the height above and below.
struct Overscan {
  double amount = 0;
  bool percent = false;
  bool operator==(const Overscan&) const = default;
};
// Lights by the names of their nodes; `*` stands for any letters. Their light on surfaces is the layer light_NAME.
struct LightGroupRequest {
  std::string name;
  std::vector<std::string> nodes;
  std::string layer() const { return "light_" + name; }
  bool operator==(const LightGroupRequest&) const = default;
};
inline constexpr std::string_view other_lights = "rest";  // group of all lights that are in no other

// Everything that decides a picture, as a plain value. Written into EXR metadata as JSON, so that any frame can be made
// again.
struct Job {
  std::string scene;
  std::string up = "y";           // axis of the file that points up (scene/up_axis.h); camera: after that turn
  std::string animation = "all";  // "auto", "all", "none", an index or a name (scene/pose.h)
  CameraRequest camera;
  int width_px = 1280, height_px = 720;
  std::optional<PixelRect> region;  // what is rendered of the picture; its corner may lie in the overscan
  Overscan overscan;
  int samples = 0;  // MSAA samples 1, 2, 4 or 8; 0: as the quality says
  std::string technique = "clustered";
  std::string transparency = "sorted";  // method for blended surfaces (candela list transparency)
  std::string quality = "high";         // draft, normal, high, exact: levels of every knob
  std::vector<KnobSetting> settings;    // --set PASS.KNOB=VALUE, over the quality
  std::string effects = "auto";         // auto (by quality and look), none, or names separated by commas
  // Equirectangular .hdr or .exr, six faces, or a word (is_sky_word). Empty: the look's; where there is no light
  // either, the neutral one.
  std::string sky;
  std::string look;                // look file
  std::vector<PathRequest> paths;  // a node that one of these drives ignores the look's path
  std::vector<InstancesRequest> instances;
  std::string shading = "pbr";       // reflection model (scene/shading.h)
  std::string cut_outs = "blended";  // how blended materials of alpha 0 and 1 are drawn (scene/cut_outs.h)
  std::string sides = "auto";        // light from behind single-sided faces: block, open, or by the scene
  std::string variant;               // of materials, by its name in the file; empty: the default materials
  // Shutter and lens; absent: as the look says, else an instant and a pinhole (job/picture_camera.h).
  std::optional<double> shutter_s;   // how long it is open, half before the frame's time and half after it
  std::optional<double> f_stop;      // focal length over the diameter of the opening; 0: a pinhole
  std::optional<double> sensor_mm;   // height of the sensor
  std::string focus;                 // metres, inf, or the name of a node; empty: as the look says
  std::optional<double> iso;         // if set, f-stop, shutter and this speed decide the exposure
  std::string probe;                 // a sphere before the camera: white, grey, chrome; empty: none
  std::optional<float> exposure_ev;  // absent: as the look says, else 0
  std::string tonemap;               // a curve (tonemap_names()); empty: as the look says, else agx
  std::vector<std::string> layers;   // beside beauty
  std::vector<LightGroupRequest> light_groups;
  double motion_s = 1.0 / 24;              // of the layer motion: time since the frame before
  std::string view = "beauty";             // what PNG and video show: beauty, a layer, or debug.PASS.IMAGE[mip,layer]
  std::string background = "transparent";  // a colour or "R,G,B", where there is no sky (job/background.h)
  uint64_t seed = 0;
  // Encoding.
  bool exr_float = false;  // beauty as float instead of half
  ExrCompression exr_compression = ExrCompression::zip;
  int png_bits = 8;
  bool dither = true;
  bool timings_in_metadata = false;
  bool allow_nonfinite = false;
};
// As a layer's name: all layers that this frame can have; those that it cannot have are no error.
inline constexpr std::string_view all_layers = "all";
// Skies that --sky names without a file. auto: the look's; where the file has no light either, the studio.
inline constexpr std::string_view auto_sky = "auto", studio_sky = "studio", neutral_sky = "neutral";
inline bool is_sky_word(std::string_view sky) {
  return sky == "none" || sky == "atmosphere" || sky == auto_sky || sky == studio_sky || sky == neutral_sky;
}
std::string job_json(const Job& job);  // stable order; one line
Expected<Job> job_from_json(const std::string& text);
Expected<std::pair<int, int>> parse_size(const std::string& text);       // "1280x720", "1080p", "4k"
Expected<PixelRect> parse_pixel_rect(const std::string& text);           // "X,Y,W,H"; X and Y may be negative
Expected<Overscan> parse_overscan(const std::string& text);              // "64" or "10%"
Expected<LightGroupRequest> parse_light_group(const std::string& text);  // "NAME=NODE,NODE"
Expected<KnobSetting> parse_knob_setting(const std::string& text);       // "PASS.KNOB=VALUE"
// Names and ranges: an unknown technique, layer or knob is an error that lists the names and suggests the nearest.
Expected<void> check_job(const Job& job);
// Whether files of these layers keep what they must: Cryptomatte's ids are the bits of 32-bit floats, which some
// compressions change.
Expected<void> check_compression(const std::vector<std::string>& layers, ExrCompression compression);
// Clears the names of the job's motion files, so that its identity depends on their contents alone.
void forget_motion_files(Job& job);
// Identity of a frame's picture: the job, the scene's and the sky's content as hex digits, the device and the version.
Hash128 frame_identity(const Job& job, const std::string& scene_content, const std::string& device, double time_s);

// How the run is made; none of it changes a pixel.
struct RunSettings {
  std::string device;  // as DeviceOptions::which
  bool validate = false;
  std::string shader_folder;
  bool timed = false;
  bool spans = false;  // spans of frames on the device as they overlap in a film (Timings::spans)
  double timeout_s = 600;
  std::string timeout_folder = {};  // where a frame that takes longer leaves what reproduces it; empty: nowhere
  std::string command = {};         // command line of the process, written there too
  int queues = 2;                   // 1: no second queue, whatever the device has
  // Memory for images that frames share, such as shadow maps of what does not move; 0: every frame makes all of its
  // images, and its times include that.
  uint64_t kept_bytes = 0;
  bool overlap = false;  // times the frame as a whole with both queues and with one (Timings::overlap)
};

}  // namespace candela
