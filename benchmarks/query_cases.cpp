#include <algorithm>
#include <cmath>

#include "cases.h"
#include "pose_sets.h"
#include "scene.h"
#include "support/closest_point_tree.h"
#include "voxshell/contacts_flat.h"
#include "voxshell/plane_field.h"

namespace voxshell::benchmarks {
namespace {

constexpr DepthRange kShallow{0.0005, 0.002};
constexpr DepthRange kDeep{0.010, 0.030};
constexpr DepthRange kDeepest{0.0735, 0.0737};
constexpr DepthRange kNearMiss{-0.003, -0.001};
constexpr double kRandomReach = 0.3;

const Field& analytic_plane() {
  static const Field plane = PlaneField{};
  return plane;
}

/// How deep a million points reach into the bunny, by exact distances to its triangles.
class TrueDepth {
 public:
  explicit TrueDepth(Bodies& bodies)
      : field_(bodies.bunny().field()),
        finest_(bodies.bunny_shell(1'000'000)),
        closest_(bodies.bunny_mesh()),
        doubt_(4.0 * bodies.settings().voxel_size()) {}

  /// Looks at some hundred of the points that the field has among the deepest.
  double at(const Pose& field_from_shell) const {
    constexpr std::size_t kMostLookedAt = 500;
    auto contacts = find_contacts_flat(field_, finest_, field_from_shell);
    const float deepest = std::ranges::max(contacts, {}, &Contact::depth).depth;
    std::erase_if(contacts, [&](const Contact& c) {
      return static_cast<double>(c.depth) < static_cast<double>(deepest) - doubt_;
    });
    double depth = 0.0;
    const std::size_t stride = 1 + contacts.size() / kMostLookedAt;
    for (std::size_t i = 0; i < contacts.size(); i += stride) {
      const Vec3 p = field_from_shell.transform_point(static_cast<Vec3>(contacts[i].point));
      depth = std::max(depth, std::sqrt(closest_.find_closest(p).squared_distance));
    }
    return depth;
  }

 private:
  const Field& field_;
  const PointShell& finest_;
  test_support::ClosestPointTree closest_;
  double doubt_;  ///< how far the field may be off, meters
};

/// How far the deepest contact that is reported is from the true depth, with the bunny's shell or
/// one of so many points.
void register_depth_error(Bodies& bodies, const char* name, std::size_t points = 0) {
  const auto run = [&bodies, points](benchmark::State& state) {
    const Model& bunny = bodies.bunny();
    const PointShell& shell = points == 0 ? bunny.shell() : bodies.bunny_shell(points);
    const std::size_t count = std::min<std::size_t>(bodies.settings().poses, 60);
    const auto poses =
        make_pair_poses(bodies, bunny.field(), bunny.shell(), kDeepest, DrawnFrom::kCore, count);
    if (poses.empty()) {
      state.SkipWithError("no pose is as deep as is wanted");
      return;
    }
    const TrueDepth true_depth(bodies);
    std::vector<double> errors;
    for (auto _ : state) {
      for (const Pose& pose : poses) {
        const auto contacts = find_contacts_flat(bunny.field(), shell, pose);
        const float deepest = std::ranges::max(contacts, {}, &Contact::depth).depth;
        errors.push_back(std::abs(static_cast<double>(deepest) - true_depth.at(pose)) /
                         bodies.settings().voxel_size());
      }
      state.SetIterationTime(1.0);
    }
    std::ranges::sort(errors);
    state.counters["voxels"] = errors.back();
    state.counters["median_voxels"] = errors[errors.size() / 2];
    state.counters["fraction_within_voxel"] =
        static_cast<double>(std::ranges::upper_bound(errors, 1.0) - errors.begin()) /
        static_cast<double>(errors.size());
    state.counters["spacing_voxels"] = shell.spacing() / bodies.settings().voxel_size();
  };
  benchmark::RegisterBenchmark(name, run)->Iterations(1)->UseManualTime();
}

}  // namespace

void register_query_cases(Bodies& bodies) {
  const Settings& settings = bodies.settings();
  const auto add = [&](const char* name, std::function<Scene()> make,
                       std::initializer_list<Visit> visits) {
    const auto scene = std::make_shared<LazyScene>(std::move(make));
    for (const SceneQuery& query : scene_queries()) {
      for (const Visit visit : visits) {
        // The flat loop is what others are compared with, visit by visit or not.
        const bool is_flat = &query == scene_queries().data();
        if (is_flat && visit != Visit::kPassByPass) continue;
        register_query(name, scene, query, visit, settings);
      }
    }
  };
  const auto resting_on = [&](const Field& plane, const PointShell& shell) {
    return Scene{&plane, &shell, make_resting_poses(bodies, settings.poses), {}};
  };
  const auto pair = [&](DepthRange range, DrawnFrom drawn_from = DrawnFrom::kCenters) {
    const Model& bunny = bodies.bunny();
    return Scene{
        &bunny.field(),
        &bunny.shell(),
        make_pair_poses(bodies, bunny.field(), bunny.shell(), range, drawn_from, settings.poses),
        {}};
  };
  constexpr auto kWarm = Visit::kPassByPass;
  constexpr auto kCold = Visit::kCold;
  constexpr auto kRepeated = Visit::kRepeated;

  add("voxelised_plane",
      [=, &bodies] { return resting_on(bodies.slab().field(), bodies.bunny().shell()); },
      {kWarm, kRepeated, kCold});
  add("analytic_plane",
      [=, &bodies] { return resting_on(analytic_plane(), bodies.bunny().shell()); },
      {kWarm, kRepeated, kCold});
  add("pair_shallow", [=] { return pair(kShallow); }, {kWarm, kRepeated, kCold});
  add("pair_deep", [=] { return pair(kDeep); }, {kWarm, kRepeated, kCold});
  add("pair_deepest", [=] { return pair(kDeepest, DrawnFrom::kCore); }, {kWarm, kCold});
  if (!settings.quick) {
    register_depth_error(bodies, "pair_deepest/depth_error");
    register_depth_error(bodies, "pair_deepest/depth_error_78000", 78'000);
    register_depth_error(bodies, "pair_deepest/depth_error_313000", 313'000);
  }
  add("near_miss", [=] { return pair(kNearMiss); }, {kWarm, kRepeated, kCold});
  add("coarse_voxelised_plane",
      [=, &bodies] {
        return resting_on(bodies.slab().field(),
                          bodies.bunny_shell(bodies.settings().coarse_points));
      },
      {kWarm, kRepeated, kCold});
  add("pair_random",
      [&bodies] {
        const Model& bunny = bodies.bunny();
        return Scene{&bunny.field(),
                     &bunny.shell(),
                     make_random_poses(kRandomReach, bodies.settings().poses),
                     {}};
      },
      {kWarm, kCold});
}

}  // namespace voxshell::benchmarks
