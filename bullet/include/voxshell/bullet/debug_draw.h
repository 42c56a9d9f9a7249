#pragma once

#include <cstddef>
#include <cstdint>

#include <LinearMath/btIDebugDraw.h>

#include "voxshell/bullet/model_shape.h"

namespace voxshell::bullet {

/// What Bullet's own debug drawing does not show of a model: debugDrawWorld() draws its mesh, as of
/// any concave shape, and its contact points. Call these beside it, with a body's world transform.

struct PointDrawing {
  /// Points have the colours of their segments on this level, 1 (all of one colour) to 12.
  int level = 4;
  /// Of the line that stands for a point, along its normal, metres. Negative: the points' spacing.
  double length = -1.0;
  /// Of more points than this, evenly chosen ones are drawn.
  std::size_t most_points = 10'000;
};

/// The points of a model's shell, each as a line from the point outwards.
void draw_points(btIDebugDraw& drawer, const ModelShape& shape, const btTransform& world_from_body,
                 const PointDrawing& drawing = {});

/// The spheres of the point-sphere tree on a level, in the colours of their segments. Levels start
/// at 1, the root; beyond the tree's last, that is drawn.
void draw_spheres(btIDebugDraw& drawer, const ModelShape& shape, const btTransform& world_from_body,
                  int level);

/// Red, green and blue, 0 to 1: neighbouring segments have hues far apart.
btVector3 segment_color(std::uint32_t segment);

}  // namespace voxshell::bullet
