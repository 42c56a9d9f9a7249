#include "query_timer.h"

#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <numeric>
#include <unistd.h>

#include "allocation_count.h"

namespace voxshell::benchmarks {
namespace {

using Clock = std::chrono::steady_clock;

double microseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::micro>(duration).count();
}

/// The smallest value that at least `fraction` of all do not exceed; reorders them.
double quantile(std::vector<double>& values, double fraction) {
  if (values.empty()) return 0.0;
  const double rank = std::ceil(fraction * static_cast<double>(values.size()));
  const auto at = static_cast<std::ptrdiff_t>(std::max(rank, 1.0)) - 1;
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

/// Writes to more memory than the caches hold.
void flush_caches() {
  constexpr std::size_t kLeast = std::size_t{64} << 20;
  constexpr std::size_t kLine = 64;
  static std::vector<std::uint8_t> memory(
      std::max(kLeast, 2 * static_cast<std::size_t>(std::max(0L, sysconf(_SC_LEVEL3_CACHE_SIZE)))));
  for (std::size_t i = 0; i < memory.size(); i += kLine) ++memory[i];
  benchmark::ClobberMemory();
}

}  // namespace

QueryTimes time_queries(std::span<const Pose> poses, Visit visit, double seconds,
                        const Query& query) {
  QueryTimes times;
  if (poses.empty()) return times;

  std::vector<double> answers;
  const Clock::time_point warm_up = Clock::now();
  for (const Pose& pose : poses) answers.push_back(static_cast<double>(query(pose)));
  const double pass_seconds = microseconds(Clock::now() - warm_up) * 1e-6;
  const std::size_t allocated = allocation_count();
  for (const Pose& pose : poses) benchmark::DoNotOptimize(query(pose));
  times.allocations_per_query =
      static_cast<double>(allocation_count() - allocated) / static_cast<double>(poses.size());

  const double fitting = std::clamp(seconds / std::max(pass_seconds, 1e-9), 3.0, 101.0);
  const std::size_t repeats = visit == Visit::kCold ? 1 : static_cast<std::size_t>(fitting) | 1;
  std::vector<std::vector<double>> by_pose(poses.size(), std::vector<double>(repeats));
  const auto time_one = [&](std::size_t pose, std::size_t repeat) {
    if (visit == Visit::kCold) flush_caches();
    const Clock::time_point start = Clock::now();
    std::size_t answer = query(poses[pose]);
    const Clock::time_point end = Clock::now();
    benchmark::DoNotOptimize(answer);
    by_pose[pose][repeat] = microseconds(end - start);
  };
  if (visit == Visit::kRepeated) {
    for (std::size_t pose = 0; pose < poses.size(); ++pose) {
      benchmark::DoNotOptimize(query(poses[pose]));
      for (std::size_t repeat = 0; repeat < repeats; ++repeat) time_one(pose, repeat);
    }
  } else {
    for (std::size_t repeat = 0; repeat < repeats; ++repeat) {
      for (std::size_t pose = 0; pose < poses.size(); ++pose) time_one(pose, repeat);
    }
  }

  std::vector<double> all;
  std::vector<double> medians;
  std::vector<double> leasts;
  for (std::vector<double>& repeated : by_pose) {
    all.insert(all.end(), repeated.begin(), repeated.end());
    medians.push_back(quantile(repeated, 0.5));
    leasts.push_back(quantile(repeated, 0.0));
  }
  times.queries = all.size();
  times.median = quantile(medians, 0.5);
  times.least = quantile(leasts, 0.5);
  times.mean = std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size());
  times.p99 = quantile(all, 0.99);
  times.worst = quantile(all, 1.0);
  times.answer =
      std::accumulate(answers.begin(), answers.end(), 0.0) / static_cast<double>(poses.size());
  return times;
}

double clock_overhead() {
  std::vector<double> readings(10001);
  for (double& reading : readings) {
    const Clock::time_point start = Clock::now();
    const Clock::time_point end = Clock::now();
    reading = microseconds(end - start);
  }
  return quantile(readings, 0.5);
}

}  // namespace voxshell::benchmarks
