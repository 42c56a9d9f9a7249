#pragma once

#include <cstddef>
#include <cstdint>

#include <LinearMath/btIDebugDraw.h>

#include "voxshell/bullet/model_shape.h"

namespace voxshell::bullet {

/// Settings for drawing what Bullet's debug drawing does not show of a model: debugDrawWorld()
/// draws its mesh, as of any concave shape, and its contact points. Call these functions after it,
/// with a body's world transform.

struct PointDrawing {
  /// Points have the colors of their segments on this level, 1 (one color for all) to 12.
  int level = 4;
  /// Length of the line that shows a point, along its normal, meters. Negative: the points'
  /// spacing.
  double length = -1.0;
  /// If there are more points than this, an even selection of them is drawn.
  std::size_t most_points = 10'000;
};

/// Draws the points of a model's shell, each as a line from the point outward.
void draw_points(btIDebugDraw& drawer, const ModelShape& shape, const btTransform& world_from_body,
                 const PointDrawing& drawing = {});

/// Draws the spheres of the point-sphere tree on a level, in the colors of their segments. Levels
/// start at 1, the root; a larger number draws the tree's last level.
void draw_spheres(btIDebugDraw& drawer, const ModelShape& shape, const btTransform& world_from_body,
                  int level);

/// Red, green and blue, 0 to 1. Neighboring segments have very different hues.
btVector3 segment_color(std::uint32_t segment);

}  // namespace voxshell::bullet
