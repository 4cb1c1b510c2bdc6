#include "cli/picture_options.h"

#include "job/frame_choices.h"

namespace candela::cli {
namespace {

void add_layer_options(CLI::App& command, JobOptions& o) {
  command
      .add_option("--view", o.view,
                  "What PNG and video show: beauty, any layer (light_NAME of --light-groups, too), or "
                  "debug.PASS.IMAGE[mip,layer], an image of the frame")
      ->capture_default_str()
      ->type_name("NAME");
  command
      .add_option("--layers", o.layers, "EXR layers beside beauty, separated by commas, or all (candela list layers)")
      ->type_name("LIST");
}

}  // namespace

void add_picture_options(CLI::App& command, JobOptions& o, Renderer renderer) {
  command
      .add_option("--shading", o.shading,
                  "Reflection model: pbr, blinn-phong (Blinn's lobe instead of microfacets, no layers), or lambert "
                  "(the base colour, without gloss)")
      ->capture_default_str()
      ->type_name("NAME");
  command
      .add_option("--exposure", o.exposure,
                  "Exposure in stops, instead of the look's; 0 by default; auto: one value for the whole film, metered "
                  "at fixed times")
      ->type_name("EV");
  command
      .add_option(
          "--tonemap", o.tonemap,
          "Tone curve of PNG, over the look's: agx (where neither says; Rec. 709 primaries), agx-2020 (Rec. 2020, "
          "as Blender), none, reinhard, reinhard-luminance, aces, neutral (Khronos) or rec709 (the camera curve)")
      ->type_name("NAME");
  if (renderer == Renderer::gpu) add_layer_options(command, o);
  command
      .add_option("--background", o.background,
                  "What is seen where there is no sky: transparent; a display colour by name or #rrggbb, put behind "
                  "PNG and video; or linear R,G,B of the scene")
      ->capture_default_str()
      ->type_name("COLOR");
  command.add_option("--seed", o.seed, "Seed of all noise")
      ->transform(whole_number<uint64_t>())
      ->capture_default_str()
      ->type_name("N");
  command.add_option("--exr-type", o.exr_type, "Colour channels of EXR: half or float")
      ->capture_default_str()
      ->type_name("NAME");
  command
      .add_option("--exr-compression", o.exr_compression, "none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa or dwab")
      ->capture_default_str()
      ->type_name("NAME");
  command.add_option("--png-bits", o.png_bits, "Bits a channel of PNG: 8 or 16")->capture_default_str()->type_name("N");
  command.add_flag("--no-dither", o.no_dither, "Round to 8 bits without dither");
  if (renderer == Renderer::gpu)
    command.add_flag("--metadata-timings", o.metadata_timings,
                     "Write timings into the EXR header; the file's bytes then differ from run to run");
  command.add_flag("--allow-nonfinite", o.allow_nonfinite, "Write images that hold NaN or infinity instead of exit 7");
}

}  // namespace candela::cli
