#include "voxshell/pair.h"

#include <algorithm>
#include <variant>

namespace voxshell {
namespace {

/// Whether a model could lie between the points of a coarser shell, unseen.
bool fits_between(const Participant& body, const PointShell& shell) {
  const auto* grid = std::get_if<GridField>(body.field);
  if (grid == nullptr || body.shell->spacing() >= shell.spacing()) return false;
  const Vec3 sides = grid->surface_bounds().extents();
  return shell.spacing() > std::min({sides.x, sides.y, sides.z});
}

}  // namespace

Result<PairBody> choose_shell(const Participant& a, const Participant& b, ShellChoice choice) {
  const auto refuse = [](const char* message) {
    return Error{ErrorCode::kInvalidArgument, message};
  };
  switch (choice) {
    case ShellChoice::kA:
      if (a.shell == nullptr) return refuse("body a has no point shell: it is an analytic shape");
      return PairBody::kA;
    case ShellChoice::kB:
      if (b.shell == nullptr) return refuse("body b has no point shell: it is an analytic shape");
      return PairBody::kB;
    case ShellChoice::kAutomatic:
      break;
  }
  if (a.shell == nullptr && b.shell == nullptr) {
    return refuse("neither body has a point shell: one of the two must be a model");
  }
  if (a.shell == nullptr) return PairBody::kB;
  if (b.shell == nullptr) return PairBody::kA;
  if (b.shell->size() < a.shell->size()) {
    return fits_between(a, *b.shell) ? PairBody::kA : PairBody::kB;
  }
  return fits_between(b, *a.shell) ? PairBody::kB : PairBody::kA;
}

bool is_enclosed(const Participant& inner, const Participant& outer, const Pose& outer_from_inner) {
  if (inner.shell == nullptr || outer.shell == nullptr) return false;
  const auto point = static_cast<Vec3>(inner.shell->points()[0]);
  const auto place = static_cast<Vec3f>(outer_from_inner.transform_point(point));
  return std::visit([&](const auto& typed) { return typed.distance(place) < 0.0f; }, *outer.field);
}

}  // namespace voxshell
