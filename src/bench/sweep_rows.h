#pragma once
#include <functional>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "bench/deadline.h"
#include "bench/error_judge.h"
#include "bench/measured.h"
#include "bench/sweep_places.h"

namespace candela {

// A row while it is measured.
struct OpenRow {
  SweepRow planned;
  std::unique_ptr<Measured> measured;
  double visit_s = 0;  // of a sample, with the frame before it
};

// The rows of a place of a sweep, which share a session: they are measured when they are opened, beside the first of
// them, and then in rounds. Rows stay where they are.
class SweepRows {
 public:
  // suite: what a timed frame leaves, and how often it is measured. progress gets all rows after each one and each
  // round.
  SweepRows(Suite suite, RunSettings settings, const Deadline& time,
            std::function<void(const std::vector<BenchRow>&)> progress)
      : suite_(std::move(suite)), settings_(std::move(settings)), time_(time), progress_(std::move(progress)) {}
  void attach(Session& session) { session_ = &session; }  // before the first is measured

  BenchRow& add_unmeasured(const SweepRow& row, const std::string& truth);
  // Renders every view and compares it, then takes the first samples. Null where it failed, which the row says, or
  // where the time ended before its pictures were whole: then there is no row.
  OpenRow* measure(SweepRow planned, ErrorJudge& judge);
  // All rows again and again, in a new order each time, until each has its number of samples. Within a budget until the
  // time is over: as many rows as four rounds fit, those first that no other surely beats against `truth`.
  void sample_rounds(const std::string& truth);
  void forget_visit() { used_ = nullptr; }  // another had the session since
  // As `planned` would be named, without a measurement.
  BenchRow named_row(const SweepRow& planned) const;

  std::list<OpenRow>& all() { return rows_; }
  std::vector<BenchRow> so_far() const;
  int interrupted() const { return interrupted_; }      // rows that there are not, for the time was over
  double typical_s() const { return median(took_s_); }  // time of a row until it has its first samples

 private:
  std::unique_ptr<Measured> measured_of(const SweepRow& planned) const;
  // warm: the frame before was of the same settings.
  void visit(OpenRow& row, int round, bool warm);
  void tell(const OpenRow& row, const std::string& truth) const;
  void choose_for_rounds(std::vector<OpenRow*>& active, const std::string& truth) const;
  void save() const {
    if (progress_) progress_(so_far());
  }

  Suite suite_;
  RunSettings settings_;
  const Deadline& time_;
  std::function<void(const std::vector<BenchRow>&)> progress_;
  Session* session_ = nullptr;
  std::list<OpenRow> rows_;
  const Measured* used_ = nullptr;  // whose settings the session has
  std::vector<double> took_s_;      // of each row
  int interrupted_ = 0;
};

}  // namespace candela
