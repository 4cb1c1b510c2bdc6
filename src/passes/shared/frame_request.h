#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "base/pixel_rect.h"
#include "look/look.h"

namespace candela {

// What a frame is of a picture with a shutter or a lens (passes/post/subframes.h).
struct SubframePart {
  enum class Role : uint8_t {
    whole,     // the picture is this frame
    subframe,  // one of those that the picture is the mean of
    mean,      // it takes the sum of them, and is the picture from there on
  };
  Role role = Role::whole;
  uint32_t index = 0, count = 1;    // of a subframe
  glm::dvec2 offset_px{0};          // of its samples against the middles of pixels, right and down
  glm::ivec2 first_px{0};           // of the frame: where the picture begins
  int width_px = 0, height_px = 0;  // of the picture
  bool operator==(const SubframePart&) const = default;
};

// What the job wants of the frame.
struct FrameRequest {
  int width_px = 1280, height_px = 720;  // of the whole picture, with overscan
  std::optional<PixelRect> region = {};  // what is wanted of it; absent: all
  int samples = 4;                       // MSAA: 1 or 4
  bool want_linear = true;               // EXR: linear beauty
  bool want_display = false;             // PNG or video: tone-mapped
  // What is read back is packed as files hold it (passes/post/pack.h); else it is texels.
  bool for_files = false;
  bool exr_float = false;                   // colours are stored in 32 bits
  bool look_nonfinite = false;              // count pixels that are not finite, also of a beauty that is not read back
  bool shows_through = false;               // pictures are transparent where nothing is
  std::optional<uint32_t> behind_rgb = {};  // display output is laid over these sRGB codes there; else it has alpha
  bool sky_hidden = false;                  // the sky lights and is mirrored; behind everything is the background
  std::vector<std::string> layers;  // beside beauty: depth, normal, albedo, object_id, material_id, emission, direct
  std::vector<std::string> light_groups = {};  // layers of light by named lights; the last is that of all others
  std::string view = "beauty";                 // what display output shows: beauty, a layer, or an image of the frame
  bool view_is_light = true;                   // it goes through exposure and tone curve
  bool view_alone = false;                     // the layer that it shows is asked for by nothing else
  std::string technique = "clustered";
  std::string transparency = "sorted";  // how blended surfaces come over each other (techniques/technique.h)
  std::string tonemap = "agx";
  float exposure_ev = 0;         // stops; multiplies by 2^ev before tone mapping
  float pre_exposure_ev = 0;     // the part of it that linear pictures inside the frame have already
  int display_bits = 8;          // 8 or 16
  bool dither = true;            // before 8 bits
  uint32_t noise_seed = 0;       // differs from frame to frame
  uint32_t still_seed = 0;       // for noise that stays as it is from frame to frame
  std::string quality = "high";  // draft, normal, high, exact
  bool open_sides = false;       // light passes single-sided faces from behind
  std::string effects = "auto";  // auto, none, or names of effects separated by commas
  Look look;                     // of the frame's time
  SubframePart part;
  // Of the motion since the frame before, for which a shutter is open that one frame has (passes/post/motion_blur.h);
  // 0: none.
  double motion_share = 0;
  bool neutral_light = false;  // no light and no sky: light the object so that it is seen
  // Whether an effect is wanted that belongs to the truth of a scene (shadows, occlusion): from quality normal up.
  bool wants_true(std::string_view effect) const {
    return effects == "auto" ? quality != "draft" : names_effect(effect);
  }
  // The same for one that belongs to the look (bloom, fog): where the look has it.
  bool wants_looked(std::string_view effect, bool in_look) const {
    return effects == "auto" ? in_look : names_effect(effect);
  }
  bool display_alpha() const { return shows_through && !behind_rgb && view == "beauty"; }
  bool shown_alone(std::string_view layer) const { return view_alone && layer == view; }
  bool names_effect(std::string_view effect) const;
  bool draws_reflections() const { return wants_looked("reflections", look.reflections.has_value()); }
  // Bloom is wanted, and something that shows it.
  bool draws_bloom() const {
    const bool in_look = look.bloom.has_value(), shown = want_display && view == "beauty";
    return wants_looked("bloom", in_look) &&
           (shown || (in_look && look.bloom->in_beauty && want_linear) || has_layer("bloom"));
  }
  // A term of beauty (passes/surfaces/terms.h) is asked for as a layer, or something is made of it.
  bool wants_term(std::string_view name) const {
    return has_layer(name) || (name == "emission" && look.bloom && look.bloom->of_emission && draws_bloom());
  }
  // The light of a named group of lights: EXR has all of them, a picture the one that it shows.
  bool wants_light_group(std::string_view layer) const { return want_linear || layer == view; }
  bool wants_motion() const { return has_layer("motion") || motion_share > 0; }
  bool draws_fog() const { return look.fog && wants_looked("fog", true); }
  bool draws_probes() const { return !look.probes.empty() && wants_looked("probes", true); }
  bool draws_volumetric() const { return look.volumetric && wants_looked("volumetric", true); }
  bool has_layer(std::string_view name) const {
    for (const std::string& l : layers)
      if (l == name) return true;
    return false;
  }
  bool operator==(const FrameRequest&) const = default;
};

}  // namespace candela
