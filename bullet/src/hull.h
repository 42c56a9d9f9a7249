#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include "voxshell/field.h"
#include "voxshell/vector.h"

namespace voxshell::bullet {

/// The hull of the vertices of a polyhedral shape of Bullet's, as a field and without the shape's
/// margin. Meters, the shape's frame; good to 1e-4 of its size, as Bullet's hulls are.
class Hull {
 public:
  /// None where the points enclose no volume, or have a hull of too many faces for a ConvexField.
  static std::optional<Hull> create(std::vector<Vec3> points);

  /// Of shapes that are hulls: see collision_method_of().
  static std::vector<Vec3> points_of(const btConvexShape& shape);

  const std::vector<Vec3>& points() const { return points_; }
  const Field& field() const { return field_; }
  const std::vector<Vec3>& corners() const { return corners_; }
  /// The center of mass.
  const Vec3& middle() const { return middle_; }
  /// Whether the shape still has the points that this was made of, by their number and the last.
  bool is_of(const btConvexShape& shape) const;

 private:
  Hull(std::vector<Vec3> points, std::vector<Vec3> corners, const Vec3& middle, Field field);

  std::vector<Vec3> points_;
  std::vector<Vec3> corners_;
  Vec3 middle_;
  Field field_;
};

/// Hulls by their points: pairs and contact tests make algorithms often, of few shapes.
class Hulls {
 public:
  /// Null where there is none. For many threads at a time.
  std::shared_ptr<const Hull> of(const btConvexShape& shape);

 private:
  struct Kept {
    std::vector<Vec3> points;
    std::shared_ptr<const Hull> hull;
  };

  std::mutex mutex_;
  std::unordered_map<std::size_t, Kept> by_hash_;
  std::size_t most_ = kFew;
  static constexpr std::size_t kFew = 256;
};

}  // namespace voxshell::bullet
