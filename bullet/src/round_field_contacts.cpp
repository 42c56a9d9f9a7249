#include "round_field_contacts.h"

#include <algorithm>
#include <cmath>

#include "contact_constants.h"
#include "contact_list.h"
#include "find_zero.h"

namespace voxshell::bullet {

void RoundFieldContacts::slide(std::vector<Contact>& contacts, const Model& model,
                               const Side& other, const Pose& field_from_shell,
                               const TouchScale& scale, const Turning& turning,
                               const Turning& turning_of_field) {
  const bool forgets = before_ != &model;
  on_edges_.begin(forgets);
  on_faces_.begin(forgets);
  before_ = &model;
  last_.reset();
  // Uniform models round their edges off.
  round_ = model.settings().tolerance > 0.0 ? RoundSide::of(other) : std::nullopt;
  if (!round_) return;
  failed_.begin(contacts, field_from_shell, scale.radius, forgets);
  field_ = SmoothField(other);
  shell_ = &model;
  field_from_shell_ = field_from_shell;
  shell_from_field_ = field_from_shell.inverse();
  turning_ = turning;
  turning_of_field_ = turning_of_field;
  lead_ = std::max(scale.margin, kLeadOfRadius * scale.radius);
  margin_ = scale.margin;
  least_curvature_ = kFlatBend / scale.radius;
  same_within_ = kSameOfRadius * scale.radius;
  followed_within_ = kFollowedOfRadius * scale.radius;
  const RoundSide& on_round = *round_;
  std::erase_if(contacts, [&](Contact& contact) { return !slide_one(on_round, contact); });
  on_edges_.keep_ids(contacts, followed_within_);
  on_faces_.keep_ids(contacts, followed_within_);
}

void RoundFieldContacts::follow(std::span<const Contact> kept, std::uint32_t first_id,
                                const Side& other, const Pose& field_from_shell,
                                std::vector<Contact>& moved) {
  if (on_edges_.empty() && on_faces_.empty()) return;
  round_ = RoundSide::of(other);
  if (!round_) return;
  SmoothField field(other);
  field.start_near(field_);
  field_ = field;
  field_from_shell_ = field_from_shell;
  shell_from_field_ = field_from_shell.inverse();
  const RoundSide& round = *round_;
  using AtRest = PlacesAtRest<Touch>::AtRest;
  const auto go_on = [&](const AtRest& then) -> std::optional<AtRest> {
    if (!has_id(kept, first_id + then.id)) return std::nullopt;
    const Touch& of = then.of;
    const auto touch = of.is_on_edge
                           ? on_edge(round, of.position, of.along, of.mean, kFollowedWithin)
                           : on_face(round, of.position, of.outwards);
    if (!touch || touch->is_on_edge != of.is_on_edge) return std::nullopt;
    const auto depth = static_cast<float>(touch->depth);
    moved.push_back({then.id, depth, static_cast<Vec3f>(touch->position),
                     static_cast<Vec3f>(-touch->outwards)});
    return AtRest{then.id, then.was_there, depth, touch->position, *touch};
  };
  on_edges_.follow(go_on);
  on_faces_.follow(go_on);
}

/// Whether the contact is one that no other is yet.
bool RoundFieldContacts::slide_one(const RoundSide& round, Contact& contact) {
  const PointShell& shell = shell_->shell();
  const SmoothSurface& surface = shell_->smooth_surface();
  // Round parts of the shell's own are slid by RoundContacts.
  if (surface.is_curved() && !surface.is_flat(surface.triangle_of(contact.id))) return true;
  const auto point = static_cast<Vec3>(contact.point);
  const auto outwards = static_cast<Vec3>(shell.normal_of(contact.id));
  if (failed_.fails_again(contact.id)) return true;
  std::optional<Touch> touch;
  if (!shell.is_point(contact.id)) {
    const auto index = contact.id - static_cast<std::uint32_t>(shell.size());
    const auto half = static_cast<Vec3>(shell.edges()->halves()[index]);
    touch = on_edge(round, point, normalized(half), outwards, kZeroWithin);
  } else {
    touch = on_face(round, point, outwards);
  }
  if (!touch) {
    failed_.add(contact.id);
    return true;
  }
  // Points come first: those at an edge leave no second contact there.
  if (on_edges_.find(touch->position, same_within_) != nullptr ||
      on_faces_.find(touch->position, same_within_) != nullptr) {
    return may_lead(point, outwards, *touch);
  }
  PlacesAtRest<Touch>& places = touch->is_on_edge ? on_edges_ : on_faces_;
  contact.point = static_cast<Vec3f>(touch->position);
  contact.normal = static_cast<Vec3f>(-touch->outwards);
  contact.depth = static_cast<float>(touch->depth);
  places.add(contact.id, contact.depth, touch->position, *touch);
  return true;
}

/// Neighbors in a list are neighbors in space.
std::optional<RoundSide::Place> RoundFieldContacts::nearest_on(const RoundSide& round,
                                                               const Vec3& place) {
  if (field_.is_smooth()) return field_.nearest(place);
  const auto found = round.nearest(place, last_ ? &*last_ : nullptr);
  if (found) last_ = found;
  return found;
}

/// Along an edge through a point. `mean` is the mean of the normals of the two faces beside it,
/// `within` the sine by which the round surface's normal may lean along the edge.
std::optional<RoundFieldContacts::Touch> RoundFieldContacts::on_edge(
    const RoundSide& round, const Vec3& point, const Vec3& along, const Vec3& mean, double within) {
  const Vec3 start = field_from_shell_.transform_point(point);
  const Vec3 along_in_field = field_from_shell_.rotate(along);
  std::optional<RoundSide::Place> on_round;
  // The slope of the distance from the round body.
  const auto zero = find_zero(
      [&](double way) -> std::optional<double> {
        on_round = nearest_on(round, start + way * along_in_field);
        if (!on_round) return std::nullopt;
        return dot(on_round->normal, along_in_field);
      },
      same_within_, least_curvature_, within);
  if (!zero || !on_round) return std::nullopt;
  const Vec3 position = point + *zero * along;
  const GridField& own = shell_->grid();
  const double tolerance = shell_->settings().tolerance;
  if (std::abs(static_cast<double>(own.distance(static_cast<Vec3f>(position)))) > tolerance) {
    return std::nullopt;
  }
  const Vec3 in_field = start + *zero * along_in_field;
  const Vec3 normal =
      normalized(on_round->normal - dot(on_round->normal, along_in_field) * along_in_field);
  const Vec3 outwards = -shell_from_field_.rotate(normal);
  // The edge touches with a normal between those of its faces. A face that leads toward the round
  // body touches it elsewhere.
  const Vec3 beside = cross(along, mean);
  for (const double side : {-1.0, 1.0}) {
    const Vec3 away = side * beside;
    const Vec3 face = normalized(
        static_cast<Vec3>(own.gradient(static_cast<Vec3f>(position + tolerance * away))));
    if (std::abs(dot(face, along)) > kFaceOfEdge || !(dot(face, away) > 0.0)) continue;
    const Vec3 into = normalized(away - dot(away, face) * face);
    if (dot(outwards, into) > kLeansOverFace) return on_face(round, position, face);
  }
  const double depth = dot(on_round->position - in_field, normal);
  return Touch{position, outwards, depth, *on_round, true, along, mean};
}

/// Over the flat face that a point lies on.
std::optional<RoundFieldContacts::Touch> RoundFieldContacts::on_face(const RoundSide& round,
                                                                     const Vec3& point,
                                                                     const Vec3& outwards) {
  const Vec3 in_field = field_from_shell_.transform_point(point);
  const Vec3 up = field_from_shell_.rotate(outwards);
  const auto start = nearest_on(round, in_field);
  // The other side of a wall faces away.
  if (!start || !(dot(start->normal, up) < 0.0)) return std::nullopt;
  const auto lowest = round.slide(*start, -up, least_curvature_);
  if (!lowest || squared_length(lowest->normal + up) > kFlatRim * kFlatRim) return std::nullopt;
  const double depth = dot(in_field - lowest->position, up);
  const Vec3 position = shell_from_field_.transform_point(lowest->position + depth * up);
  const GridField& own = shell_->grid();
  const double tolerance = shell_->settings().tolerance;
  if (std::abs(static_cast<double>(own.distance(static_cast<Vec3f>(position)))) > tolerance) {
    return std::nullopt;
  }
  // At that depth the nearest surface of the shell's body must still be this one.
  if (depth > tolerance) {
    const auto deepest = static_cast<Vec3f>(position - depth * outwards);
    if (static_cast<double>(own.distance(deepest)) > -kOwnDepth * depth) return std::nullopt;
  }
  // In front of it: on an edge, the gradient is that of either face.
  const Vec3 there = normalized(
      static_cast<Vec3>(own.gradient(static_cast<Vec3f>(position + tolerance * outwards))));
  if (dot(there, outwards) < -static_cast<double>(kAlignedCosine)) return std::nullopt;
  return Touch{position, outwards, depth, *lowest, false, {}, {}};
}

/// Whether a place of the shell's body may touch, once that has turned, before a contact does.
bool RoundFieldContacts::may_lead(const Vec3& place, const Vec3& normal, const Touch& touch) const {
  const double gap = std::max(-touch.depth, 0.0);
  return turning_.lead_over(place, normal, touch.position, gap, touch.outwards) > margin_;
}

/// The same of a place of the round body.
bool RoundFieldContacts::round_may_lead(const RoundSide::Place& place, const Touch& touch) const {
  const double gap = std::max(-touch.depth, 0.0);
  const Vec3 direction = -field_from_shell_.rotate(touch.outwards);
  return turning_of_field_.lead_over(place.position, place.normal, touch.on_round.position, gap,
                                     direction) > lead_;
}

/// Whether a place of the shell's body, which looks outwards there, lies behind the nearest of some
/// contacts, to which the round surface leads from there.
bool RoundFieldContacts::is_covered(const RoundSide& round, const PlacesAtRest<Touch>& places,
                                    const Vec3& position, const Vec3& outwards,
                                    const RoundSide::Place& on_round) const {
  if (places.empty()) return false;
  const Touch& touch = places.nearest(position).of;
  if (may_lead(position, outwards, touch)) return false;
  const auto lowest =
      round.slide(on_round, -field_from_shell_.rotate(touch.outwards), least_curvature_);
  if (!lowest) return false;
  // Where bodies touch along a line, contacts are as far apart as samples are.
  const double moved = squared_length(lowest->position - on_round.position);
  double within = same_within_;
  if (moved > same_within_ * same_within_) {
    within +=
        round.model() != nullptr ? round.model()->shell().spacing() : shell_->shell().spacing();
  }
  return squared_length(lowest->position - touch.on_round.position) <= within * within;
}

void RoundFieldContacts::drop_covered(std::vector<Contact>& contacts, bool are_of_field,
                                      std::span<const std::uint32_t> exact) {
  if (!round_ || (on_edges_.empty() && on_faces_.empty())) return;
  const RoundSide& round = *round_;
  const auto covers = [&](const Vec3& position, const Vec3& outwards,
                          const RoundSide::Place& on_round) {
    return is_covered(round, on_edges_, position, outwards, on_round) ||
           is_covered(round, on_faces_, position, outwards, on_round);
  };
  std::erase_if(contacts, [&](const Contact& contact) {
    if (std::ranges::binary_search(exact, contact.id)) return false;
    const auto point = static_cast<Vec3>(contact.point);
    if (!are_of_field) {
      const auto on_round = nearest_on(round, field_from_shell_.transform_point(point));
      const auto outwards = static_cast<Vec3>(shell_->shell().normal_of(contact.id));
      return on_round && covers(point, outwards, *on_round);
    }
    const SmoothSurface& surface = round.model()->smooth_surface();
    const std::uint32_t triangle = surface.triangle_of(contact.id);
    if (surface.is_flat(triangle)) return false;
    const SmoothSurface::Place on = surface.nearest_on(triangle, point);
    const RoundSide::Place on_round = RoundSide::Place::of(surface, on);
    const auto normal = static_cast<Vec3>(contact.normal);
    const Vec3 touched = point + static_cast<double>(contact.depth) * normal;
    const Vec3 position = shell_from_field_.transform_point(touched);
    const auto leads = [&](const PlacesAtRest<Touch>& places) {
      return !places.empty() && round_may_lead(on_round, places.nearest(position).of);
    };
    return !leads(on_edges_) && !leads(on_faces_) &&
           covers(position, shell_from_field_.rotate(normal), on_round);
  });
}

void RoundFieldContacts::slide_features(std::vector<Contact>& contacts, std::span<Feature> features,
                                        std::vector<std::uint32_t>& exact) {
  if (!round_ || features.empty()) return;
  const RoundSide& round = *round_;
  const std::size_t first = find_from_id(contacts, kFirstFeature);
  std::vector<Vec3f> known;
  std::vector<std::uint32_t> dropped;
  // The last feature of a rim is the deepest as its center sees it.
  for (std::size_t i = contacts.size(); i-- > first;) {
    Contact& contact = contacts[i];
    Feature& feature = features[contact.id - kFirstFeature];
    const auto point = static_cast<Vec3>(contact.point);
    if (const auto* const at_rest = on_faces_.find(point, same_within_)) {
      dropped.push_back(at_rest->id);
    }
    const auto on_round = nearest_on(round, field_from_shell_.transform_point(point));
    const Vec3 outwards = -static_cast<Vec3>(contact.normal);
    if (on_round && is_covered(round, on_edges_, point, outwards, *on_round)) {
      dropped.push_back(contact.id);
      continue;
    }
    if (!slide_feature(round, contact, feature)) continue;
    const auto is_same = [&](const Vec3f& other) {
      return squared_length(static_cast<Vec3>(other) - feature.place) <=
             same_within_ * same_within_;
    };
    if (std::ranges::any_of(known, is_same)) {
      dropped.push_back(contact.id);
      continue;
    }
    known.push_back(static_cast<Vec3f>(feature.place));
    exact.push_back(contact.id);
  }
  std::ranges::sort(dropped);
  std::erase_if(contacts, [&](const Contact& contact) {
    return std::ranges::binary_search(dropped, contact.id);
  });
}

/// Along the rim that a feature is of. Whether it has come to rest.
bool RoundFieldContacts::slide_feature(const RoundSide& round, Contact& contact,
                                       Feature& feature) const {
  const GridField& own = shell_->grid();
  const Vec3 start = field_from_shell_.transform_point(feature.place);
  Vec3 outwards = -static_cast<Vec3>(contact.normal);
  for (int i = 0; i < kMostSlides; ++i) {
    const auto lowest =
        round.slide({start, {}, {}}, -field_from_shell_.rotate(outwards), least_curvature_);
    if (!lowest) return false;
    const Vec3 place = shell_from_field_.transform_point(lowest->position);
    const auto at = static_cast<Vec3f>(place);
    const Vec3 there = normalized(static_cast<Vec3>(own.gradient(at)));
    if (squared_length(there - outwards) > kSlideWithin * kSlideWithin) {
      outwards = there;
      continue;
    }
    const auto depth = -static_cast<double>(own.distance(at));
    if (depth < static_cast<double>(contact.depth) - kSlideLosesOfMargin * margin_) return false;
    feature.place = place;
    contact = contact_of(feature, contact.id, static_cast<Vec3f>(there), depth);
    return true;
  }
  return false;
}

void RoundFieldContacts::append_ids(std::uint32_t first, std::vector<std::uint32_t>& ids) const {
  const auto before = static_cast<std::ptrdiff_t>(ids.size());
  for (const auto& at_rest : on_edges_.all()) ids.push_back(first + at_rest.id);
  for (const auto& at_rest : on_faces_.all()) ids.push_back(first + at_rest.id);
  std::sort(ids.begin() + before, ids.end());
}

}  // namespace voxshell::bullet
