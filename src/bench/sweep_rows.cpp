#include "bench/sweep_rows.h"

#include <algorithm>
#include <map>

#include "base/log.h"
#include "bench/error_analysis.h"
#include "render/outputs.h"

namespace candela {

std::unique_ptr<Measured> SweepRows::measured_of(const SweepRow& planned) const {
  Suite named = suite_;
  named.name = planned.suite;
  return std::make_unique<Measured>(planned.configuration, named, settings_);
}

BenchRow SweepRows::named_row(const SweepRow& planned) const { return measured_of(planned)->row; }

BenchRow& SweepRows::add_unmeasured(const SweepRow& planned, const std::string& truth) {
  OpenRow& open = rows_.emplace_back(OpenRow{planned, measured_of(planned), 0});
  open.measured->row.truth = truth;
  return open.measured->row;
}

OpenRow* SweepRows::measure(SweepRow planned, ErrorJudge& judge) {
  std::unique_ptr<Measured> measured = measured_of(planned);
  OpenRow& row = rows_.emplace_back(OpenRow{std::move(planned), std::move(measured), 0});
  const double start_s = time_.elapsed_s();
  std::vector<FloatImage> images;
  const auto opened = row.measured->open_in(
      *session_, [&] { return time_.over(); },
      [&](size_t, const FrameResult& frame, const Session& session) {
        NonFinite nonfinite;
        images.push_back(
            linear_image(frame, row.planned.configuration.job, session, std::nullopt, FrameRate{}, nonfinite));
      });
  used_ = row.measured.get();
  if (!opened) {
    log::error("{}: {}", row_title(row.measured->row), opened.error().text());
    row.measured->fail_with(opened.error());
    return nullptr;
  }
  if (!*opened) {
    rows_.pop_back();
    used_ = nullptr;
    ++interrupted_;
    return nullptr;
  }
  const int moment = -int(rows_.size());
  const int samples = time_.limited() ? 2 : 1;
  for (int i = 0; i < samples && (i == 0 || !time_.over()); ++i) visit(row, moment, i == 0);
  // The first row again, beside this one, unless that is dear.
  OpenRow& clock = rows_.front();
  if (&clock != &row && clock.measured->can_sample() && !time_.over() &&
      clock.visit_s < 0.25 * (time_.elapsed_s() - start_s))
    visit(clock, moment, false);
  // After the times: a device that waits for a comparison lowers its clocks.
  judge.see(row.planned, row.measured->row, std::move(images));
  took_s_.push_back(time_.elapsed_s() - start_s);
  tell(row, row.measured->row.truth);
  save();
  return &row;
}

void SweepRows::visit(OpenRow& row, int round, bool warm) {
  const double before = time_.elapsed_s();
  const bool visited = !warm && used_ != row.measured.get();
  // A row's first sample is taken though the time is over: else its picture would have been made for nothing.
  const bool first = row.measured->row.gpu.ms.empty();
  const auto sampled = row.measured->sample_in(*session_, round, visited, [&] { return !first && time_.over(); });
  used_ = row.measured.get();
  if (!sampled) row.measured->fail_with(sampled.error());
  row.visit_s = time_.elapsed_s() - before;
}

void SweepRows::tell(const OpenRow& row, const std::string& truth) const {
  const BenchRow& r = row.measured->row;
  const auto error = error_of(r, truth, "relmse");
  log::info("{}: {}{}{}", error_setting(r),
            r.gpu.ms.empty() ? "no time" : fmt::format("{:.3g} ms", summary(r.gpu.ms).median),
            error ? fmt::format(", relmse {:.3g} against {}", *error, truth) : "",
            time_.limited() ? fmt::format(" ({:.0f} s left)", std::max(0.0, time_.left_s())) : "");
}

void SweepRows::sample_rounds(const std::string& truth) {
  for (int round = 1; !time_.over(); ++round) {
    std::vector<OpenRow*> active;
    for (OpenRow& row : rows_)
      if (row.measured->can_sample() && (time_.limited() || row.measured->wants_sample())) active.push_back(&row);
    if (active.empty()) return;
    if (time_.limited()) {
      if (round > suite_.sampling.max_runs) return;
      choose_for_rounds(active, truth);
    }
    for (const size_t k : round_order(active.size(), suite_.sampling.order_seed, round)) {
      if (time_.over()) break;
      visit(*active[k], round, false);
    }
    save();
  }
}

void SweepRows::choose_for_rounds(std::vector<OpenRow*>& active, const std::string& truth) const {
  std::vector<const BenchRow*> rows;
  for (const OpenRow* row : active) rows.push_back(&row->measured->row);
  std::map<const BenchRow*, int> rank;
  for (const ErrorPoint& point : error_points(rows, truth, "relmse")) rank[point.row] = int(point.standing);
  std::ranges::stable_sort(active, {}, [&](const OpenRow* row) {
    const auto found = rank.find(&row->measured->row);
    return std::pair(found == rank.end() ? 3 : found->second, row->visit_s);
  });
  constexpr double rounds = 4;
  double sum_s = 0;
  size_t count = 0;
  for (const OpenRow* row : active) {
    sum_s += row->visit_s;
    if (count >= 2 && sum_s * rounds > time_.left_s()) break;
    ++count;
  }
  active.resize(count);
}

std::vector<BenchRow> SweepRows::so_far() const {
  std::vector<BenchRow> rows;
  for (const OpenRow& row : rows_) rows.push_back(row.measured->row);
  return rows;
}

}  // namespace candela
