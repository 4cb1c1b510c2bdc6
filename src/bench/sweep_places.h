#pragma once
#include <string>
#include <vector>

#include "bench/row.h"
#include "bench/scene_store.h"
#include "bench/suite.h"

namespace candela {

// What a sweep of error against time measures.
struct SweepRow {
  std::string suite;  // "whole", or "knob PASS.KNOB"
  Configuration configuration;
  std::vector<KnobPoint> knobs;  // of which it is a point
  std::vector<SameWork> same_work;
};
// A scene with its lights, size, camera and time: its rows share views and references. Of each technique the exact end
// comes first.
struct SweepPlace {
  std::vector<SweepRow> rows;
  std::vector<BenchView> views;
  std::vector<std::string> notes;  // what is not measured, for it would be the same work again
};

// Every technique at every quality, and every knob that trades error or time over the values of its sweep, with every
// technique whose plan has one of the knob's passes, all else at its exact end. What plans the same frames in all
// views, to the last pipeline, constant and light box, is one row, whatever its technique, quality and knobs are
// called. Scenes are loaded to be planned; one that cannot be has no knobs swept, and fails when it is measured. Errors
// (usage): of the suite.
Expected<std::vector<SweepPlace>> sweep_places(const Suite& base, SceneStore& store);

// The same places with every technique at every quality alone, and nothing planned: each its own row, and no views.
Expected<std::vector<SweepPlace>> whole_places(const Suite& base);

}  // namespace candela
