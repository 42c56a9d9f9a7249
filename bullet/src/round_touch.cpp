#include "round_touch.h"

#include <algorithm>
#include <variant>

#include "contact_constants.h"
#include "flatness.h"
#include "round_side.h"
#include "second_shell.h"
#include "shape_features.h"

namespace voxshell::bullet {
namespace {

/// An element of one of the two shells.
struct OwnedElement {
  const Side& side;
  std::uint32_t id;
  bool is_of_shell;
};

OwnedElement element_at(const PairStep& step, const Contact& contact) {
  const PosedPair& pair = *step.pair;
  if (contact.id < kFirstOfSecond) return {pair.shell_side(), contact.id, true};
  return {pair.field_side(), contact.id - kFirstOfSecond, false};
}

/// Where a contact is on the shell's body, or on the field's. Shell's frame.
Vec3 place_on(bool shell, const Contact& contact) {
  return shell ? static_cast<Vec3>(contact.point) : place_of_second(contact);
}

}  // namespace

bool is_shell_larger(const PairStep& step) {
  return !step.pair->has_triangles() && step.larger == &step.pair->shell_side();
}

void put_on_field(const PairStep& step, const Vec3& on_field, Contact& contact) {
  const Vec3 now = step.field_from_shell.inverse().transform_point(on_field);
  contact.point = static_cast<Vec3f>(now) - contact.depth * contact.normal;
}

bool lies_on_curve(const Model& model, std::uint32_t element) {
  const SmoothSurface& surface = model.smooth_surface();
  return surface.is_curved() && model.shell().is_point(element) &&
         !surface.is_flat(surface.triangle_of(element));
}

bool is_facing(const PairStep& step, const Contact& contact) {
  if (contact.id >= kFirstFeature) return false;
  const auto [side, id, is_of_shell] = element_at(step, contact);
  if (!lies_on_curve(*side.model(), id)) return false;
  const SmoothSurface& surface = side.model()->smooth_surface();
  const Pose own_from_shell = is_of_shell ? Pose{} : step.field_from_shell;
  const Vec3 place = own_from_shell.transform_point(place_on(is_of_shell, contact));
  // What has slid is no longer where its sample is.
  const Vec3 normal = surface.normal(surface.nearest(place, surface.triangle_of(id)));
  const Vec3 facing = own_from_shell.rotate(static_cast<Vec3>(contact.normal));
  return (is_of_shell ? -1.0 : 1.0) * dot(normal, facing) >= static_cast<double>(kDoubleCosine);
}

RoundTouch::RoundTouch(const PairStep& step, const RelativeMotion& motion, double fraction,
                       double gap)
    : step_(step),
      motion_(motion),
      fraction_(fraction),
      gap_(gap),
      is_shell_(!is_shell_larger(step)),
      side_(is_shell_ ? step.pair->shell_side() : step.pair->field_side()),
      own_from_shell_(is_shell_ ? Pose{} : step.field_from_shell),
      shell_from_own_(own_from_shell_.inverse()),
      of_side_(is_shell_ ? motion : motion.reversed()),
      rim_within_(std::min(kRimOfRadius * step.ball.radius, kRimOfThickness * side_.thinnest())) {}

/// The place that faces a direction now, by way of the surface from the last one.
std::optional<Vec3> RoundTouch::face(const Vec3& direction) const {
  const Vec3 place = own_from_shell_.transform_point(place_);
  const Vec3 along = own_from_shell_.rotate(direction);
  const double least_curvature = kFlatBend / step_.ball.radius;
  const auto found =
      is_rim_ ? find_lowest_of_rim(*side_.model(), place, rim_within_, along, least_curvature)
              : find_facing(side_, place, along, least_curvature);
  if (!found) return std::nullopt;
  return shell_from_own_.transform_point(*found);
}

/// Where a place of the surface is when they touch, as the other body sees it.
Vec3 RoundTouch::after(const Vec3& place) const {
  return Path(of_side_, place, step_.time_step).at(fraction_);
}

/// What `ask` returns of the other body's field and its pose in the shell's frame, inverted.
template <class F>
auto RoundTouch::ask_other(const F& ask) const {
  if (!is_shell_) return ask(step_.pair->shell_side().model()->grid(), Pose{});
  return std::visit([&](const auto& field) { return ask(field, step_.field_from_shell); },
                    step_.pair->field());
}

/// Whether the other body's surface has an edge beside a place of it.
bool RoundTouch::ends_beside(const Vec3& place, const Vec3& normal) const {
  return ask_other([&](const auto& field, const Pose& field_from_shell) {
    return bend_of(field, field_from_shell.transform_point(place), field_from_shell.rotate(normal),
                   kFlatScales[0] * step_.ball.radius) > kEdgeBend;
  });
}

/// Finds how much deeper than the place that was followed the surface is. `own` is what that place
/// faces when they touch.
bool RoundTouch::meet_face(const Path& path, const Vec3& own) {
  if (dot(own, outwards_) < kFacesPlane) return false;
  const auto facing = face(path.turned_back(fraction_, -outwards_));
  if (!facing) return false;
  gap_ += dot(after(*facing) - path.at(fraction_), outwards_);
  return true;
}

/// The same where the body touches with a rim: its lowest place, by way of the rim.
bool RoundTouch::meet_face_with_rim(const Path& path) {
  is_rim_ = true;
  const auto lowest = face(path.turned_back(fraction_, -outwards_));
  if (!lowest) return false;
  gap_ += dot(after(*lowest) - path.at(fraction_), outwards_);
  return true;
}

/// Finds the place that faces an edge when they touch, from its center of curvature: beside an edge
/// a field has all normals.
bool RoundTouch::meet_edge(const Path& path, const Vec3& own) {
  struct Felt {
    double distance;
    Vec3 outwards;
  };
  const auto feel = [&](const Vec3& place) {
    return ask_other([&](const auto& field, const Pose& field_from_shell) {
      const auto there = static_cast<Vec3f>(field_from_shell.transform_point(place));
      const Vec3 outwards = normalized(static_cast<Vec3>(field.gradient(there)));
      return Felt{static_cast<double>(field.distance(there)) - step_.thickness,
                  field_from_shell.inverse().rotate(outwards)};
    });
  };
  outwards_ = own;
  for (int i = 0; i < kMostFacing; ++i) {
    const auto facing = face(path.turned_back(fraction_, -outwards_));
    if (!facing) return false;
    place_ = *facing;
    const Vec3 then = after(place_);
    const Felt on_surface = feel(then);
    gap_ = on_surface.distance;
    if (on_surface.outwards == Vec3{}) return false;
    const double cosine = dot(on_surface.outwards, outwards_);
    if (cosine >= -static_cast<double>(kAlignedCosine)) break;
    const Vec3 aside = normalized(on_surface.outwards - cosine * outwards_);
    const Vec3 tilted = normalized(outwards_ + kTilt * aside);
    const auto beside = face(path.turned_back(fraction_, -tilted));
    if (!beside) return false;
    const double radius = std::min(length(*beside - place_) / kTilt, 2.0 * step_.ball.radius);
    const Felt at_center = feel(then + radius * outwards_);
    gap_ = at_center.distance - radius;
    outwards_ = at_center.outwards;
  }
  return gap_ <= kColumnGaps * step_.touching_gap() && dot(outwards_, own) >= kFacesEdge;
}

/// Finds how the body touches what a place of an element of it has come to. Whether it is with a
/// place of the round surface, or with its rim.
bool RoundTouch::meet(const Path& path, const Model& model, std::uint32_t id) {
  const PointShell& shell = model.shell();
  const bool is_on_edge = ends_beside(path.at(fraction_) - gap_ * outwards_, outwards_);
  if (!shell.is_point(id)) return !is_on_edge && meet_face_with_rim(path);
  const Vec3 normal = shell_from_own_.rotate(static_cast<Vec3>(shell.normals()[id]));
  const Vec3 own = -path.turned_at(fraction_, normal);
  if (!lies_on_curve(model, id)) {
    return !is_on_edge && dot(own, outwards_) < kFacesPlane && meet_face_with_rim(path);
  }
  if (!is_on_edge) return meet_face(path, own);
  return step_.restitution == 0.0 && meet_edge(path, own);
}

void RoundTouch::move(const Path& path, Contact& contact) {
  const double turn = fraction_ * step_.time_step * length(motion_.angular_velocity);
  if (turn * step_.ball.radius <= step_.touching_gap()) return;
  const double sign = is_shell_ ? 1.0 : -1.0;
  place_ = place_on(is_shell_, contact);
  outwards_ = sign * static_cast<Vec3>(contact.normal);
  const OwnedElement element = element_at(step_, contact);
  if (element.is_of_shell == is_shell_ && !meet(path, *element.side.model(), element.id)) return;
  const auto now = face(-outwards_);
  if (!now) return;
  const Vec3 normal = sign * outwards_;
  const Vec3 velocity = motion_.velocity_at(*now) + motion_.velocity_of_fall;
  const double closing = std::max(-dot(velocity, normal) * step_.time_step, 0.0);
  contact.normal = static_cast<Vec3f>(normal);
  contact.depth = static_cast<float>(-std::max(fraction_ * closing + gap_, 0.0) - step_.thickness);
  contact.point = static_cast<Vec3f>(*now);
  if (!is_shell_) put_on_field(step_, own_from_shell_.transform_point(*now), contact);
}

}  // namespace voxshell::bullet
