#pragma once
#include <array>
#include <span>
#include <vector>

#include "job/job.h"
#include "look/look.h"
#include "passes/surfaces/probe_knobs.h"
#include "scene/environment.h"
#include "scene/view.h"
#include "shared/probes.h"
#include "sky/prefilter_sky.h"

// The image of a reflection probe (docs/understanding/reflections.md): six frames of the scene about a point, as a sky.
namespace candela {

// A probe's frames are a job's with other views, and without what is no light of surfaces and sky: fog and light in the
// air, bloom, other probes, and reflections of the scene, so that a probe shows one reflection less than the frame.
Job probe_job(Job job, const ProbeKnobs& knobs);
Look seen_by_probe(Look look);
// Of its six faces, a texel wider on each side than the cube's.
View probe_view(const ReflectionProbe& probe, int face, const ProbeKnobs& knobs);

// One face as it was drawn: four floats a pixel, rows from the top.
using ProbeFace = std::vector<float>;
// Equirectangular (scene/environment.h), with as many texels along the equator as the cube has: each the mean of four
// places. scale: times the radiance. Texels that are not finite are black; dropped counts them.
DecodedImage probe_image(const std::array<ProbeFace, 6>& faces, const ProbeKnobs& knobs, float scale, size_t& dropped);

// As the frame's skies are filtered, but for bright spots, which stay in the image: as lights they would stand at
// infinity.
IblKnobs probe_filter(const ProbeKnobs& knobs, const IblKnobs& image_light);

// Where the look's probes stand in a frame's relative space. What a device knows of them is left.
void place_probes(std::span<const ReflectionProbe> probes, const View& view, shared::ProbeLights& out);

}  // namespace candela
