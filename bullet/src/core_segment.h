#pragma once

#include <optional>

#include "posed_pair.h"

namespace voxshell::bullet {

/// A segment along a convex shape, of which all balls of `radius` lie in the shape.
struct CoreSegment {
  Vec3 from;
  Vec3 to;
  double radius;
};

/// Of a shape of Bullet's: along the axis of round shapes, the longest side of a box, and between
/// the corners of a hull that are farthest from its middle and from there. None of balls, whose
/// middle is all of it, of planes and of models. The frame of the side's geometry.
std::optional<CoreSegment> core_segment_of(const Side& side);

/// The contact of a shape of Bullet's that pierces a model: it enters through one face and leaves
/// through another, between the model's elements, and none of its corners and rims is inside. It
/// is of the deepest place of its core segment, if that is deeper than `tolerance`, meters. Its id
/// is 0, and its normal is zero where the field has no direction.
///
/// @param field_from_shell  Of the pair, or displaced.
std::optional<Contact> find_piercing(const PosedPair& pair, const Pose& field_from_shell,
                                     double tolerance);

}  // namespace voxshell::bullet
