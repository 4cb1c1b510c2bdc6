#pragma once
#include <optional>

#include "image/image.h"
#include "job/job.h"
#include "scene/view.h"

namespace candela {

MetadataEntry text_entry(const char* name, std::string text);
MetadataEntry number_entry(const char* name, MetadataEntry::Kind kind, double number);

// The job as files keep it: of absolute paths, which hold on one machine only, the names of the files.
Job without_folders(const Job& job);
// "01:02:03:04", the frames counted as they come (non-drop); empty where the rate or the frame has none.
std::string time_code(int64_t frame, FrameRate rate);

// Which camera saw the picture, and when: matrices, frame and rate (absent when the job was given a time), time.
void add_view_metadata(FloatImage& image, const View& view, double time_s, std::optional<int64_t> frame_number,
                       FrameRate rate);

}  // namespace candela
