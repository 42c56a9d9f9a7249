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
  /// A model's accuracy. Without it, the worst case of spacing and voxels counts.
  const Accuracy* accuracy = nullptr;
  /// Thickness of a model's thinnest walls, meters. 0: the shortest side of its bounds counts.
  double thickness = 0.0;
  /// A model's place deep inside.
  const Vec3f* inner_point = nullptr;
};

enum class PairBody { kA, kB };

inline PairBody other(PairBody body) { return body == PairBody::kA ? PairBody::kB : PairBody::kA; }

/// The body whose elements are tested against the other body's field.
enum class Role { kA, kB, kBoth };

enum class ShellChoice {
  /// By accuracy (decision 0026): see decide_role().
  kAutomatic,
  /// The body with fewer points (thesis, section 5.3), a if the numbers are equal. The other body
  /// if these points are farther apart than its own and than its shortest side, so that it could
  /// slip between them; or, for a single pose, if the other body encloses it: see is_enclosed().
  kFewest,
  kA,
  kB,
  kBoth,
};

/// The role of a pair, and what queries can then miss. Meters. Measured, not proved: queries find
/// contacts deeper than `miss`.
struct PairRole {
  Role role = Role::kA;
  /// The tested shell. If both are tested, the shell that meets the more accurate normals: those of
  /// a smooth body turn least between its elements.
  PairBody first = PairBody::kA;
  double miss = 0.0;       ///< with this role
  double miss_of_a = 0.0;  ///< with the elements of a alone; infinity if a has no shell
  double miss_of_b = 0.0;
  double miss_of_both = 0.0;  ///< infinity if either has no shell
  double thickness = 0.0;     ///< of the smaller body; infinity if it has none, as a plane
  double side = 0.0;          ///< the shortest of the smaller body's bounds
  double wall = 0.0;          ///< the thickness of the thinner body

  bool asks(PairBody body) const {
    return role == Role::kBoth || role == (body == PairBody::kA ? Role::kA : Role::kB);
  }
};

/// A body that is the only shell may miss at most this fraction of the smaller body's thickness.
inline constexpr double kMissedByOne = 0.005;
/// And the other body's normals may turn by at most this between its elements, radians.
inline constexpr double kTurnedByOne = 0.02;

/// The role of a pair. It depends on the two bodies, never on their poses or their order.
/// kAutomatic takes a shell alone if it misses at most kMissedByOne of the smaller body's
/// thickness, if the other body's normals turn by at most kTurnedByOne between its elements, and if
/// it is too small to hide the other body inside it. Of two such shells it takes the one with fewer
/// points, a if the numbers are equal. Otherwise it takes both.
///
/// Error kInvalidArgument if a body that is chosen, or both of them, have no shell.
Result<PairRole> decide_role(const Participant& a, const Participant& b, ShellChoice choice);

/// Relation between the contacts of a role and the meshes; meters.
struct PairBounds {
  /// If one body is deeper in the other than this, there is a contact.
  double overlap = 0.0;
  /// If the surfaces are farther apart than this, and neither body is inside the other, there is no
  /// contact.
  double clearance = 0.0;
};

/// The contribution of the fields is proven (GridField::surface_error()). For a uniform shell it is
/// proven that no surface is farther than sqrt(3) spacings from a point; depth is then that of the
/// shell's surface. For a model by tolerance, the build measured how far the surface rises above
/// the shell's elements (Accuracy::coverage). Infinity if a tested body has no shell.
PairBounds bound_pair(const Participant& a, const Participant& b, Role role);

/// Depth that the elements of `shell` can miss in `field`, meters: how far its surface lies outside
/// of its elements, the error of the field, and what of the field's body may enter between
/// elements.
double compute_miss(const Participant& shell, const Participant& field);

/// For automatic or both roles that found nothing: the contact of a place deep inside `body`, if
/// that place is inside `field`. One body then lies entirely inside the other, or at its place. The
/// depth is that of the place. The normal is zero if the field has no direction there; depth is
/// then ambiguous. The id follows that of the shell's last element. Ignores bodies without an inner
/// point, and margins above 0.
std::optional<Contact> find_inner_contact(const Participant& body, const Field& field,
                                          const Pose& field_from_body, float margin);

/// For kFewest, if no point of `outer` is a contact: whether the roles must swap because `inner`
/// may lie entirely inside `outer`, as a point of its shell does. Costs one evaluation of a field.
/// False if either body has no shell.
bool is_enclosed(const Participant& inner, const Participant& outer, const Pose& outer_from_inner);

}  // namespace voxshell
