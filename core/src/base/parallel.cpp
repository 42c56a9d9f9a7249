#include "voxshell/parallel.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <mutex>
#include <new>
#include <thread>
#include <vector>

#if defined(__unix__)
#include <sys/mman.h>
#endif

#include "voxshell/ordinary_floats.h"

namespace voxshell {
namespace {

/// Memory that the system has to spare as long as this lives, and gets back at its end: an
/// allocator may keep what it is given back.
class Reserve {
 public:
#if defined(__unix__)
  Reserve()
      : memory_(mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ == MAP_FAILED) throw std::bad_alloc();
  }
  ~Reserve() { munmap(memory_, kBytes); }
#else
  Reserve() = default;
  ~Reserve() = default;
#endif
  Reserve(const Reserve&) = delete;
  Reserve& operator=(const Reserve&) = delete;

#if defined(__unix__)
 private:
  static constexpr std::size_t kBytes = 1 << 17;
  void* memory_;
#endif
};

}  // namespace

bool parallel_for(std::size_t count, unsigned threads, std::string_view stage,
                  const Progress& progress, const std::function<void(std::size_t)>& task,
                  const std::function<void()>& begin_helper) {
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
  // ends the process. Each helper therefore asks as it starts, while nothing else here allocates,
  // and from memory that was set aside for it.
  static_cast<void>(std::current_exception());
  std::atomic<std::size_t> allowed{0};  // helpers that may ask
  std::atomic<std::size_t> ready{0};    // helpers that have asked
  std::atomic<bool> begun{false};
  const auto help = [&](std::size_t number) {
    for (std::size_t i = allowed; i <= number; i = allowed) allowed.wait(i);
    static_cast<void>(std::current_exception());
    if (begin_helper) begin_helper();
    ++ready;
    ready.notify_one();
    begun.wait(false);
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
        const std::size_t number = helpers.size();
        {
          const Reserve reserve;
          helpers.emplace_back(help, number);
        }
        ++allowed;
        allowed.notify_all();
        for (std::size_t i = ready; i <= number; i = ready) ready.wait(i);
        return true;
      } catch (const std::exception&) {
        return false;
      }
    };
    while (helpers.size() < helper_count && start_helper()) {
    }
    begun = true;
    begun.notify_all();
    work(true);
  }
  if (failure != nullptr) std::rethrow_exception(failure);
  if (!stopped) report();
  return !stopped;
}

bool parallel_for_ranges(std::size_t count, std::size_t size, unsigned threads,
                         std::string_view stage, const Progress& progress,
                         const std::function<void(std::size_t, std::size_t)>& task) {
  return parallel_for((count + size - 1) / size, threads, stage, progress,
                      [&](std::size_t i) { task(i * size, std::min(count, (i + 1) * size)); });
}

}  // namespace voxshell
