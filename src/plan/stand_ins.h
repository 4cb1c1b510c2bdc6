#pragma once
#include <vector>

#include "scene/frame_data.h"

namespace candela {

// Lights for what others give beyond their ends, where those are too many to be walked one by one: the clusters of
// lightcuts (Walter et al. 2005), by grids. The window of a range R leaves w(d / R) of a light (KHR_lights_punctual); a
// stand-in for it gives w(d / 2R) - w(d / R), the next for that w(d / 4R) - w(d / 2R), and so on to one without an end:
// together they give all of it. Each gives its light from farther off than the last, so it may stand for more: all
// lights of a cell, `spacing` of R wide, are one light in their middle by intensity. It is as bright as they are from
// where they lie close together; a surface amid them, or between them, may see it on another side. A surface that lies
// along a flat crowd gets light by how high above it lamps are, however far off: so the crowd's shortest axis is never
// cut into fewer cells than `layers`.
//
// Gives every point light without a range one, about where it gives floor_lux, by steps of two, so that lights share
// stand-ins; and appends these. Spots and what is not a number keep what they have. Returns how many lights got an end.
size_t end_with_stand_ins(std::vector<LightItem>& lights, float floor_lux, double spacing, int layers = 1);

// What is left of a light at a distance from it: the window of its range, or of a stand-in.
double window_of(const LightItem& light, double distance_m);

}  // namespace candela
