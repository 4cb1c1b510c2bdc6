#pragma once
#include <optional>

#include "image/image.h"
#include "job/job.h"
#include "scene/view.h"

namespace candela {

MetadataEntry text_entry(const char* name, std::string text);
MetadataEntry number_entry(const char* name, MetadataEntry::Kind kind, double number);

// Which camera saw the picture, and when: matrices, frame and rate (absent when the job was given a time), time.
void add_view_metadata(FloatImage& image, const View& view, double time_s, std::optional<int64_t> frame_number,
                       FrameRate rate);

}  // namespace candela
