#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "voxshell/pose.h"

namespace voxshell::benchmarks {

/// Between the passes over a pose set a query meets other poses; between its own repeats it does
/// not. Cold: all caches are flushed before each query.
enum class Visit { kPassByPass, kRepeated, kCold };

/// Microseconds of single queries.
struct QueryTimes {
  double median = 0.0;  ///< over poses, of the median over a pose's repeats
  double least = 0.0;  ///< over poses, of the least: without the turns of a shared machine's others
  double mean = 0.0;   ///< over all queries
  double p99 = 0.0;    ///< over all queries
  double worst = 0.0;
  std::size_t queries = 0;
  double answer = 0.0;                 ///< mean over poses of what the query returned
  double allocations_per_query = 0.0;  ///< once warm
};

/// Asks about one pose; returns a number that stands for the answer, such as how many contacts.
using Query = std::function<std::size_t(const Pose&)>;

/// Times `query` on every pose as often as fits into `seconds`: 3 to 101 times, once where cold.
QueryTimes time_queries(std::span<const Pose> poses, Visit visit, double seconds,
                        const Query& query);

/// What the clock adds to each single time, microseconds: the median of two readings in a row.
double clock_overhead();

}  // namespace voxshell::benchmarks
