#include "round_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact_constants.h"
#include "contact_list.h"
#include "find_zero.h"

namespace voxshell::bullet {

double most_above_samples(const Model& model) {
  const SmoothSurface& surface = model.smooth_surface();
  if (!surface.is_curved()) return 0.0;
  return static_cast<double>(surface.most_lift()) + model.accuracy().coverage.p99;
}

void RoundContacts::slide(std::vector<Contact>& contacts, const Model& model, SmoothField field,
                          const Pose& field_from_shell, const TouchScale& scale,
                          const Turning& turning, float least_depth) {
  const bool forgets = surface_ != &model.smooth_surface();
  at_rest_.begin(forgets);
  failed_.begin(contacts, field_from_shell, scale.radius, forgets);
  surface_ = &model.smooth_surface();
  if (!surface_->is_curved()) return;
  least_curvature_ = kFlatBend / scale.radius;
  spacing_ = model.shell().spacing();
  margin_ = scale.margin;
  same_within_ = kSameOfRadius * scale.radius;
  followed_within_ = kFollowedOfRadius * scale.radius;
  field_ = field;
  field_from_shell_ = field_from_shell;
  shell_from_field_ = field_from_shell.inverse();
  const auto between = static_cast<float>(model.accuracy().coverage.p99);
  const auto is_too_far = [&](const Contact& contact) {
    const float lift = surface_->lift(surface_->triangle_of(contact.id));
    return contact.depth + lift + between < least_depth;
  };
  std::erase_if(contacts, [&](Contact& contact) {
    return is_too_far(contact) || !slide_one(contact, scale, turning);
  });
  at_rest_.keep_ids(contacts, followed_within_);
}

/// Whether the contact is one that no other is yet.
bool RoundContacts::slide_one(Contact& contact, const TouchScale& scale, const Turning& turning) {
  const std::uint32_t triangle = surface_->triangle_of(contact.id);
  if (surface_->is_flat(triangle)) return true;
  Vec3 direction = -static_cast<Vec3>(contact.normal);
  if (surface_->lies_flat(contact.id, direction, -static_cast<double>(kAlignedCosine))) return true;
  const auto point = static_cast<Vec3>(contact.point);
  const SmoothSurface::Place start = surface_->nearest_on(triangle, point);
  if (field_.is_smooth()) {
    const Facing there = feel(point);
    contact.depth = static_cast<float>(-there.distance);
    contact.normal = static_cast<Vec3f>(there.outwards);
    direction = -there.outwards;
  }
  if (!at_rest_.empty()) {
    const auto& nearest = at_rest_.nearest(point);
    if (is_below(contact, nearest.of) && slides_to(start, nearest.of)) {
      return leads(start, nearest, scale, turning);
    }
  }
  if (failed_.fails_again(contact.id)) return true;
  const auto touch = find_touch(start, direction, field_.faces_within());
  if (!touch) {
    failed_.add(contact.id);
    return true;
  }
  const Facing& facing = touch->facing;
  const double depth = -facing.distance;
  if (depth < static_cast<double>(contact.depth) - kSlideLosesOfMargin * margin_) return true;
  if (const auto* const known = at_rest_.find(facing.position, same_within_)) {
    return leads(start, *known, scale, turning);
  }
  at_rest_.add(contact.id, static_cast<float>(depth), facing.position, *touch);
  contact.point = static_cast<Vec3f>(facing.position);
  contact.normal = static_cast<Vec3f>(facing.outwards);
  contact.depth = static_cast<float>(depth);
  return true;
}

void RoundContacts::follow(std::span<const Contact> kept, std::uint32_t first_id, SmoothField field,
                           const Pose& field_from_shell, std::vector<Contact>& moved) {
  if (at_rest_.empty()) return;
  field.start_near(field_);
  field_ = field;
  field_from_shell_ = field_from_shell;
  shell_from_field_ = field_from_shell.inverse();
  using AtRest = PlacesAtRest<Touch>::AtRest;
  at_rest_.follow([&](const AtRest& then) -> std::optional<AtRest> {
    if (!has_id(kept, first_id + then.id)) return std::nullopt;
    const Vec3 direction = -feel(then.position).outwards;
    auto touch = find_touch(then.of.place, direction, kFollowedWithin);
    if (!touch) touch = find_touch(then.of.place, direction, field_.faces_within());
    if (!touch) return std::nullopt;
    const Facing& facing = touch->facing;
    const auto depth = static_cast<float>(-facing.distance);
    moved.push_back(
        {then.id, depth, static_cast<Vec3f>(facing.position), static_cast<Vec3f>(facing.outwards)});
    return AtRest{then.id, then.was_there, depth, facing.position, *touch};
  });
}

/// Whether a place may touch, once the body has turned, before what is known does.
bool RoundContacts::leads(const SmoothSurface::Place& start,
                          const PlacesAtRest<Touch>::AtRest& known, const TouchScale& scale,
                          const Turning& turning) const {
  const double gap = std::max(-static_cast<double>(known.depth), 0.0);
  const auto [position, normal] = surface_->tangent_plane(start);
  return turning.lead_over(position, normal, known.position, gap, -known.of.facing.outwards) >
         std::max(scale.margin, kLeadOfRadius * scale.radius);
}

void RoundContacts::drop_guards(std::vector<Contact>& guards, const TouchScale& scale,
                                const Turning& turning) {
  if (at_rest_.empty()) return;
  std::erase_if(guards, [&](const Contact& guard) {
    const std::uint32_t triangle = surface_->triangle_of(guard.id);
    if (surface_->is_flat(triangle)) return false;
    const auto point = static_cast<Vec3>(guard.point);
    const auto& nearest = at_rest_.nearest(point);
    const SmoothSurface::Place start = surface_->nearest_on(triangle, point);
    return is_below(guard, nearest.of) && slides_to(start, nearest.of) &&
           !leads(start, nearest, scale, turning);
  });
}

/// Whether the field's surface, at a sample, does not rise over its tangent plane where it is
/// touched, as another wall does.
bool RoundContacts::is_below(const Contact& contact, const Touch& touch) const {
  const Vec3 aside = static_cast<Vec3>(contact.point) - touch.facing.position;
  const double of_plane = touch.facing.distance + dot(touch.facing.outwards, aside);
  // The other side of a wall faces away.
  if (!(dot(static_cast<Vec3>(contact.normal), touch.facing.outwards) > 0.0)) return false;
  return -static_cast<double>(contact.depth) >= of_plane - kSlideLosesOfMargin * margin_;
}

/// Whether the surface leads from a place, against the field's normal at a touch, to that, or to a
/// straight line through it that the field's surface bends away from.
bool RoundContacts::slides_to(const SmoothSurface::Place& start, const Touch& touch) {
  const SmoothSurface::Slide slide =
      surface_->slide(start, -touch.facing.outwards, least_curvature_);
  if (!slide.is_at_rest) return false;
  const Vec3 position = surface_->position(slide.place);
  const Vec3 aside = position - touch.facing.position;
  if (squared_length(aside) <= same_within_ * same_within_) return true;
  const Vec3 turned = surface_->normal(slide.place) - surface_->normal(touch.place);
  if (squared_length(turned) > kStraightLean * kStraightLean) return false;
  const Vec3 bends = feel(position).outwards - touch.facing.outwards;
  return dot(bends, aside) > least_curvature_ * squared_length(aside);
}

/// By way of the surface from a place on. `direction` is against the field's normal there, and
/// normals may miss each other by `within` radians.
std::optional<RoundContacts::Touch> RoundContacts::find_touch(const SmoothSurface::Place& start,
                                                              Vec3 direction, double within) {
  SmoothSurface::Place place = start;
  Vec3 wanted = direction - surface_->normal(start);
  const auto slide = [&](const Vec3& along) -> std::optional<Vec3> {
    const SmoothSurface::Slide slid = surface_->slide(place, along, least_curvature_);
    if (!slid.is_at_rest) return std::nullopt;
    place = slid.place;
    return surface_->position(place);
  };
  const double follows = field_.is_smooth() ? kFollowsOfSmoothTurn : kFollowsOfTurn;
  for (int i = 0; i < kMostStraight; ++i) {
    const auto facing = face_field(direction, wanted, follows, within, slide,
                                   [&](const Vec3& position) { return feel(position); });
    if (!facing) return std::nullopt;
    const auto straight_on = go_straight(place, *facing);
    if (!straight_on) return Touch{*facing, place};
    place = straight_on->place;
    const Facing there = feel(surface_->position(place));
    if (straight_on->is_over_edge && straight_on->displacement <= same_within_) {
      return Touch{{there.position, -surface_->normal(place), there.distance}, place};
    }
    direction = -there.outwards;
    wanted = {};
  }
  return std::nullopt;
}

/// Where the field's surface is curved or ends and this one is straight, as a bar under a ball or a
/// pole in a collar that leans, to the place under it or under its edge. None where the two face
/// each other already.
std::optional<RoundContacts::Straight> RoundContacts::go_straight(const SmoothSurface::Place& place,
                                                                  const Facing& facing) {
  const Vec3 normal = surface_->normal(place);
  const Vec3 lean = -facing.outwards - normal;
  if (squared_length(lean) <= kStraightLean * kStraightLean || surface_->is_at_crease(place)) {
    return std::nullopt;
  }
  const Vec3 along = normalized(lean - dot(lean, normal) * normal);
  double nearer = 0.0;
  double farther = std::numeric_limits<double>::infinity();
  const auto zero = find_zero(
      [&](double way) -> std::optional<double> {
        const double leans = dot(feel(facing.position + way * along).outwards, along);
        (leans < 0.0 ? nearer : farther) = way;
        return leans;
      },
      same_within_, least_curvature_, kSlideWithin);
  const double displacement = zero.value_or(nearer);
  const bool is_over_edge = !zero;
  if (is_over_edge && (!(farther - nearer <= kEdgeWithin * same_within_) ||
                       displacement > kEdgeOfSpacing * spacing_)) {
    return std::nullopt;
  }
  const Vec3 wanted = facing.position + displacement * along;
  const SmoothSurface::Place reached = surface_->below(place, wanted);
  // Beyond its end, it is not under the field's surface.
  const double off = squared_length(surface_->position(reached) - wanted);
  if (off > same_within_ * same_within_) return std::nullopt;
  // A round surface may lean, too, where patches of it meet.
  const double turned = squared_length(surface_->normal(reached) - normal);
  if (turned > kStraightTurn * kStraightTurn * squared_length(lean)) return std::nullopt;
  return Straight{reached, displacement, is_over_edge};
}

Facing RoundContacts::feel(const Vec3& position) {
  const SmoothField::Value there = field_.at(field_from_shell_.transform_point(position));
  return {position, shell_from_field_.rotate(there.outwards), there.distance};
}

void RoundContacts::drop_covered(std::vector<Contact>& others, const PointShell& shell_of_others,
                                 std::span<const std::uint32_t> exact, std::span<const Contact> own,
                                 const Pose& other_from_shell, bool are_guards) {
  if (at_rest_.empty()) return;
  const Pose shell_from_other = other_from_shell.inverse();
  const auto is_covered = [&](const Contact& contact) {
    const Vec3 point = shell_from_other.transform_point(static_cast<Vec3>(contact.point));
    if (std::ranges::binary_search(exact, contact.id)) {
      // Where bodies touch along a line, contacts are as far apart as samples are. Edges end it.
      const bool is_point = shell_of_others.is_point(contact.id);
      const auto* const same =
          at_rest_.find(point, is_point ? same_within_ + spacing_ : same_within_);
      // Of two that are one, one stays. A wall and the floor beside it are not one.
      const Vec3 outwards = shell_from_other.rotate(static_cast<Vec3>(contact.normal));
      return same != nullptr && has_id(own, same->id) &&
             -dot(outwards, same->of.facing.outwards) >= static_cast<double>(kDoubleCosine);
    }
    const auto& nearest = at_rest_.nearest(point);
    const SmoothSurface::Place start = surface_->below(nearest.of.place, point);
    // Flat faces may lie on each other.
    if (surface_->is_flat(start.triangle)) return false;
    const Vec3 place = surface_->position(start);
    // Another part of the body may be nearer.
    const double apart = length(place - point);
    if (apart > same_within_ + kNearestWithin * std::abs(static_cast<double>(contact.depth))) {
      return false;
    }
    // Where bodies touch along a line, contacts are as far apart as samples are.
    const auto leads_to_rest = [&](const Vec3& deepest) {
      const bool slid = squared_length(deepest - place) > same_within_ * same_within_;
      return at_rest_.find(deepest, slid ? same_within_ + spacing_ : same_within_) != nullptr;
    };
    Vec3 direction = surface_->normal(nearest.of.place);
    bool stands_up = false;
    if (shell_of_others.is_point(contact.id)) {
      direction =
          -shell_from_other.rotate(static_cast<Vec3>(shell_of_others.normal_of(contact.id)));
    } else {
      // An edge that stands up from the ground.
      stands_up = dot(point - nearest.position, direction) < -margin_;
    }
    if (!stands_up) {
      const SmoothSurface::Slide slide = surface_->slide(start, direction, least_curvature_);
      if (slide.is_at_rest && leads_to_rest(surface_->position(slide.place))) return true;
    }
    if (are_guards || !field_.is_smooth()) return false;
    // In a bowl, what is deepest as a sample sees it is not as the next one does. On an edge,
    // normals are those of either face.
    const Vec3 beside = place + same_within_ * normalized(nearest.position - place);
    const auto touch =
        find_touch(surface_->below(start, beside), -feel(beside).outwards, field_.faces_within());
    return touch && leads_to_rest(touch->facing.position);
  };
  std::erase_if(others, is_covered);
}

}  // namespace voxshell::bullet
