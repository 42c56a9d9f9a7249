#pragma once

#include <optional>
#include <variant>

#include "contact_constants.h"
#include "pair_step.h"
#include "voxshell/contacts.h"
#include "voxshell/field.h"

namespace voxshell::bullet {

// What touches a flat surface, or an edge, comes first of its own surface in that direction: where
// two flat faces meet aslant, an edge of one of them has touched before.

/// The normal that a body shows outside a place of its surface: that of a face, or one between
/// those of the faces that meet in an edge or a corner, the direction itself where it is such a
/// one. Own frame.
///
/// @param direction  Unit length, out of the body.
/// @param distance   How far outside, meters.
template <class F>
Vec3 normal_outside(const F& own, const Vec3& place, const Vec3& direction, double distance) {
  const auto outside = static_cast<Vec3f>(place + distance * direction);
  return normalized(static_cast<Vec3>(own.gradient(outside)));
}
inline Vec3 normal_outside(const Field& own, const Vec3& place, const Vec3& direction,
                           double distance) {
  return std::visit(
      [&](const auto& field) { return normal_outside(field, place, direction, distance); }, own);
}

/// The direction in which an edge shows what lies between its faces: at right angles to it. None
/// where the edge points in the direction by more than 60 degrees: its end shows itself there.
inline std::optional<Vec3> around_edge(const Vec3& along, const Vec3& direction) {
  const Vec3 around = direction - dot(direction, along) * along;
  if (length(around) < kFacesEdge) return std::nullopt;
  return normalized(around);
}

/// Whether other parts of its surface come before a contact of an edge or of a flat face, even if
/// the body turns as it may within the step. Of models by tolerance, whose shells have all edges.
///
/// @param turning  Of the contact's own body.
/// @param reach    Deeper contacts are not behind, meters.
bool is_behind_face(const Contact& contact, const Side& own, const Turning& turning, double reach);

}  // namespace voxshell::bullet
