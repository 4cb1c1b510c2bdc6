#pragma once
#include <string>
#include <vector>

#include "image/image.h"
#include "job/picture_window.h"
#include "render/reference_frame.h"

namespace candela {

// Layers of the reference that `render` has too, of the surface at the pixel's centre: depth, normal, albedo,
// object_id, material_id, in its units and channels.
const std::vector<std::string>& surface_layer_names();

// Those of Cryptomatte.
const std::vector<std::string>& matte_layer_names();

// Layers that the film holds as means over its samples: the terms that beauty is the sum of, together with fog
// (reference/terms.h), and fractions of light, which are no light: shadow, shadow_local, occlusion.
const std::vector<std::string>& term_layer_names();
// What the film of these layers must keep.
reference::FilmParts film_parts(const ReferenceFrame& frame, const std::vector<std::string>& layers);

// Adds those of `layers` that are surface layers. type: of normal and colours; depth is always float.
void add_surface_layers(FloatImage& image, const ReferenceFrame& frame, const PictureWindow& window,
                        const std::vector<std::string>& layers, ChannelType type);
// Adds the layer motion, where it is among them, as `render` measures it: the frame holds the time before.
void add_motion_layer(FloatImage& image, const ReferenceFrame& frame, const PictureWindow& window,
                      const std::vector<std::string>& layers);
// Adds those of `layers` that are Cryptomatte's, and what names their ids: coverage by the samples of the film, of the
// nearest opaque or masked surface. At least three levels, and more where a pixel needs them.
void add_matte_layers(FloatImage& image, const ReferenceFrame& frame, const PictureWindow& window,
                      const std::vector<std::string>& layers, const reference::SamplerSettings& sampler,
                      uint64_t samples);
// Adds the light of each group of lights, under the layers' names in their order.
void add_light_group_layers(FloatImage& image, const reference::Film& film, const std::vector<std::string>& layers,
                            ChannelType type);
// Adds those of `layers` that are terms.
void add_term_layers(FloatImage& image, const reference::Film& film, const std::vector<std::string>& layers,
                     ChannelType type);

}  // namespace candela
