#pragma once

#include <chrono>

#include "voxshell/bullet/contact_settings.h"

namespace voxshell::bullet {

/// Times stages that follow one another, where someone wants to know.
class StageClock {
 public:
  explicit StageClock(NarrowPhaseTimings* timings) : timings_(timings) {
    if (timings_ != nullptr) begin_ = Clock::now();
  }

  /// Adds the time since the last stage ended to this one.
  void end(double NarrowPhaseTimings::* stage) {
    if (timings_ == nullptr) return;
    const Clock::time_point now = Clock::now();
    timings_->*stage += std::chrono::duration<double>(now - begin_).count();
    begin_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;

  NarrowPhaseTimings* timings_;
  Clock::time_point begin_;
};

}  // namespace voxshell::bullet
