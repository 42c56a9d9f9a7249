#pragma once

#include <optional>

#include "posed_pair.h"
#include "voxshell/model.h"

namespace voxshell::bullet {

/// The surface of a body as contacts may slide along it: a model's smooth surface, or a ball,
/// capsule, cylinder or cone of Bullet's. Meters, the geometry's frame.
class RoundSide {
 public:
  struct Place {
    Vec3 position;
    Vec3 normal;              ///< unit length
    SmoothSurface::Place on;  ///< of models

    static Place of(const SmoothSurface& surface, const SmoothSurface::Place& on) {
      const auto [position, normal] = surface.tangent_plane(on);
      return {position, normal, on};
    }
  };

  /// None where no part of it is round. The side outlives this.
  static std::optional<RoundSide> of(const Side& side);

  const Model* model() const { return model_; }

  /// The place that is nearest to a point; none where the surface is flat there. One that is near,
  /// or null, makes the search short.
  std::optional<Place> nearest(const Vec3& point, const Place* guess = nullptr) const;

  /// The same by way of the surface, from a place near by; see SmoothSurface::nearest_from().
  std::optional<Place> nearest_from(const Place& start, const Vec3& point) const;

  /// The place that is farthest along a direction, by way of a surface that is convex by at least
  /// `least_curvature`, 1/meters: along the axis of a cylinder it stays. None where the surface is
  /// flat or not convex.
  std::optional<Place> slide(const Place& start, const Vec3& direction,
                             double least_curvature) const;

 private:
  RoundSide(const Model* model, const Field& field) : model_(model), field_(&field) {}

  const Model* model_;
  const Field* field_;
};

/// The place of a side's round surface that faces a direction, by way of the surface from a point
/// of it on; none where the surface is flat or not convex. The geometry's frame.
std::optional<Vec3> find_facing(const Side& side, const Vec3& point, const Vec3& direction,
                                double least_curvature);

/// The place of a model's rim, a sharp edge of its round surface, that is farthest along a
/// direction, by way of the rim from a point of it, or of the flat face beside it, on; none where
/// there is no rim. The model's frame.
/// @param within  How far from the rim the point may be, meters.
std::optional<Vec3> find_lowest_of_rim(const Model& model, const Vec3& point, double within,
                                       const Vec3& direction, double least_curvature);

}  // namespace voxshell::bullet
