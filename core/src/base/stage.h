#pragma once

#include <chrono>
#include <string_view>

#include "voxshell/progress.h"

namespace voxshell {

/// One stage of a build and whether it was asked to stop. Work that sees `stopped()` returns early
/// with whatever it has, which its caller throws away.
class Stage {
 public:
  /// `progress` may be empty, and must outlive the stage.
  Stage(const Progress& progress, std::string_view name) : progress_(progress), name_(name) {}

  /// Fractions done that are reported from now on, 0 to 1, count from `from` to `to` of the stage.
  void set_part(double from, double to) {
    from_ = from;
    to_ = to;
  }

  /// Reports unless it has just done so; cheap enough to call every few microseconds.
  void report(double done) {
    const auto now = Clock::now();
    if (stopped_ || (now - last_report_ < kReportEvery && done < 1.0)) return;
    last_report_ = now;
    stopped_ = progress_ && !progress_(name_, from_ + (to_ - from_) * done);
  }

  bool stopped() const { return stopped_; }

  /// For work that reports by itself: its 0 to 1 count `from` to `to` of this stage's part. Refers
  /// to this stage.
  Progress as_progress(double from, double to) {
    return [this, from, to](std::string_view, double done) {
      report(from + (to - from) * done);
      return !stopped_;
    };
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr auto kReportEvery = std::chrono::milliseconds(50);

  const Progress& progress_;
  std::string_view name_;
  double from_ = 0.0;
  double to_ = 1.0;
  Clock::time_point last_report_{};
  bool stopped_ = false;
};

}  // namespace voxshell
