#include "scene.h"

#include <algorithm>
#include <array>

#include "voxshell/contacts_flat.h"

namespace voxshell::benchmarks {
namespace {

constexpr std::array kQueries = {
    SceneQuery{"flat",
               [](const Scene& scene, const Pose& pose, QueryScratch&) {
                 return find_contacts_flat(*scene.field, *scene.shell, pose).size();
               }},
    SceneQuery{"contacts",
               [](const Scene& scene, const Pose& pose, QueryScratch& scratch) {
                 return find_contacts(*scene.field, *scene.shell, pose, {}, scratch).size();
               }},
    SceneQuery{"collides",
               [](const Scene& scene, const Pose& pose, QueryScratch&) {
                 return std::size_t{collides(*scene.field, *scene.shell, pose)};
               }},
};

std::string find_difference(const Scene& scene) {
  QueryScratch scratch;
  for (std::size_t i = 0; i < scene.poses.size(); ++i) {
    const auto oracle = find_contacts_flat(*scene.field, *scene.shell, scene.poses[i]);
    const auto found = find_contacts(*scene.field, *scene.shell, scene.poses[i], {}, scratch);
    const bool touches = collides(*scene.field, *scene.shell, scene.poses[i]);
    if (!std::ranges::equal(oracle, found) || touches == oracle.empty()) {
      return "differs from the flat loop at pose " + std::to_string(i);
    }
  }
  return {};
}

const char* name_of(Visit visit) {
  switch (visit) {
    case Visit::kPassByPass:
      return "warm";
    case Visit::kRepeated:
      return "repeated";
    case Visit::kCold:
      return "cold";
  }
  return "";
}

}  // namespace

std::span<const SceneQuery> scene_queries() { return kQueries; }

const SceneQuery& scene_query(std::string_view name) {
  return *std::ranges::find(kQueries, name,
                            [](const SceneQuery& q) { return std::string_view(q.name); });
}

const Scene& LazyScene::get() {
  if (!scene_) {
    scene_ = make_();
    if (scene_->why_not.empty()) scene_->why_not = find_difference(*scene_);
  }
  return *scene_;
}

void register_query(const std::string& scene_name, const std::shared_ptr<LazyScene>& scene,
                    const SceneQuery& query, Visit visit, const Settings& settings) {
  const std::string name = scene_name + '/' + query.name + '/' + name_of(visit);
  const auto run = [=](benchmark::State& state) {
    const Scene& ready = scene->get();
    if (!ready.why_not.empty()) {
      state.SkipWithError(ready.why_not.c_str());
      return;
    }
    std::span<const Pose> poses = ready.poses;
    if (visit == Visit::kCold) poses = poses.first(std::min(poses.size(), settings.cold_poses));
    QueryScratch scratch;
    QueryTimes times;
    for (auto _ : state) {
      times = time_queries(poses, visit, settings.seconds,
                           [&](const Pose& pose) { return query.ask(ready, pose, scratch); });
      state.SetIterationTime(times.median * 1e-6);
    }
    state.counters["median_us"] = times.median;
    state.counters["mean_us"] = times.mean;
    state.counters["p99_us"] = times.p99;
    state.counters["worst_us"] = times.worst;
    state.counters["queries"] = static_cast<double>(times.queries);
    state.counters["poses"] = static_cast<double>(poses.size());
    state.counters["points"] = static_cast<double>(ready.shell->size());
    state.counters["answer"] = times.answer;
    state.counters["allocations"] = times.allocations_per_query;
  };
  benchmark::RegisterBenchmark(name.c_str(), run)
      ->Iterations(1)
      ->UseManualTime()
      ->Unit(benchmark::kMicrosecond);
}

}  // namespace voxshell::benchmarks
