#include "voxshell/parallel.h"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <new>
#include <string_view>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace voxshell::parallel_test {
namespace {

TEST(ParallelFor, DoesEveryTaskOnce) {
  for (const unsigned threads : {0u, 1u, 2u, 7u, 1000u}) {
    for (const std::size_t count : {0u, 1u, 2u, 5u, 1000u}) {
      std::vector<std::atomic<int>> done(count);
      EXPECT_TRUE(parallel_for(count, threads, "", {}, [&](std::size_t i) { ++done.at(i); }));
      for (const auto& times : done) EXPECT_EQ(times, 1);
    }
  }
}

TEST(ParallelFor, TakesAnyNumberOfThreads) {
  std::atomic<int> done{0};
  EXPECT_TRUE(parallel_for(100'000, 4'000'000'000u, "", {}, [&](std::size_t) { ++done; }));
  EXPECT_EQ(done, 100'000);
}

TEST(ParallelFor, ReportsFromTheCallingThreadUpToTheEnd) {
  const auto caller = std::this_thread::get_id();
  double last = -1.0;
  const auto progress = [&](std::string_view stage, double fraction) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    EXPECT_EQ(stage, "stage");
    EXPECT_GE(fraction, last);
    last = fraction;
    return true;
  };
  // Long enough for reports on the way.
  EXPECT_TRUE(parallel_for(400, 4, "stage", progress, [](std::size_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }));
  EXPECT_EQ(last, 1.0);
  last = -1.0;
  EXPECT_TRUE(parallel_for(0, 4, "stage", progress, [](std::size_t) {}));
  EXPECT_EQ(last, 1.0);
}

TEST(ParallelFor, StopsBeforeTheEndWhereProgressSaysSo) {
  // The first report comes after 50 ms, when almost all of these tasks are still to do.
  for (const unsigned threads : {1u, 3u}) {
    std::atomic<std::size_t> done{0};
    const auto progress = [](std::string_view, double) { return false; };
    EXPECT_FALSE(parallel_for(100'000, threads, "", progress, [&](std::size_t) {
      ++done;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }));
    EXPECT_GT(done, 0u);
    EXPECT_LT(done, 90'000u);
  }
}

TEST(ParallelFor, RefusalOfTheLastReportCounts) {
  EXPECT_FALSE(
      parallel_for(1, 1, "", [](std::string_view, double) { return false; }, [](std::size_t) {}));
}

TEST(ParallelFor, AnExceptionInAnyThreadArrivesAtTheCaller) {
  for (const unsigned threads : {1u, 4u}) {
    std::atomic<std::size_t> done{0};
    const auto task = [&](std::size_t i) {
      if (i == 7) throw std::bad_alloc();
      ++done;
      std::this_thread::sleep_for(std::chrono::microseconds(10));
    };
    EXPECT_THROW(parallel_for(100'000, threads, "", {}, task), std::bad_alloc);
    EXPECT_LT(done, 90'000u);  // tasks not yet begun are left out
  }
}

TEST(ParallelFor, AnExceptionInAHelperAloneArrivesAtTheCaller) {
  const auto caller = std::this_thread::get_id();
  std::atomic<bool> has_thrown{false};
  const auto task = [&](std::size_t) {
    if (std::this_thread::get_id() != caller) {
      has_thrown = true;
      throw std::bad_alloc();
    }
    while (!has_thrown) std::this_thread::yield();
  };
  EXPECT_THROW(parallel_for(100, 4, "", {}, task), std::bad_alloc);
}

TEST(ParallelFor, BeginsEachHelperBeforeItsTasks) {
  const auto caller = std::this_thread::get_id();
  std::atomic<int> begun{0};
  const auto begin = [&] {
    EXPECT_NE(std::this_thread::get_id(), caller);
    ++begun;
  };
  const auto task = [&](std::size_t) { EXPECT_EQ(begun, 3); };
  EXPECT_TRUE(parallel_for(100, 4, "", {}, task, begin));
}

TEST(ParallelForRanges, DoesEveryIndexOnceInRangesOfOneSize) {
  for (const std::size_t count : {0u, 1u, 9u, 10u, 11u, 1000u}) {
    std::vector<std::atomic<int>> done(count);
    EXPECT_TRUE(parallel_for_ranges(count, 10, 3, "", {}, [&](std::size_t begin, std::size_t end) {
      EXPECT_EQ(begin % 10, 0u);
      EXPECT_TRUE(end == begin + 10 || end == count);
      for (std::size_t i = begin; i < end; ++i) ++done.at(i);
    }));
    for (const auto& times : done) EXPECT_EQ(times, 1);
  }
}

TEST(ParallelForRanges, StopsWhereProgressSaysSo) {
  const auto refuse = [](std::string_view, double) { return false; };
  EXPECT_FALSE(parallel_for_ranges(1, 10, 1, "", refuse, [](std::size_t, std::size_t) {}));
}

}  // namespace
}  // namespace voxshell::parallel_test
