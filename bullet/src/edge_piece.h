#pragma once

#include <cmath>

#include "contact_constants.h"
#include "posed_pair.h"

namespace voxshell::bullet {

/// A piece of an edge that leans: its places get nearer to the other body all the way to where that
/// one's surface ends. What touches an edge of the other body is the place where the two cross,
/// which moves along both. A place of the edge that was followed instead would pass the other edge,
/// and touch a face beside it.
struct EdgePiece {
  const GridField* own;
  Vec3 place;           ///< own body's frame
  Vec3 along;           ///< unit length
  Vec3 along_in_field;  ///< the same in the field's frame
  Pose path_from_own;   ///< as of a SurfacePoint
  double tolerance;     ///< of its own surface, meters
  double flat;          ///< sine up to which it lies flat, and its places are all as near
};

/// The piece of a contact's edge.
///
/// @param id     Of an edge element of the side's shell.
/// @param place  On the edge, own body's frame.
inline EdgePiece edge_piece_of(const Side& side, std::uint32_t id, const Vec3& place,
                               const Pose& path_from_own, const Pose& field_from_own, double flat) {
  const PointShell& shell = *side.participant().shell;
  const Vec3 along = normalized(static_cast<Vec3>(shell.edges()->halves()[id - shell.size()]));
  return {&side.model()->grid(),
          place,
          along,
          field_from_own.rotate(along),
          path_from_own,
          side.model()->settings().tolerance,
          flat};
}

/// Where an edge crosses one of the other body, or its place as it is.
struct Crossing {
  double along = 0.0;  ///< from that place, meters
  /// Of the field, square to both edges. Its length is how fast distances rise.
  Vec3 outwards = {};
};

/// Finds where the field's normal is square to an edge. None where that is farther from a place of
/// the edge than four times `way`, or than the edge is long, where the edge lies flat on one of the
/// two faces that it passes between, or where it passes between two walls of a thin part.
///
/// @param at   The place, in the field's frame.
/// @param way  Meters.
template <class F>
Crossing find_crossing(const EdgePiece& edge, const F& field, const Vec3& at, double way) {
  const auto normal_at = [&](double along) {
    const auto place = static_cast<Vec3f>(at + along * edge.along_in_field);
    return static_cast<Vec3>(field.gradient(place));
  };
  const auto slope_of = [&](const Vec3& normal) { return dot(normal, edge.along_in_field); };
  if (!(way > 0.0)) return {};
  Vec3 normal_before = normal_at(0.0);
  const double slope = slope_of(normal_before);
  if (std::abs(slope) <= edge.flat) return {};
  // Over a face the slope is the same all the way to its edge.
  const double side = slope > 0.0 ? -1.0 : 1.0;
  double before = 0.0;
  double beyond = kFirstSlideOfWay * way;
  Vec3 normal_beyond = normal_at(side * beyond);
  while (side * slope_of(normal_beyond) < 0.0) {
    before = beyond;
    normal_before = normal_beyond;
    beyond *= 2.0;
    if (!(beyond <= kMostSlideOfWay * way)) return {};
    normal_beyond = normal_at(side * beyond);
  }
  if (std::abs(slope_of(normal_at(2.0 * side * beyond))) <= edge.flat) return {};
  for (int i = 0; i < kSlideHalvings; ++i) {
    const double middle = 0.5 * (before + beyond);
    const Vec3 normal = normal_at(side * middle);
    const bool is_before = side * slope_of(normal) < 0.0;
    (is_before ? before : beyond) = middle;
    (is_before ? normal_before : normal_beyond) = normal;
  }
  const double along = side * beyond;
  const auto place = static_cast<Vec3f>(edge.place + along * edge.along);
  const auto off_surface = std::abs(static_cast<double>(edge.own->distance(place)));
  if (!(off_surface <= edge.tolerance)) return {};
  // Inside the other body, normals jump from that of one face to that of the other.
  const double slope_before = slope_of(normal_before);
  const double fraction = slope_before / (slope_before - slope_of(normal_beyond));
  const Vec3 outwards = normal_before + fraction * (normal_beyond - normal_before);
  if (length(outwards) < kLeastCrossing) return {};
  return {along, outwards};
}

}  // namespace voxshell::bullet
