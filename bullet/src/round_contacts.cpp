#include "round_contacts.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
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
  at_rest_.swap(before_);
  std::ranges::sort(before_, {}, &AtRest::id);
  at_rest_.clear();
  by_x_.clear();
  if (surface_ != &model.smooth_surface()) before_.clear();
  surface_ = &model.smooth_surface();
  if (!surface_->is_curved()) return;
  least_curvature_ = kFlatBend / scale.radius;
  spacing_ = model.shell().spacing();
  margin_ = scale.margin;
  same_within_ = kSameOfRadius * scale.radius;
  as_deep_within_ = static_cast<float>(kAsDeepOfMargin * scale.margin);
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
  keep_ids(contacts);
}

/// Gives contacts the ids of those near them in the step before: a ball that rolls touches with one
/// contact, not with one after the other.
void RoundContacts::keep_ids(std::vector<Contact>& contacts) {
  // Most have kept theirs.
  std::size_t lost = 0;
  auto now = at_rest_.begin();
  for (const AtRest& then : before_) {
    while (now != at_rest_.end() && now->id < then.id) ++now;
    if (now != at_rest_.end() && now->id == then.id) {
      now->was_there = true;
    } else {
      before_[lost++] = then;
    }
  }
  before_.resize(lost);
  if (before_.empty()) return;
  changes_.clear();
  for (AtRest& at_rest : at_rest_) {
    if (before_.empty()) break;
    if (at_rest.was_there) continue;
    const auto apart = [&](const AtRest& then) {
      return squared_length(then.position - at_rest.position);
    };
    const auto nearest = std::ranges::min_element(before_, {}, apart);
    if (apart(*nearest) > followed_within_ * followed_within_) continue;
    const std::uint32_t id = nearest->id;
    before_.erase(nearest);
    const std::size_t taken = find_from_id(contacts, id);
    if (taken < contacts.size() && contacts[taken].id == id) continue;
    changes_.push_back({find_from_id(contacts, at_rest.id), id});
    at_rest.id = id;
  }
  if (changes_.empty()) return;
  for (const auto& [place, id] : changes_) contacts[place].id = id;
  std::ranges::sort(contacts, {}, &Contact::id);
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
    if (const AtRest* const known = find_known(position, same_within_)) {
      const double gap = std::max(-static_cast<double>(known->depth), 0.0);
      const double lead = turning.lead_over(surface_->position(start), surface_->normal(start),
                                            known->position, gap, -outwards);
      return lead > scale.margin;
    }
    const Along along{position.x, at_rest_.size()};
    by_x_.insert(std::ranges::upper_bound(by_x_, along.x, {}, &Along::x), along);
    at_rest_.push_back({contact.id, false, static_cast<float>(depth), place, position});
    contact.point = static_cast<Vec3f>(position);
    contact.normal = static_cast<Vec3f>(outwards);
    contact.depth = static_cast<float>(depth);
    return true;
  }
  return true;
}

const RoundContacts::AtRest* RoundContacts::find_known(const Vec3& position, double within) const {
  for (auto near = std::ranges::lower_bound(by_x_, position.x - within, {}, &Along::x);
       near != by_x_.end() && near->x <= position.x + within; ++near) {
    const AtRest& known = at_rest_[near->index];
    if (squared_length(known.position - position) <= within * within) return &known;
  }
  return nullptr;
}

/// Of at least one.
const RoundContacts::AtRest& RoundContacts::nearest_known(const Vec3& position) const {
  const AtRest* nearest = &at_rest_.front();
  double least = std::numeric_limits<double>::infinity();
  const auto look_at = [&](const Along& along) {
    const double aside = along.x - position.x;
    if (aside * aside >= least) return false;
    const AtRest& known = at_rest_[along.index];
    const double squared = squared_length(known.position - position);
    if (squared < least) {
      least = squared;
      nearest = &known;
    }
    return true;
  };
  const auto middle = std::ranges::lower_bound(by_x_, position.x, {}, &Along::x);
  for (auto right = middle; right != by_x_.end() && look_at(*right); ++right) {
  }
  for (auto left = middle; left != by_x_.begin() && look_at(*std::prev(left)); --left) {
  }
  return *nearest;
}

void RoundContacts::append_ids(std::uint32_t first, std::vector<std::uint32_t>& ids) const {
  const auto before = static_cast<std::ptrdiff_t>(ids.size());
  for (const AtRest& at_rest : at_rest_) ids.push_back(first + at_rest.id);
  std::sort(ids.begin() + before, ids.end());
}

void RoundContacts::drop_covered(std::vector<Contact>& others, const PointShell& shell_of_others,
                                 const Pose& other_from_shell) const {
  if (at_rest_.empty()) return;
  const Pose shell_from_other = other_from_shell.inverse();
  float as_deep = -std::numeric_limits<float>::infinity();
  for (const AtRest& at_rest : at_rest_) as_deep = std::max(as_deep, at_rest.depth);
  as_deep -= as_deep_within_;
  const auto is_covered = [&](const Contact& contact) {
    // Of flat faces that lie on each other, all are as deep.
    if (contact.depth >= as_deep) return false;
    const Vec3 point = shell_from_other.transform_point(static_cast<Vec3>(contact.point));
    const AtRest& nearest = nearest_known(point);
    Vec3 direction = surface_->normal(nearest.place);
    if (shell_of_others.is_point(contact.id)) {
      direction =
          -shell_from_other.rotate(static_cast<Vec3>(shell_of_others.normal_of(contact.id)));
    } else if (dot(point - nearest.position, direction) < -margin_) {
      // An edge that stands up from the ground.
      return false;
    }
    const SmoothSurface::Place start = surface_->nearest_from(nearest.place, point);
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
    return slide.is_at_rest && find_known(deepest, within) != nullptr;
  };
  std::erase_if(others, is_covered);
}

}  // namespace voxshell::bullet
