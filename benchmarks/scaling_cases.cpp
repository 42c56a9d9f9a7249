#include <cstddef>
#include <string>

#include "cases.h"
#include "pose_sets.h"
#include "scene.h"

namespace voxshell::benchmarks {
namespace {

constexpr std::size_t kMostPoses = 60;

}  // namespace

void register_scaling_cases(Bodies& bodies) {
  const Settings& settings = bodies.settings();
  const std::size_t poses = std::min(settings.poses, kMostPoses);
  const auto add = [&](const std::string& name, std::function<Scene()> make) {
    const auto scene = std::make_shared<LazyScene>(std::move(make));
    for (const SceneQuery& query : scene_queries()) {
      register_query(name, scene, query, Visit::kPassByPass, settings);
    }
  };
  for (const std::size_t points : {1'000u, 10'000u, 100'000u, 1'000'000u}) {
    if (settings.quick && points > 100'000) continue;
    add("points_" + std::to_string(points), [&bodies, points, poses] {
      const Field& plane = bodies.slab().field();
      const PointShell& shell = bodies.bunny_shell(points);
      return Scene{&plane, &shell, make_resting_poses(bodies, poses), {}};
    });
  }
  for (const int resolution : {50, 100, 300, 1000}) {
    if (settings.quick && resolution > 300) continue;
    add("voxels_" + std::to_string(resolution), [&bodies, resolution, poses] {
      const Built& built = bodies.bunny_at(resolution);
      if (!built) return Scene{nullptr, nullptr, {}, built.why_not};
      const Field& field = built.model->field();
      const PointShell& shell = bodies.bunny_shell(bodies.settings().fine_points);
      return Scene{
          &field,
          &shell,
          make_pair_poses(bodies, field, shell, {0.0005, 0.002}, DrawnFrom::kCenters, poses),
          {}};
    });
  }
}

}  // namespace voxshell::benchmarks
