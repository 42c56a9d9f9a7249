#include "round_side.h"

#include <cmath>
#include <type_traits>
#include <variant>

#include "contact_constants.h"

namespace voxshell::bullet {
namespace {

template <class F>
constexpr bool kIsRound = std::is_same_v<F, SphereField> || std::is_same_v<F, CapsuleField> ||
                          std::is_same_v<F, CylinderField> || std::is_same_v<F, ConeField>;

/// How far a vector leads away from the z axis.
double across(const Vec3& v) { return std::hypot(v.x, v.y); }

using Place = RoundSide::Place;

/// The place of the ball about a center.
Place on_ball(const Vec3& center, double radius, const Vec3& direction) {
  return {center + radius * direction, direction, {}};
}

/// Round the axis; none where the direction leads along it.
std::optional<Place> around(const Place& start, const Vec3& direction) {
  const double out = across(direction);
  if (out < kFlatRim) return std::nullopt;
  const Vec3 radial{direction.x / out, direction.y / out, 0.0};
  const auto turned = [&](const Vec3& v) { return across(v) * radial + Vec3{0.0, 0.0, v.z}; };
  return Place{turned(start.position), turned(start.normal), {}};
}

}  // namespace

std::optional<RoundSide> RoundSide::of(const Side& side) {
  if (const Model* const model = side.model()) {
    if (!model->smooth_surface().is_curved()) return std::nullopt;
    return RoundSide(model, model->field());
  }
  const Field* const field = side.participant().field;
  if (field == nullptr) return std::nullopt;
  const bool is_round =
      std::visit([](const auto& typed) { return kIsRound<std::decay_t<decltype(typed)>>; }, *field);
  return is_round ? std::optional(RoundSide(nullptr, *field)) : std::nullopt;
}

std::optional<Place> RoundSide::nearest(const Vec3& point, const Place* guess) const {
  if (model_ != nullptr) {
    const SmoothSurface& surface = model_->smooth_surface();
    const SmoothSurface::Place on =
        surface.nearest(point, guess != nullptr ? guess->on.triangle : 0);
    if (surface.is_flat(on.triangle)) return std::nullopt;
    return Place::of(surface, on);
  }
  return std::visit(
      [&](const auto& field) -> std::optional<Place> {
        using F = std::decay_t<decltype(field)>;
        const auto at = static_cast<Vec3f>(point);
        const Vec3 outwards = normalized(static_cast<Vec3>(field.gradient(at)));
        constexpr bool kHasCaps = std::is_same_v<F, CylinderField> || std::is_same_v<F, ConeField>;
        if (kHasCaps && across(outwards) < kFlatRim) return std::nullopt;
        return Place{point - static_cast<double>(field.distance(at)) * outwards, outwards, {}};
      },
      *field_);
}

std::optional<Place> RoundSide::nearest_from(const Place& start, const Vec3& point) const {
  if (model_ == nullptr) return nearest(point);
  const SmoothSurface& surface = model_->smooth_surface();
  const auto on = surface.nearest_from(start.on, point);
  if (!on || surface.is_flat(on->triangle)) return std::nullopt;
  return Place::of(surface, *on);
}

std::optional<Place> RoundSide::slide(const Place& start, const Vec3& direction,
                                      double least_curvature) const {
  if (model_ != nullptr) {
    const SmoothSurface& surface = model_->smooth_surface();
    const SmoothSurface::Slide slide = surface.slide(start.on, direction, least_curvature);
    if (!slide.is_at_rest || surface.is_flat(slide.place.triangle)) return std::nullopt;
    return Place::of(surface, slide.place);
  }
  return std::visit(
      [&](const auto& field) -> std::optional<Place> {
        using F = std::decay_t<decltype(field)>;
        if constexpr (std::is_same_v<F, SphereField>) {
          return on_ball({}, field.radius, direction);
        } else if constexpr (std::is_same_v<F, CapsuleField>) {
          const double half = 0.5 * field.length;
          const double end = std::copysign(half, start.position.z);
          if (std::abs(start.position.z) >= half && direction.z * end >= 0.0) {
            return on_ball({0.0, 0.0, end}, field.radius, direction);
          }
          return around(start, direction);
        } else {
          return around(start, direction);
        }
      },
      *field_);
}

std::optional<Vec3> find_facing(const Side& side, const Vec3& point, const Vec3& direction,
                                double least_curvature) {
  const auto round = RoundSide::of(side);
  if (!round) return std::nullopt;
  const auto start = round->nearest(point);
  if (!start) return std::nullopt;
  const auto reached = round->slide(*start, direction, least_curvature);
  // Along a cylinder's axis nothing faces it.
  if (!reached || dot(reached->normal, direction) < static_cast<double>(kDoubleCosine)) {
    return std::nullopt;
  }
  return reached->position;
}

std::optional<Vec3> find_lowest_of_rim(const Model& model, const Vec3& point, double within,
                                       const Vec3& direction, double least_curvature) {
  const SmoothSurface& surface = model.smooth_surface();
  if (!surface.is_curved()) return std::nullopt;
  SmoothSurface::Place start = surface.nearest(point);
  if (surface.is_flat(start.triangle)) {
    // On a flat face: the round one that ends beside it.
    start = surface.nearest(point - within * surface.normal(start));
    if (surface.is_flat(start.triangle)) return std::nullopt;
    start = surface.nearest_on(start.triangle, point);
  }
  const SmoothSurface::Slide slide = surface.slide(start, direction, least_curvature);
  if (!slide.is_at_rest || surface.is_flat(slide.place.triangle)) return std::nullopt;
  return surface.position(slide.place);
}

}  // namespace voxshell::bullet
