#include <algorithm>
#include <benchmark/benchmark.h>
#include <chrono>
#include <numeric>
#include <string>
#include <vector>

#include "cases.h"
#include "pose_sets.h"
#include "voxshell/batch.h"

namespace voxshell::benchmarks {
namespace {

constexpr double kReach = 0.3;
constexpr std::size_t kPosesPerBatch = 2'400;
constexpr int kBatches = 21;

/// The sum of the answers, or -1.
using AskBatch = double (*)(const Model&, const std::vector<Pose>&, unsigned threads);

double ask_collides(const Model& bunny, const std::vector<Pose>& poses, unsigned threads) {
  const auto answers = collides_batch(bunny.field(), bunny.shell(), poses, 0.0f, threads);
  return answers ? std::accumulate(answers->begin(), answers->end(), 0.0) : -1.0;
}

double ask_contacts(const Model& bunny, const std::vector<Pose>& poses, unsigned threads) {
  const auto batch = find_contacts_batch(bunny.field(), bunny.shell(), poses, {}, threads);
  return batch ? static_cast<double>(batch->contacts.size()) : -1.0;
}

/// Microseconds a pose, over batches.
void add(Bodies& bodies, const std::string& query, AskBatch ask, unsigned threads) {
  const auto run = [&bodies, ask, threads](benchmark::State& state) {
    const Model& bunny = bodies.bunny();
    const std::vector<Pose> poses = make_random_poses(kReach, kPosesPerBatch);
    std::vector<double> times;
    double answer = 0.0;
    for (auto _ : state) {
      for (int i = 0; i < kBatches; ++i) {
        const auto start = std::chrono::steady_clock::now();
        answer = ask(bunny, poses, threads);
        const std::chrono::duration<double, std::micro> took =
            std::chrono::steady_clock::now() - start;
        times.push_back(took.count() / static_cast<double>(poses.size()));
      }
      std::ranges::sort(times);
      state.SetIterationTime(1e-6 * times[times.size() / 2]);
    }
    if (answer < 0.0) state.SkipWithError("a batch failed");
    state.counters["answer"] = answer / static_cast<double>(poses.size());
    state.counters["median_us"] = times[times.size() / 2];
    state.counters["p99_us"] = times.back();
  };
  const std::string name =
      "batch_random/" + query + (threads == 1 ? "/one_thread" : "/all_threads");
  benchmark::RegisterBenchmark(name.c_str(), run)->Iterations(1)->UseManualTime();
}

}  // namespace

void register_batch_cases(Bodies& bodies) {
  for (const unsigned threads : {1u, 0u}) {
    add(bodies, "collides", &ask_collides, threads);
    add(bodies, "contacts", &ask_contacts, threads);
  }
}

}  // namespace voxshell::benchmarks
