#include "voxshell/parallel.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "voxshell/ordinary_floats.h"

namespace voxshell {

bool parallel_for(std::size_t count, unsigned threads, std::string_view stage,
                  const Progress& progress, const std::function<void(std::size_t)>& task) {
  constexpr unsigned kMaxThreads = 256;  // beyond any gain, below what systems allow
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  threads = std::min(threads, kMaxThreads);
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stopped{false};
  std::mutex failing;
  std::exception_ptr failure;  // the first one

  const auto report = [&] {
    if (!progress) return;
    const std::size_t begun = std::min(next.load(), count);
    const double fraction =
        count == 0 ? 1.0 : static_cast<double>(begun) / static_cast<double>(count);
    if (!progress(stage, fraction)) stopped = true;
  };
  const auto do_tasks = [&](bool reports) {
    using Clock = std::chrono::steady_clock;
    constexpr auto kReportEvery = std::chrono::milliseconds(50);
    auto last_report = Clock::now();
    while (!stopped) {
      const std::size_t i = next.fetch_add(1);
      if (i >= count) return;
      task(i);
      if (reports && Clock::now() - last_report > kReportEvery) {
        report();
        last_report = Clock::now();
      }
    }
  };
  const auto work = [&](bool reports) {
    const OrdinaryFloats floats;
    try {
      do_tasks(reports);
    } catch (...) {
      stopped = true;
      const std::lock_guard lock(failing);
      if (failure == nullptr) failure = std::current_exception();
    }
  };

  // A thread allocates what it needs to throw when it first asks for it, and without memory glibc
  // ends the process: let all of them ask before any task may use the memory up.
  static_cast<void>(std::current_exception());
  std::atomic<std::size_t> ready{0};
  std::atomic<bool> all_ready{false};
  const auto help = [&] {
    static_cast<void>(std::current_exception());
    ++ready;
    ready.notify_one();
    all_ready.wait(false);
    work(false);
  };

  {
    // The calling thread works, too: one task needs no helper.
    const std::size_t helper_count =
        std::min<std::size_t>(threads, std::max<std::size_t>(count, 1)) - 1;
    std::vector<std::jthread> helpers;
    helpers.reserve(helper_count);
    // Where the system has no more threads, or memory for them, the work is done by fewer.
    const auto start_helper = [&] {
      try {
        helpers.emplace_back(help);
        return true;
      } catch (const std::exception&) {
        return false;
      }
    };
    while (helpers.size() < helper_count && start_helper()) {
    }
    for (std::size_t i = ready; i < helpers.size(); i = ready) ready.wait(i);
    all_ready = true;
    all_ready.notify_all();
    work(true);
  }
  if (failure != nullptr) std::rethrow_exception(failure);
  if (!stopped) report();
  return !stopped;
}

}  // namespace voxshell
