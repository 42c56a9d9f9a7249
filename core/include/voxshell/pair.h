#pragma once

#include <optional>

#include "voxshell/accuracy.h"
#include "voxshell/contacts.h"
#include "voxshell/field.h"
#include "voxshell/point_shell.h"
#include "voxshell/pose.h"
#include "voxshell/result.h"

namespace voxshell {

/// One body of a pair. Analytic fields come without a shell.
struct Participant {
  const Field* field = nullptr;
  const PointShell* shell = nullptr;
  /// Of a model; without it, the worst case that spacing and voxels allow counts.
  const Accuracy* accuracy = nullptr;
  /// Of a model where it is thinnest, metres; 0: the shortest side of its bounds counts.
  double thickness = 0.0;
  /// Of a model: a place deep inside.
  const Vec3f* inner_point = nullptr;
};

enum class PairBody { kA, kB };

inline PairBody other(PairBody body) { return body == PairBody::kA ? PairBody::kB : PairBody::kA; }

/// Whose elements are tested against the other's field.
enum class Role { kA, kB, kBoth };

enum class ShellChoice {
  /// By accuracy (decision 0026): see decide_role().
  kAutomatic,
  /// The body with fewer points (thesis, section 5.3), a where they are equal; the other where
  /// these points lie farther apart than its own and its shortest side, so that it could slip
  /// between them, or, pose by pose, where that one encloses it: see is_enclosed().
  kFewest,
  kA,
  kB,
  kBoth,
};

/// Who is the shell of a pair, and what queries can then miss. Metres. Measured, not proved: a
/// contact that is deeper than `miss` is found.
struct PairRole {
  Role role = Role::kA;
  /// The one that is asked, or of both the one that meets truer normals: those of a smooth body
  /// turn least between its elements.
  PairBody first = PairBody::kA;
  double miss = 0.0;       ///< with this role
  double miss_of_a = 0.0;  ///< with the elements of a alone; infinity where a has no shell
  double miss_of_b = 0.0;
  double miss_of_both = 0.0;  ///< infinity where either has no shell
  double thickness = 0.0;     ///< of the smaller body; infinity where it has none, as a plane
  double side = 0.0;          ///< the shortest of the smaller body's bounds
  double wall = 0.0;          ///< the thickness of the thinner body

  bool asks(PairBody body) const {
    return role == Role::kBoth || role == (body == PairBody::kA ? Role::kA : Role::kB);
  }
};

/// A body may miss so much of the smaller body's thickness as the only shell.
inline constexpr double kMissedByOne = 0.005;
/// And normals may turn by so much between its elements, radians.
inline constexpr double kTurnedByOne = 0.02;

/// The role of a pair: a constant of the two bodies, never of their pose, and the same in either
/// order. kAutomatic takes the shell that alone misses at most kMissedByOne of the smaller body's
/// thickness, between whose elements the other's normals turn by at most kTurnedByOne, and
/// which is too small to hide the other inside it, of two such the one with fewer points; and else
/// both. Of bodies of equal numbers, such as two of one model, a is the shell.
///
/// Error kInvalidArgument where a body that is chosen, or both of them, have no shell.
Result<PairRole> decide_role(const Participant& a, const Participant& b, ShellChoice choice);

/// How the contacts of a role relate to the meshes; metres.
struct PairBounds {
  /// Where one body is deeper in the other than this, there is a contact.
  double overlap = 0.0;
  /// Where the surfaces are farther apart than this, and neither body is inside the other, there is
  /// none.
  double clearance = 0.0;
};

/// What is known of the fields is proved (GridField::surface_error()). Of a uniform shell it is
/// proved that no surface is farther than sqrt(3) spacings from a point; then depth is that of the
/// shell's surface. How far the surface of a model by tolerance stands out above the shell's
/// elements was measured when it was built (Accuracy::coverage). Infinity where a body that is
/// asked has no shell.
PairBounds bound_pair(const Participant& a, const Participant& b, Role role);

/// What the elements of `shell` can miss of `field`, metres: how far its surface lies outside of
/// its elements, the error of the field, and what of the field's body may enter between elements.
double compute_miss(const Participant& shell, const Participant& field);

/// Where automatic or both roles found nothing: the contact of a place deep inside `body` that is
/// inside `field`, if it is: one body lies wholly inside the other, or in its very place. Its depth
/// is that of the place, and where the field has no direction there its normal is zero: there,
/// depth is ambiguous. The id is that after the last of the shell's elements. Ignores bodies
/// without an inner point, and margins above 0.
std::optional<Contact> find_inner_contact(const Participant& body, const Field& field,
                                          const Pose& field_from_body, float margin);

/// Where kFewest found no contact of `outer`'s points: whether the roles are to be swapped,
/// because `inner` may lie wholly inside `outer`, as a point of its shell does. One evaluation of a
/// field; false where either body has no shell.
bool is_enclosed(const Participant& inner, const Participant& outer, const Pose& outer_from_inner);

}  // namespace voxshell
