#pragma once
#include "passes/debug/mattes.h"
#include "passes/shared/blended.h"
#include "passes/shared/fog_view.h"
#include "passes/shared/light_lists.h"
#include "passes/shared/reflected.h"
#include "passes/shared/sampled_depth.h"
#include "passes/shared/scene_inputs.h"
#include "passes/shared/seen_through.h"
#include "passes/shared/views.h"
#include "passes/surfaces/sample_store.h"
#include "passes/surfaces/terms.h"
#include "techniques/frame.h"

namespace candela {

// What passes work on of the picture where a region of it is wanted; absent: all of it, and notes say why.
std::optional<PictureParts> picture_parts(const SceneFacts& facts, const FrameRequest& request, const KnobValues& knobs,
                                          std::vector<std::string>& notes);

// A frame is surfaces -> lighting -> composite -> post. Each is a function that techniques share; a technique is how
// surfaces meet lights.

// What the camera sees of the opaque and masked geometry.
struct Surfaces {
  Draws draws;              // what is in view
  BufferHandle kept_items;  // a bit for each item in view
  BufferHandle deformed;    // vertices of skinned and morphed sections; may be empty
  ImageHandle depth;        // of the nearest surface at every sample; empty: nothing is opaque or masked
  SampledDepth looked_up;   // the same for compute
  Draws visible;            // of what is in view, what the depth does not hide, for passes that test against it
  BufferHandle keys;        // which triangles these are, where compute rasterizes them (passes/geometry/rasterize.h)
};
Surfaces visible_surfaces(Frame& frame, const SceneInputs& scene);
// The same geometry seen by one picture of a supersampled frame: a depth of its own.
Surfaces seen_again(Frame& frame, const SceneInputs& scene, Surfaces surfaces, std::string_view instance);

// The keys of the pixels' middles, whatever the frame's samples; empty where the hardware draws, or lines and points
// too. name: of what asks for them.
BufferHandle keys_of_middles(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, std::string_view name,
                             std::string_view instance);

// What surfaces that are drawn again are tested against for equality: as the hardware finds it, for the depth of keys
// differs in its last bits. name: of the pass that finds it.
ImageHandle depth_of_hardware(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, std::string_view name);

// What is seen through fog: the grid of its light, or how points do without. Made once, for all samples of a picture.
FogView fog_view(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting);
// For passes that walk no lights unless the fog does.
Lighting fog_alone(const Lighting& lists);
Lighting fog_to_infinity(const Lighting& lists);  // the same for what stands in no slice
// The depth maps of directional lights' cascades, and of point and spot lights, and what see-through surfaces leave of
// that light; empty: none casts a shadow.
void shadow_maps(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, Lighting& lighting);
// Whether they are drawn: the views of maps have room for see-through surfaces too.
bool draws_shadow_colors(const SceneFacts& facts, const FrameRequest& request, const KnobValues& knobs);
// Cells of the view that know which lights are seen from them; empty: none does.
LightVoxels light_voxels(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lists);
// The lists of lights for surfaces of this depth, and nothing else.
Lighting light_cells(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, std::string_view instance = {});
// All that surfaces and air are lit by: lists, ambient occlusion, trees for rays, shadow maps, cells of the view, fog.
// occlusion: of the layer, which shows it where shading does not take it too. pictures: of a supersampled frame, whose
// surfaces take that of their own depth.
struct FrameLighting {
  Lighting lighting;
  OcclusionTexels occlusion;
};
FrameLighting light_surfaces(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, uint32_t pictures);

// How open to the sky the opaque and masked surfaces of a depth are. Of several samples of a pixel each has its own
// part of the slices (SceneInputs::subsample).
OcclusionTexels ambient_occlusion(Frame& frame, const SceneInputs& scene, const SampledDepth& depth,
                                  std::string_view instance = {});
// Whether shading takes it; it may be made for its layer alone.
bool shades_occluded(const Frame& frame);

// The opaque and masked surfaces as a technique shades them; empty: there are none.
struct Shaded {
  ImageHandle color;
  bool has_background = false;  // what is behind them is in it
  bool whole = false;           // and the pixels' samples are resolved: nothing is drawn over it
};
// Everything that is not an opaque or masked surface, over and behind them, in order, and what the surfaces reflect of
// each other. `shaded` may be empty.
struct Composite {
  ImageHandle radiance;   // linear, with premultiplied alpha, multisampled where the request is, unless `resolved`
  ImageHandle depth;      // of the surfaces, and of those that let light through
  SeenThrough seen;       // by these
  Reflected reflected;    // empty: surfaces reflect the sky alone
  bool resolved = false;  // the radiance has one sample a pixel, whatever the request
};
Composite composite(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                    const Shaded& shaded, std::string_view instance = {});

// How blended surfaces come over each other (FrameRequest::transparency), and the pass that draws them over `in.color`:
// the new version of it, or empty where the frame does without the pass.
struct TransparencyMethod {
  std::string_view name, description;
  ImageHandle (*draw)(Frame&, const BlendedIn& in, std::string_view instance);
};
std::span<const TransparencyMethod> transparency_methods();
// By the method that the request names.
ImageHandle transparent(Frame& frame, const BlendedIn& in, std::string_view instance = {});

// The part of beauty that `shader` draws (Fragments::part), where surfaces see and are drawn as beauty's: blended
// surfaces over `image`, by the method layers. Where another method is chosen the part's own pass draws them.
bool stores_blended(const Frame& frame);
ImageHandle part_behind_blended(Frame& frame, BlendedIn in, std::string_view shader, std::string_view layer,
                                std::string_view instance);

// Layers of the nearest surface and of what lit it, as far as they are asked for. Passes publish them.
void describe(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
              const OcclusionTexels& occlusion);

// Beauty's terms (passes/surfaces/terms.h) as composite() would have them, as far as layers ask for them.
using TermImages = std::array<ImageHandle, term_count>;
TermImages divide(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                  const Composite& composite, std::string_view instance = {});
// Resolves them like beauty, publishes and returns them.
TermImages publish_terms(Frame& frame, const SceneInputs& scene, TermImages terms);

// The light of named groups of lights (--light-groups), in the same way; its sum is that of the terms direct_*.
using LightGroupImages = std::vector<ImageHandle>;
LightGroupImages divide_lights(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces,
                               const Lighting& lighting, const Composite& composite, std::string_view instance = {});
void publish_light_groups(Frame& frame, const SceneInputs& scene, const LightGroupImages& images);

// The layers of fog, in the same way.
using FogImages = std::array<ImageHandle, 2>;
FogImages fog_layers(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                     const Composite& composite, std::string_view instance = {});
void publish_fog(Frame& frame, const SceneInputs& scene, const FogImages& images);

// Cryptomatte: ids at the samples of beauty, picture by picture of a supersampled frame, and their ranks.
using MatteImages = std::array<ImageHandle, matte_count>;
void matte_ids(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, MatteImages& images,
               std::string_view instance = {});
void publish_mattes(Frame& frame, const SceneInputs& scene, const MatteImages& images, uint32_t pictures);

// A picture of several frames (passes/post/subframes.h): a subframe adds its images to sums of their names, which
// whoever runs the frames keeps for the next and clears before none; the last frame takes them.
void add_to_sum(Frame& frame, const SceneInputs& scene, const std::string& name, ImageHandle image);
ImageHandle mean_of(Frame& frame, const SceneInputs& scene, const std::string& name);
// Whether a layer is light, so that those of subframes are summed; of others the picture's own time has one.
bool is_summed(std::string_view layer);
// The sums' buffers in a plan: what a frame takes of those before it, and what it leaves to the next.
inline constexpr std::string_view sum_before = "sum_before.", sum_after = "sum.";

// The sinks of the frame: beauty, display output and layers, as far as they are asked for, each as it is or, for files,
// as they hold it.
void read_back(Frame& frame, const SceneInputs& scene, ImageHandle beauty, ImageHandle display);

// From a frame's radiance to what the host gets: resolve, light in the air, bloom, tone mapping, read-back of all
// outputs and layers that are asked for. emission: resolved, where the look's bloom is of that alone.
void post(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
          ImageHandle radiance, bool resolved, ImageHandle emission);

using ShadeFunction = Shaded (*)(Frame&, const SceneInputs&, const Surfaces&, const Lighting&,
                                 std::string_view instance);
struct Technique {
  std::string_view name, description;
  ShadeFunction shade;
  LightGridKind light_grid;
  // A visibility buffer, and how it is made.
  enum class Keys { none, rasterized, traced } keys = Keys::none;
  // Knobs that it begins with in the place of a quality's; --set comes after.
  std::span<const KnobSetting> presets = {};
  // Shades other points of the surfaces than the hardware does: pixels differ in their last bits.
  constexpr bool own_pixels() const { return keys != Keys::none; }
};
std::span<const Technique> techniques();
// What the values of a layer are; light for beauty.
LayerForm layer_form(std::string_view layer);

// The whole frame.
void build_frame(Frame& frame, const SceneInputs& scene, const Technique& technique);

// The samples that a pass in compute has shaded, as an image.
ImageHandle sampled_image(Frame& frame, const SceneInputs& scene, const SampleStore& samples,
                          std::string_view instance);

Shaded forward(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
               std::string_view instance);
Shaded deferred(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                std::string_view instance);
Shaded deferred_volumes(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                        std::string_view instance);
Shaded visibility(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                  std::string_view instance);
// Draws surfaces over the colour, which may be empty, by the hardware; lines_alone: and points, without triangles.
ImageHandle draw_forward(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                         ImageHandle color, bool lines_alone, std::string_view instance);

// A pass that draws over an image gives it a new version; one that was left out leaves the old.
template <class Handle>
Handle newest(Handle made, Handle before) {
  return made ? made : before;
}

}  // namespace candela
