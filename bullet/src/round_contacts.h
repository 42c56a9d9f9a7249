#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "flat_elements.h"
#include "voxshell/contacts.h"
#include "voxshell/model.h"

namespace voxshell::bullet {

/// Slides contacts of a shell along its smooth surface to where that surface and the field's are at
/// their deepest, so that a ball does not roll over its samples. The contacts that end at one place
/// become one. Docs: decision 34.
class RoundContacts {
 public:
  /// @param contacts          Of `model`'s shell in `field`, ascending by id; changed.
  /// @param field_from_shell  Pose of the shell's frame in the field's.
  void slide(std::vector<Contact>& contacts, const Model& model, const Field& field,
             const Pose& field_from_shell, const TouchScale& scale);

  /// Drops those of `others`, contacts of the field's own shell, from which the surface of this
  /// shell leads to one of the contacts of the last slide().
  ///
  /// @param other_from_shell  Pose of this shell's frame in that of `others`.
  void drop_covered(std::vector<Contact>& others, const PointShell& shell_of_others,
                    const Pose& other_from_shell) const;

 private:
  struct AtRest {
    SmoothSurface::Place place;
    Vec3 position;  ///< metres, the shell's frame
  };

  template <class F>
  bool slide_one(Contact& contact, const F& field, const Pose& field_from_shell,
                 const TouchScale& scale);
  bool is_known(const Vec3& position) const;

  const SmoothSurface* surface_ = nullptr;
  double least_curvature_ = 0.0;
  double same_within_ = 0.0;  ///< metres
  std::vector<AtRest> at_rest_;
};

}  // namespace voxshell::bullet
