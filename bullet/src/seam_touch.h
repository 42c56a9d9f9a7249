#pragma once

#include "voxshell/vector.h"

namespace voxshell::bullet {

/// A contact as one of its bodies sees it. Meters, world frame.
struct Touch {
  Vec3 on_body;
  Vec3 normal;  ///< of the other body, toward this one
  double gap;   ///< negative where they overlap
  bool is_feature;

  Vec3 on_other() const { return on_body - gap * normal; }
};

/// What a contact at a seam becomes.
struct Seam {
  Vec3 normal;    ///< of the plane that the flush surfaces have in common
  double gap;     ///< along it, meters
  bool supports;  ///< else the contact is removed
};

/// Where the body of a touch meets the other one. Forces, and motion along them, would take a body
/// that slides into its ground, so they are kept apart.
struct Arrival {
  bool is_in_time;  ///< within the step; else it is a guard (decision 51)
  Vec3 place;
  Vec3 fall;  ///< how much farther it is where nothing supports the body
};

/// The direction, along a surface of that normal, in which another normal leans.
inline Vec3 leaning_over(const Vec3& normal, const Vec3& upwards) {
  return normalized(normal - dot(normal, upwards) * upwards);
}

}  // namespace voxshell::bullet
