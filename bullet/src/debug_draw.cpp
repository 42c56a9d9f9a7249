#include "voxshell/bullet/debug_draw.h"

#include <algorithm>
#include <cmath>

#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {
namespace {

Pose world_from_model(const ModelShape& shape, const btTransform& world_from_body) {
  return from_bullet(world_from_body) * shape.body_from_model();
}

}  // namespace

void draw_points(btIDebugDraw& drawer, const ModelShape& shape, const btTransform& world_from_body,
                 const PointDrawing& drawing) {
  const PointShell& shell = shape.model().shell();
  const Pose pose = world_from_model(shape, world_from_body);
  const double length = drawing.length >= 0.0 ? drawing.length : shell.spacing();
  const int level = std::clamp(drawing.level, 1, PointSphereTree::kMaxLevel);
  // Neighbors in the tree's order are neighbors in space.
  const std::size_t count = std::min(drawing.most_points, shell.size());
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t id = i * shell.size() / count;
    const Vec3 point = pose.transform_point(static_cast<Vec3>(shell.points()[id]));
    const Vec3 tip = point + length * pose.rotate(static_cast<Vec3>(shell.normals()[id]));
    const std::uint32_t segment = shell.tree().segment(static_cast<std::uint32_t>(id), level);
    drawer.drawLine(to_bullet(point), to_bullet(tip), segment_color(segment));
  }
}

void draw_spheres(btIDebugDraw& drawer, const ModelShape& shape, const btTransform& world_from_body,
                  int level) {
  const PointSphereTree& tree = shape.model().shell().tree();
  const Pose pose = world_from_model(shape, world_from_body);
  std::uint32_t segment = 0;
  for (const Sphere& sphere : tree.spheres(std::clamp(level, 1, tree.level_count()))) {
    drawer.drawSphere(to_bullet(pose.transform_point(static_cast<Vec3>(sphere.center))),
                      static_cast<btScalar>(sphere.radius), segment_color(segment++));
  }
}

btVector3 segment_color(std::uint32_t segment) {
  constexpr double kGoldenRatio =
      0.6180339887498949;  // of the circle of hues, from each to the next
  double turns = 0.0;
  const double hue = std::modf(kGoldenRatio * segment, &turns);
  const auto channel = [&](double offset) {
    const double away = std::abs(std::remainder(hue - offset, 1.0));
    return std::clamp(2.0 - 6.0 * away, 0.0, 1.0);
  };
  return to_bullet(Vec3{channel(0.0), channel(1.0 / 3.0), channel(2.0 / 3.0)});
}

}  // namespace voxshell::bullet
