#include "round_contacts.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "contact_constants.h"
#include "contact_list.h"

namespace voxshell::bullet {

double most_above_samples(const Model& model) {
  const SmoothSurface& surface = model.smooth_surface();
  if (!surface.is_curved()) return 0.0;
  return static_cast<double>(surface.most_lift()) + model.accuracy().coverage.p99;
}

void RoundContacts::slide(std::vector<Contact>& contacts, const Model& model, const Field& field,
                          const Pose& field_from_shell, const TouchScale& scale,
                          const Turning& turning, float least_depth) {
  at_rest_.begin(/*forgets=*/surface_ != &model.smooth_surface());
  surface_ = &model.smooth_surface();
  if (!surface_->is_curved()) return;
  least_curvature_ = kFlatBend / scale.radius;
  spacing_ = model.shell().spacing();
  margin_ = scale.margin;
  same_within_ = kSameOfRadius * scale.radius;
  followed_within_ = kFollowedOfRadius * scale.radius;
  const Pose shell_from_field = field_from_shell.inverse();
  const auto between = static_cast<float>(model.accuracy().coverage.p99);
  const auto is_too_far = [&](const Contact& contact) {
    const float lift = surface_->lift(surface_->triangle_of(contact.id));
    return contact.depth + lift + between < least_depth;
  };
  std::visit(
      [&](const auto& typed) {
        std::erase_if(contacts, [&](Contact& contact) {
          return is_too_far(contact) ||
                 !slide_one(contact, typed, field_from_shell, shell_from_field, scale, turning);
        });
      },
      field);
  at_rest_.keep_ids(contacts, followed_within_);
}

/// Whether the contact is one that no other is yet.
template <class F>
bool RoundContacts::slide_one(Contact& contact, const F& field, const Pose& field_from_shell,
                              const Pose& shell_from_field, const TouchScale& scale,
                              const Turning& turning) {
  const std::uint32_t triangle = surface_->triangle_of(contact.id);
  if (surface_->is_flat(triangle)) return true;
  Vec3 direction = -static_cast<Vec3>(contact.normal);
  if (surface_->lies_flat(contact.id, direction, -static_cast<double>(kAlignedCosine))) return true;
  const SmoothSurface::Place start =
      surface_->nearest_on(triangle, static_cast<Vec3>(contact.point));
  const Vec3 wanted = direction - surface_->normal(start);
  Vec3 missed_before;
  double relaxation = 1.0;
  SmoothSurface::Place place = start;
  for (int i = 0; i < kMostSlides; ++i) {
    const SmoothSurface::Slide slide = surface_->slide(place, direction, least_curvature_);
    if (!slide.is_at_rest) return true;
    place = slide.place;
    const Vec3 position = surface_->position(place);
    const auto in_field = static_cast<Vec3f>(field_from_shell.transform_point(position));
    const Vec3 outwards =
        shell_from_field.rotate(normalized(static_cast<Vec3>(field.gradient(in_field))));
    // Coarse fields have places without a gradient: there is nowhere to slide to.
    if (outwards == Vec3{}) return true;
    const Vec3 missed = -outwards - direction;
    // Nor where the relaxation has no value: it has made no difference.
    if (!(squared_length(missed) <= kSlideWithin * kSlideWithin)) {
      // A peg in its hole: the field's surface has turned as far, and there is no one deepest
      // place.
      if (i == 0 && dot(missed, wanted) > kFollowsOfTurn * squared_length(wanted)) return true;
      // Aitken's relaxation: the field's surface is curved, too.
      if (i > 0) {
        const Vec3 change = missed - missed_before;
        relaxation *= -dot(missed_before, change) / squared_length(change);
      }
      missed_before = missed;
      direction = normalized(direction + relaxation * missed);
      continue;
    }
    const auto depth = -static_cast<double>(field.distance(in_field));
    if (depth < static_cast<double>(contact.depth) - kSlideLosesOfMargin * scale.margin)
      return true;
    if (const auto* const known = at_rest_.find(position, same_within_)) {
      const double gap = std::max(-static_cast<double>(known->depth), 0.0);
      const double lead = turning.lead_over(surface_->position(start), surface_->normal(start),
                                            known->position, gap, -outwards);
      return lead > scale.margin;
    }
    at_rest_.add(contact.id, static_cast<float>(depth), position, place);
    contact.point = static_cast<Vec3f>(position);
    contact.normal = static_cast<Vec3f>(outwards);
    contact.depth = static_cast<float>(depth);
    return true;
  }
  return true;
}

void RoundContacts::drop_covered(std::vector<Contact>& others, const PointShell& shell_of_others,
                                 std::span<const std::uint32_t> exact, std::span<const Contact> own,
                                 const Pose& other_from_shell) const {
  if (at_rest_.empty()) return;
  const Pose shell_from_other = other_from_shell.inverse();
  const auto is_covered = [&](const Contact& contact) {
    const Vec3 point = shell_from_other.transform_point(static_cast<Vec3>(contact.point));
    if (std::ranges::binary_search(exact, contact.id)) {
      // Where bodies touch along a line, contacts are as far apart as samples are. Edges end it.
      const bool is_point = shell_of_others.is_point(contact.id);
      const auto* const same =
          at_rest_.find(point, is_point ? same_within_ + spacing_ : same_within_);
      // Of two that are one, one stays.
      return same != nullptr && has_id(own, same->id);
    }
    const auto& nearest = at_rest_.nearest(point);
    Vec3 direction = surface_->normal(nearest.of);
    if (shell_of_others.is_point(contact.id)) {
      direction =
          -shell_from_other.rotate(static_cast<Vec3>(shell_of_others.normal_of(contact.id)));
    } else if (dot(point - nearest.position, direction) < -margin_) {
      // An edge that stands up from the ground.
      return false;
    }
    const SmoothSurface::Place start = surface_->nearest_from(nearest.of, point);
    // Flat faces may lie on each other.
    if (surface_->is_flat(start.triangle)) return false;
    // Another part of the body may be nearer.
    const double apart = length(surface_->position(start) - point);
    if (apart > same_within_ + kNearestWithin * std::abs(static_cast<double>(contact.depth))) {
      return false;
    }
    const SmoothSurface::Slide slide = surface_->slide(start, direction, least_curvature_);
    const Vec3 deepest = surface_->position(slide.place);
    // Where bodies touch along a line, contacts are as far apart as samples are.
    const bool slid =
        squared_length(deepest - surface_->position(start)) > same_within_ * same_within_;
    const double within = slid ? same_within_ + spacing_ : same_within_;
    return slide.is_at_rest && at_rest_.find(deepest, within) != nullptr;
  };
  std::erase_if(others, is_covered);
}

}  // namespace voxshell::bullet
