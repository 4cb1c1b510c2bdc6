#pragma once
#include <list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/error_truth.h"
#include "bench/row.h"
#include "bench/sweep_places.h"

namespace candela {

// Compares the pictures of a place's rows, one of each view, with its references.
class ErrorJudge {
 public:
  // truths: of each view. exposures: of hdr-flip; nullopt: from the first view's reference `claimed`. hdr_flip: it is
  // measured, which takes longer than all other metrics.
  ErrorJudge(std::vector<std::vector<Truth>> truths, std::string claimed, const std::optional<ExposureRange>& exposures,
             bool hdr_flip);

  // Fills errors, thumbnail and strip of a row, which stays where it is. Its error against its technique's exact
  // picture is filled when that picture comes, if what was seen until then could be kept.
  void see(const SweepRow& planned, BenchRow& row, std::vector<FloatImage> images);
  // The row planned as `planned` does the work of a row that was seen: it is one more name of it.
  void see_same(const SweepRow& planned, BenchRow& row);
  const std::vector<std::vector<Truth>>& truths() const { return truths_; }

 private:
  struct Seen {
    BenchRow* row = nullptr;
    std::vector<FloatImage> images;  // of each view; empty: they were not kept
    bool whole = false;
  };
  void take_exact(const std::string& technique, const std::vector<FloatImage>& images);
  PictureError of_exact(const std::string& technique, const Seen& seen) const;
  PictureError compared(const Truth& truth, size_t view, const Seen& seen) const;
  void forget_beyond_limit();

  std::vector<std::vector<Truth>> truths_;
  std::string claimed_;
  std::optional<ExposureRange> exposures_;
  bool hdr_flip_;
  std::map<std::string, std::vector<FloatImage>> exact_;  // by technique, of each view
  std::list<Seen> seen_;
};

}  // namespace candela
