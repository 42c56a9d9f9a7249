#include "scene.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "voxshell/contacts_flat.h"
#include "voxshell/distance.h"
#include "voxshell/manifold.h"
#include "voxshell/wrench.h"

namespace voxshell::benchmarks {
namespace {

constexpr float kFarthest = std::numeric_limits<float>::max();
constexpr int kSegmentLevel = 4;
constexpr double kStiffness = 1e8;    // N/m3
constexpr std::size_t kBudget = 100;  // nodes

constexpr std::array kQueries = {
    SceneQuery{"flat",
               [](const Scene& scene, const Pose& pose, QueryScratch&) {
                 return find_contacts_flat(*scene.field, *scene.shell, pose).size();
               }},
    SceneQuery{"contacts",
               [](const Scene& scene, const Pose& pose, QueryScratch& scratch) {
                 return find_contacts(*scene.field, *scene.shell, pose, {}, scratch).size();
               }},
    SceneQuery{"manifold",
               [](const Scene& scene, const Pose& pose, QueryScratch& scratch) {
                 return find_manifold(*scene.field, *scene.shell, pose, 0.0f, scratch).size();
               }},
    SceneQuery{"segments",
               [](const Scene& scene, const Pose& pose, QueryScratch& scratch) {
                 return find_deepest_per_segment(*scene.field, *scene.shell, pose, kSegmentLevel,
                                                 0.0f, scratch)
                     .size();
               }},
    SceneQuery{
        "nearest",
        [](const Scene& scene, const Pose& pose, QueryScratch& scratch) {
          return std::size_t{
              find_nearest(*scene.field, *scene.shell, pose, kFarthest, scratch).has_value()};
        }},
    SceneQuery{"collides",
               [](const Scene& scene, const Pose& pose, QueryScratch&) {
                 return std::size_t{collides(*scene.field, *scene.shell, pose)};
               }},
    SceneQuery{"wrench",
               [](const Scene& scene, const Pose& pose, QueryScratch& scratch) {
                 const Wrench wrench =
                     compute_wrench(*scene.field, *scene.shell, pose, kStiffness, scratch);
                 return std::size_t{wrench.force != Vec3{}};
               }},
    SceneQuery{"budget_100",
               [](const Scene& scene, const Pose& pose, QueryScratch& scratch) {
                 return find_contacts_within_budget(*scene.field, *scene.shell, pose, {}, kBudget,
                                                    scratch)
                     .contacts.size();
               }},
};

/// The first query that differs from what the flat loop says, or nothing.
std::string_view find_difference_at(const Scene& scene, const Pose& pose, QueryScratch& scratch) {
  const Field& field = *scene.field;
  const PointShell& shell = *scene.shell;
  const auto oracle = find_contacts_flat(field, shell, pose);
  const auto is_chosen = [&](std::span<const std::uint32_t> indices,
                             std::span<const Contact> found) {
    return std::ranges::equal(indices, found, {}, [&](std::uint32_t i) { return oracle[i]; }, {});
  };
  if (!std::ranges::equal(oracle, find_contacts(field, shell, pose, {}, scratch))) {
    return "contacts";
  }
  if (collides(field, shell, pose) == oracle.empty()) return "collides";
  if (!is_chosen(select_manifold(oracle).chosen(),
                 find_manifold(field, shell, pose, 0.0f, scratch))) {
    return "manifold";
  }
  std::vector<std::uint32_t> deepest;
  select_deepest_per_segment(oracle, shell, kSegmentLevel, deepest);
  if (!is_chosen(deepest,
                 find_deepest_per_segment(field, shell, pose, kSegmentLevel, 0.0f, scratch))) {
    return "segments";
  }
  const auto nearest = find_nearest(field, shell, pose, kFarthest, scratch);
  const auto depth = std::ranges::max_element(oracle, {}, &Contact::depth);
  if (!nearest || (depth != oracle.end() && !(*nearest == *depth))) return "nearest";
  return {};
}

std::string find_difference(const Scene& scene) {
  QueryScratch scratch;
  for (std::size_t i = 0; i < scene.poses.size(); ++i) {
    const std::string_view query = find_difference_at(scene, scene.poses[i], scratch);
    if (!query.empty()) {
      return std::string(query) + " differs from the flat loop at pose " + std::to_string(i);
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
    if (scene_->why_not.empty() && scene_->poses.empty()) {
      scene_->why_not = "no pose is as deep as is wanted";
    }
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
    state.counters["least_us"] = times.least;
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
