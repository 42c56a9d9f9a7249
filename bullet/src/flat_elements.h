#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// What is asked about two surfaces that may touch. Meters.
struct TouchScale {
  double radius;     ///< of the smaller body; surfaces are compared at fractions of it
  double margin;     ///< contacts with a wider gap stay as they are
  double thickness;  ///< of Bullet's margins about the field
};

/// Gives contacts of flat parts of the shell the normal of their element, turned over, and the
/// depth along it, where the field's surface bends more. Where two surfaces touch, the normal lies
/// in the cones of normals of both: a flat part has one normal alone, an edge, a rounded edge or a
/// ball has many. The field's own normal at a point of a flat ground is that of the nearest place
/// of what stands on it: aslant beside an edge or under a facet.
///
/// Drops contacts outside the field that have nothing in front of their element: they lie beside
/// the field's body. Edge elements stay as they are.
class FlatElements {
 public:
  /// `contacts` ascend by id; `own` is the field of the shell's body.
  void align(std::vector<Contact>& contacts, const Field& field, const PointShell& shell,
             const GridField& own, const Pose& field_from_shell, const TouchScale& scale);

 private:
  /// From which of kFlatScales on the shell's body bends about a point.
  struct Bend {
    std::uint32_t id;
    std::size_t from;
  };

  const PointShell* shell_ = nullptr;  ///< of which bends_ are
  std::vector<Bend> bends_;            ///< of the contacts of the step before
  std::vector<Bend> next_;
};

}  // namespace voxshell::bullet
