#pragma once

#include <cstdint>
#include <optional>

#include "motion.h"
#include "pair_step.h"
#include "voxshell/contacts.h"
#include "voxshell/model.h"

namespace voxshell::bullet {

/// Whether the points of the shell are those of the larger body. Triangles are no bodies.
bool is_shell_larger(const PairStep& step);

/// Moves a contact, along the surface, to where a place of the field's body is now. Of two places
/// that will touch, solvers are to see that of the smaller body where it is: with the lever of the
/// other it would be turned, not stopped.
void put_on_field(const PairStep& step, const Vec3& on_field, Contact& contact);

/// Whether an element of a model's shell is a point of a curved part of its smooth surface.
bool lies_on_curve(const Model& model, std::uint32_t element);

/// Whether a contact is at the place of a curved surface that faces the other body.
bool is_facing(const PairStep& step, const Contact& contact);

/// The smaller body's round surface, which touches a plane with the place that faces it: whatever
/// place of a ball has turned to the ground when they touch, it is the ball's lowest one. Solvers
/// would brake what rolls by the lever of another place. Decision 58.
class RoundTouch {
 public:
  /// @param motion    Of the shell as the field sees it, in the shell's frame.
  /// @param fraction  Of the step, after which a place touches.
  /// @param gap       That is left there, meters.
  RoundTouch(const PairStep& step, const RelativeMotion& motion, double fraction, double gap);

  /// Moves a contact to where the surface faces its plane now. Left alone are places that do not
  /// face the plane once they have turned, and bodies that hardly turn.
  /// @param path  Of the place that was followed.
  void move(const Path& path, Contact& contact);

 private:
  std::optional<Vec3> face(const Vec3& direction) const;
  Vec3 after(const Vec3& place) const;
  template <class F>
  auto ask_other(const F& ask) const;
  bool ends_beside(const Vec3& place, const Vec3& normal) const;
  bool meet_face(const Path& path, const Vec3& own);
  bool meet_edge(const Path& path, const Vec3& own);
  bool meet_face_with_rim(const Path& path);
  bool meet(const Path& path, const Model& model, std::uint32_t id);

  const PairStep& step_;
  const RelativeMotion& motion_;
  double fraction_;
  double gap_;
  bool is_shell_;
  const Side& side_;
  Pose own_from_shell_;
  Pose shell_from_own_;
  RelativeMotion of_side_;
  bool is_rim_ = false;  ///< what touches is the rim of the round surface
  double rim_within_;    ///< places of flat faces that are nearer to the rim are of it, meters
  // Shell's frame.
  Vec3 place_;     ///< of the surface now
  Vec3 outwards_;  ///< of the other body's plane
};

}  // namespace voxshell::bullet
