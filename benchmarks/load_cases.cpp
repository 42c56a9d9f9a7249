#include <algorithm>
#include <benchmark/benchmark.h>
#include <chrono>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <string>
#include <unistd.h>
#include <vector>

#include "cases.h"
#include "voxshell/model_file.h"

namespace voxshell::benchmarks {
namespace {

/// A file that is gone at the end.
class TemporaryFile {
 public:
  TemporaryFile() : path_((std::filesystem::temp_directory_path() / "voxshell-XXXXXX").string()) {
    const int file = mkstemp(path_.data());
    if (file >= 0) close(file);
  }
  ~TemporaryFile() { unlink(path_.c_str()); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }

  /// Has the system forget what it keeps of it in memory.
  void forget() const {
    const int file = open(path_.c_str(), O_RDONLY);
    if (file < 0) return;
    fsync(file);
    posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED);
    close(file);
  }

 private:
  std::string path_;
};

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

}  // namespace

void register_load_cases(Bodies& bodies) {
  const auto run = [&bodies](benchmark::State& state) {
    const TemporaryFile file;
    if (auto saved = save_model(bodies.bunny(), file.path()); !saved) {
      state.SkipWithError(saved.error().message.c_str());
      return;
    }
    bool is_loaded = true;
    const auto time_loads = [&](int repeats, bool is_cold) {
      std::vector<double> seconds;
      for (int i = 0; i < repeats; ++i) {
        if (is_cold) file.forget();
        const auto start = std::chrono::steady_clock::now();
        is_loaded = load_model(file.path()) && is_loaded;
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        seconds.push_back(took.count());
      }
      return median(std::move(seconds));
    };
    double warm = 0.0;
    for (auto _ : state) {
      state.counters["cold_seconds"] = time_loads(5, true);
      warm = time_loads(21, false);
      state.SetIterationTime(warm);
    }
    if (!is_loaded) state.SkipWithError("the model that was saved cannot be loaded");
    state.counters["seconds"] = warm;
    state.counters["file_bytes"] = static_cast<double>(std::filesystem::file_size(file.path()));
  };
  const std::string name = "load/voxels_" + std::to_string(bodies.settings().resolution);
  benchmark::RegisterBenchmark(name.c_str(), run)
      ->Iterations(1)
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

}  // namespace voxshell::benchmarks
