#include "voxshell/ambiguity.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>

namespace voxshell {
namespace {

/// Whether depth and normal lead to a place that is off the surface. They do beside ridges of
/// depths, where two faces are equally near: samples round these off, and gradients are means.
bool misses_surface(const GridField& field, const Vec3& on_surface, double depth) {
  constexpr double kTurned = 0.015;  // of the depth, by a normal that is off by 10 degrees
  constexpr double kVoxels = 0.25;
  const double off = std::abs(static_cast<double>(field.distance(static_cast<Vec3f>(on_surface))));
  return off > std::min(kTurned * depth, kVoxels * field.voxel_size()) + field.surface_error();
}

}  // namespace

bool is_ambiguous(const Contact& contact, const Field& field, const Pose& field_from_shell) {
  constexpr double kStep = 0.4;       // depths, straight in
  constexpr double kLost = 0.5;       // steps: where the middle is nearer than a quarter of one
  constexpr double kRounding = 1e-6;  // of the place's coordinates
  const auto depth = static_cast<double>(contact.depth);
  if (!(depth > 0.0)) return false;
  const Vec3 place = field_from_shell.transform_point(static_cast<Vec3>(contact.point));
  const Vec3 outwards = field_from_shell.rotate(static_cast<Vec3>(contact.normal));
  const double step = kStep * depth;
  const double least = depth - kLost * step - kRounding * length(place);
  return std::visit(
      [&](const auto& typed) {
        if constexpr (std::is_same_v<std::decay_t<decltype(typed)>, GridField>) {
          if (misses_surface(typed, place + depth * outwards, depth)) return true;
        }
        const auto further = static_cast<Vec3f>(place - step * outwards);
        return -static_cast<double>(typed.distance(further)) < least;
      },
      field);
}

}  // namespace voxshell
