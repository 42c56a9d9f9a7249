#include "model_algorithm.h"

#include <algorithm>
#include <limits>
#include <span>
#include <typeinfo>
#include <utility>

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include "conservative_advancement.h"
#include "contact_constants.h"
#include "contact_list.h"
#include "contact_rule.h"
#include "facing_normals.h"
#include "pair_step.h"
#include "posed_pair.h"
#include "rolling_lever.h"
#include "shape_features.h"
#include "stage_clock.h"
#include "voxshell/bullet/convert.h"
#include "voxshell/manifold.h"
#include "way_out.h"

namespace voxshell::bullet {
namespace {

/// The depth of the deepest of `points`.
float depth_of(const ManifoldPoints& points, std::span<const Contact> contacts) {
  float depth = -std::numeric_limits<float>::infinity();
  for (const std::uint32_t index : points.chosen()) {
    depth = std::max(depth, contacts[index].depth);
  }
  return depth;
}

/// Those of `contacts`, ascending by id, that are in `manifold`, if all in it are among them.
ManifoldPoints points_before(std::span<const Contact> contacts,
                             const btPersistentManifold& manifold) {
  ManifoldPoints points;
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    const auto id = static_cast<std::uint32_t>(manifold.getContactPoint(i).m_index0);
    const std::size_t found = find_from_id(contacts, id);
    if (found == contacts.size() || contacts[found].id != id) return {};
    points.indices[points.count++] = static_cast<std::uint32_t>(found);
  }
  return points;
}

/// The points of `contacts` for the manifold. Points that change from step to step keep a body
/// rocking: those of the step before stay as long as none is deeper by more than `band`.
ManifoldPoints choose(std::span<const Contact> contacts, std::size_t most,
                      const btPersistentManifold& manifold, float band) {
  const ManifoldPoints before = points_before(contacts, manifold);
  const float deepest = find_deepest(contacts).depth;
  const bool carries_on = before.count <= most && deepest <= depth_of(before, contacts) + band;
  if (carries_on && before.count >= std::min(kCarryingPoints, most)) return before;
  const ManifoldPoints chosen = select_manifold(contacts, most);
  return carries_on && before.count >= chosen.count ? before : chosen;
}

/// The contact of models of which one lies wholly inside the other, or in its very place.
std::optional<Contact> find_inner(const PosedPair& pair) {
  const Pose field_from_shell = pair.field_from_shell();
  auto found =
      find_inner_contact(pair.shell_side().participant(), pair.field(), field_from_shell, 0.0f);
  if (!found && pair.field_side().model() != nullptr) {
    const Pose shell_from_field = field_from_shell.inverse();
    found = find_inner_contact(pair.field_side().participant(), pair.second_field(),
                               shell_from_field, 0.0f);
    if (found) found = turn_over(*found, shell_from_field);
  }
  if (!found) return std::nullopt;
  found->id = kInnerContact;
  // Where no direction is better than another, one that is the same in every step.
  if (found->normal == Vec3f{}) found->normal = {0, 0, 1};
  return found;
}

/// The ids, ascending, of contacts of a shell that are no samples.
void gather_exact(const RoundContacts& own, const RoundFieldContacts& on_round,
                  std::vector<std::uint32_t>& exact) {
  exact.clear();
  own.append_ids(0, exact);
  on_round.append_ids(0, exact);
  std::ranges::sort(exact);
}

}  // namespace

ModelAlgorithm::ModelAlgorithm(const btCollisionAlgorithmConstructionInfo& info,
                               const ContactSettings& settings, Purpose purpose,
                               std::shared_ptr<const Hull> hull)
    : btCollisionAlgorithm(info), settings_(settings), purpose_(purpose), hull_(std::move(hull)) {}

ModelAlgorithm::~ModelAlgorithm() { release_manifolds(); }

void ModelAlgorithm::release_manifolds() {
  for (const SegmentManifold& entry : active_) m_dispatcher->releaseManifold(entry.manifold);
  for (btPersistentManifold* manifold : idle_) m_dispatcher->releaseManifold(manifold);
  active_.clear();
  idle_.clear();
}

void ModelAlgorithm::getAllContactManifolds(btManifoldArray& manifolds) {
  for (const SegmentManifold& entry : active_) manifolds.push_back(entry.manifold);
}

void ModelAlgorithm::processCollision(const btCollisionObjectWrapper* a,
                                      const btCollisionObjectWrapper* b,
                                      const btDispatcherInfo& info, btManifoldResult* result) {
  if (hull_) renew_hull(*a, *b);
  PosedPair pair(*a, *b, hull_.get(), settings_.shell);
  // A contact test without a threshold takes the step's algorithms for the children of compounds;
  // its result is of a class of its own.
  const bool simulates =
      purpose_ == Purpose::kSimulation && typeid(*result) == typeid(btManifoldResult);
  if (!simulates) {
    const auto margin = static_cast<double>(result->m_closestPointDistanceThreshold);
    find_near(pair, margin, nullptr, Wanted::kAll);
    report(pair, *result);
    return;
  }

  StageClock clock(settings_.timings);
  const auto describe = [&] {
    return describe_step(pair, settings_, static_cast<double>(info.m_timeStep),
                         memory_.owed_energy);
  };
  PairStep step = describe();
  uses_ccd_ = step.uses_ccd;
  // A point a segment is what kSegmented promises of bodies that move.
  const bool takes_all = !uses_ccd_ && (settings_.mode != ContactMode::kSegmented || step.is_still);
  double fraction = 0.0;  // of the step, after which contacts are looked for
  if (uses_ccd_ && pair.has_triangles()) {
    fraction = find_on_the_way(step);
  } else {
    const bool has_swapped_roles =
        find_near(pair, step.margin, &step, takes_all ? Wanted::kAll : Wanted::kOneASegment);
    if (has_swapped_roles) step = describe();
  }
  const auto rest_margin = static_cast<float>(step.rest_margin);
  if (pair.asks_both) second_.drop_doubles(rest_margin, contacts_);
  clock.end(&NarrowPhaseTimings::query);
  const StepContacts of_step =
      apply_contact_rule(step, features_, exact_, fraction, contacts_, memory_);
  // Of bodies in a pile that move a little, such points carry in the next step.
  const bool lies = step.is_still || settings_.mode == ContactMode::kRegular;
  if (takes_all && lies && !contacts_.empty()) drop_idle_points(kIdleOfMargin * rest_margin);
  if (shell_was_a_ != pair.shell_is_a) {
    // Ids and segments now are another body's: nothing of the last step carries over.
    release_manifolds();
    memory_.patch.release();
    shell_was_a_ = pair.shell_is_a;
  }
  if (contacts_.empty()) {
    // Pairs whose bounds overlap outnumber those in contact: they keep nothing for the solver to
    // look through.
    release_manifolds();
    clock.end(&NarrowPhaseTimings::reduction);
    return;
  }
  // Four points do not hold a body that turns while it is stopped: fast steps have all segments.
  const bool is_regular = takes_all && settings_.mode == ContactMode::kRegular;
  assign_manifolds(pair, is_regular);
  choose_points(step, is_regular);
  clock.end(&NarrowPhaseTimings::reduction);
  fill(step, of_step);
  clock.end(&NarrowPhaseTimings::manifold);
}

/// Of a shape that was given points or scaled, if they still have a hull.
void ModelAlgorithm::renew_hull(const btCollisionObjectWrapper& a,
                                const btCollisionObjectWrapper& b) {
  const btCollisionShape* shape = a.getCollisionShape();
  if (!shape->isConvex()) shape = b.getCollisionShape();
  if (meeting_with(*shape) != Meeting::kHull) return;
  const auto& convex = static_cast<const btConvexShape&>(*shape);
  const Vec3 scaling = from_bullet(convex.getLocalScaling());
  const bool is_scaled = hull_scaling_ && !(*hull_scaling_ == scaling);
  hull_scaling_ = scaling;
  if (!is_scaled && hull_->is_of(convex)) return;
  if (auto made = Hull::create(Hull::points_of(convex))) {
    hull_ = std::make_shared<const Hull>(*std::move(made));
  }
}

/// Fills contacts_, ascending by id, with the points within the margin or the deepest of these of
/// each segment. `step` is null in contact tests, which take contacts as sampled. Returns whether
/// the roles of the pair were swapped for it.
bool ModelAlgorithm::find_near(PosedPair& pair, double margin, const PairStep* step,
                               Wanted wanted) {
  // Of surfaces thickened by Bullet's margins, contacts are points that near.
  const auto reach = static_cast<float>(margin + pair.thickness());
  if (pair.has_triangles()) {
    const Model& model = *pair.field_side().model();
    const std::vector<Contact>& found = triangle_contacts_.find(
        *pair.shell_side().triangles(), model, pair.field_from_shell(), level(), reach);
    contacts_.assign(found.begin(), found.end());
    return false;
  }
  const TouchScale touch =
      step == nullptr ? TouchScale{} : TouchScale{step->radius, step->rest_margin, step->thickness};
  bool has_swapped_roles = false;
  exact_.clear();
  // What kSegmented promises are points, and so are contacts without a margin.
  const bool slides =
      step != nullptr && touch.margin > 0.0 && settings_.mode != ContactMode::kSegmented;
  const auto reach_of = [&](const Side& side) {
    return reach + (slides ? static_cast<float>(most_above_samples(*side.model())) : 0.0f);
  };
  // What a still body does not lie on is left out below, too.
  const auto least_depth_of = [&](std::span<const Contact> contacts) {
    if (contacts.empty() || !step->is_still || wanted != Wanted::kAll) return -reach;
    const float band = kIdleOfMargin * static_cast<float>(step->rest_margin);
    return std::max(std::min(find_deepest(contacts).depth - band, 0.0f), -reach);
  };
  const auto drop_far = [&](std::vector<Contact>& contacts) {
    keep_if(contacts, [&](const Contact& contact) { return contact.depth > -reach; });
  };
  Opposition opposition;
  const auto drop_behind = [&](std::vector<Contact>& contacts, const PointShell& shell) {
    if (step == nullptr || settings_.mode == ContactMode::kSegmented) return;
    const auto near = static_cast<float>(step->rest_margin + step->thickness);
    const auto deep = static_cast<float>(step->deep_overlap);
    drop_from_behind(contacts, shell, near, deep, opposition);
  };
  const auto take = [&] {
    const std::span<const Contact> found = ask(pair.field(), pair.shell(), pair.field_from_shell(),
                                               reach_of(pair.shell_side()), wanted, scratch_);
    contacts_.assign(found.begin(), found.end());
    face_elements(contacts_, pair.field(), pair.shell(), pair.field_from_shell(),
                  pair.field_side().has_sharp_field() ? touch.margin : 0.0, pair.thickness());
    const bool slides_first = slides && !has_swapped_roles;
    if (slides_first) {
      first_on_round_.slide(contacts_, *pair.shell_side().model(), RoundSide::of(pair.field_side()),
                            pair.field_from_shell(), touch, own_turning_of(*step, false));
    }
    first_flat_.align(contacts_, pair.field(), pair.shell(), pair.shell_side().model()->grid(),
                      pair.field_from_shell(), touch);
    drop_behind(contacts_, pair.shell());
    if (!slides_first) return;
    first_round_.slide(contacts_, *pair.shell_side().model(), SmoothField(pair.field_side()),
                       pair.field_from_shell(), touch, turning_of(*step, false),
                       least_depth_of(contacts_));
    drop_far(contacts_);
  };
  take();
  if (pair.asks_both) {
    const Pose second_field_from_shell = pair.field_from_shell().inverse();
    const std::span<const Contact> found =
        ask(pair.second_field(), pair.second_shell(), second_field_from_shell,
            reach_of(pair.field_side()), wanted, second_scratch_);
    second_found_.assign(found.begin(), found.end());
    face_elements(second_found_, pair.second_field(), pair.second_shell(), second_field_from_shell,
                  pair.shell_side().has_sharp_field() ? touch.margin : 0.0, pair.thickness());
    if (slides) {
      second_on_round_.slide(second_found_, *pair.field_side().model(),
                             RoundSide::of(pair.shell_side()), second_field_from_shell, touch,
                             own_turning_of(*step, true));
    }
    second_flat_.align(second_found_, pair.second_field(), pair.second_shell(),
                       pair.field_side().model()->grid(), second_field_from_shell, touch);
    drop_behind(second_found_, pair.second_shell());
    if (slides) {
      second_round_.slide(second_found_, *pair.field_side().model(), SmoothField(pair.shell_side()),
                          second_field_from_shell, touch, turning_of(*step, true),
                          least_depth_of(second_found_));
      drop_far(second_found_);
      gather_exact(first_round_, first_on_round_, exact_);
      gather_exact(second_round_, second_on_round_, second_exact_);
      first_on_round_.drop_covered(contacts_, /*are_of_field=*/false, exact_);
      first_on_round_.drop_covered(second_found_, /*are_of_field=*/true, second_exact_);
      second_on_round_.drop_covered(second_found_, /*are_of_field=*/false, second_exact_);
      second_on_round_.drop_covered(contacts_, /*are_of_field=*/true, exact_);
      first_round_.drop_covered(second_found_, pair.second_shell(), second_exact_, contacts_,
                                pair.field_from_shell());
      second_round_.drop_covered(contacts_, pair.shell(), exact_, second_found_,
                                 second_field_from_shell);
    }
    second_.append(second_found_, second_field_from_shell, contacts_);
  } else if (settings_.shell == ShellRule::kFewest && contacts_.empty() &&
             pair.swap_roles_if_enclosed()) {
    has_swapped_roles = true;
    take();
  }
  if (settings_.shell == ShellRule::kAutomatic) {
    if (step == nullptr) {
      const auto inner = contacts_.empty() ? find_inner(pair) : std::nullopt;
      if (inner) contacts_.push_back(*inner);
    } else {
      append_way_out(*step, opposition);
    }
  }
  const bool has_slid = slides && !has_swapped_roles;
  if (has_slid) {
    gather_exact(first_round_, first_on_round_, exact_);
    if (pair.asks_both) {
      for (const std::uint32_t id : second_exact_) exact_.push_back(kFirstOfSecond + id);
    } else {
      first_on_round_.drop_covered(contacts_, /*are_of_field=*/false, exact_);
    }
  }
  find_features(pair, features_);
  if (features_.empty()) return has_swapped_roles;
  if (features_.front().radius > 0.0) {
    balls_.append(features_, pair, reach, has_slid ? touch : TouchScale{}, contacts_, exact_);
    if (has_slid) balls_.drop_covered(contacts_, pair.shell(), exact_);
    return has_swapped_roles;
  }
  append_feature_contacts(features_, pair, reach, contacts_);
  if (has_slid) first_on_round_.slide_features(contacts_, features_, exact_);
  std::ranges::sort(exact_);
  return has_swapped_roles;
}

/// Of bodies deep in each other whose contacts tell no way out.
void ModelAlgorithm::append_way_out(const PairStep& step, const Opposition& opposition) {
  const PosedPair& pair = *step.pair;
  const auto is_deep = [&](const Contact& contact) {
    return static_cast<double>(contact.depth) + step.thickness > step.deep_overlap;
  };
  if (std::ranges::any_of(contacts_, is_deep)) return;
  const bool is_buried = static_cast<double>(opposition.buried) > step.deep_overlap;
  if (!is_buried && (opposition.is_opposed || !find_inner(pair))) return;
  const auto way = find_way_out(pair, kWayOutPrecision * step.deep_overlap);
  if (!way) return;
  const Side& smaller = step.larger == &pair.shell_side() ? pair.field_side() : pair.shell_side();
  const Vec3 place = pair.shell_side().world_from_geometry().inverse().transform_point(
      smaller.bounding_ball().centre);
  // Others are of rims, and push to all sides.
  contacts_.assign(1, {kInnerContact, static_cast<float>(way->distance), static_cast<Vec3f>(place),
                       static_cast<Vec3f>(way->direction)});
}

std::span<const Contact> ModelAlgorithm::ask(const Field& field, const PointShell& shell,
                                             const Pose& field_from_shell, float reach,
                                             Wanted wanted, QueryScratch& scratch) const {
  if (wanted == Wanted::kAll) {
    return find_contacts(field, shell, field_from_shell, {.margin = reach}, scratch);
  }
  return find_deepest_per_segment(field, shell, field_from_shell, level(), reach, scratch);
}

/// Fills contacts_ with those of the pose at which triangles first touch the model within the step,
/// by conservative advancement of the whole body: its first contact need not be where it is nearest
/// now. Returns the fraction of the step that is over then.
double ModelAlgorithm::find_on_the_way(const PairStep& step) {
  const PosedPair& pair = *step.pair;
  const Model& model = *pair.field_side().model();
  const double farthest = step.farthest_displacement;
  const auto reach = [&](double fraction) {
    return static_cast<float>((1.0 - fraction) * farthest + step.rest_margin + step.thickness);
  };
  contacts_.clear();
  features_.clear();
  triangle_contacts_.gather(*pair.shell_side().triangles(), model, pair.field_from_shell(),
                            reach(0.0));
  const auto touch = advance(farthest, step.touching_gap(), 1.0, [&](double fraction) {
    const double gap =
        triangle_contacts_.distance(model, step.field_from_shell_after(fraction), reach(fraction)) -
        step.thickness;
    return Clearance{gap, kSafeOfGap * gap};
  });
  if (!touch) return 0.0;
  const double fraction = touch->fraction;
  const std::vector<Contact>& found = triangle_contacts_.find(
      model, step.field_from_shell_after(fraction), level(), reach(fraction),
      kPlaneBeyondGaps * static_cast<float>(step.touching_gap()));
  contacts_.assign(found.begin(), found.end());
  return fraction;
}

int ModelAlgorithm::level() const {
  if (settings_.level > 0) return std::min(settings_.level, PointSphereTree::kMaxLevel);
  // What kSegmented promises does not change from step to step.
  const bool finer = uses_ccd_ && settings_.mode != ContactMode::kSegmented;
  return finer ? kDefaultCcdLevel : kDefaultLevel;
}

ModelAlgorithm::Segment ModelAlgorithm::segment_of(const PosedPair& pair,
                                                   const Contact& contact) const {
  if (pair.has_triangles() || contact.id >= kInnerContact) {
    return {contact.id, std::uint64_t{contact.id} + 1};
  }
  // Segments of a tree and its edges number less than its elements, of which there are at most this
  // many.
  constexpr std::uint32_t kMost = 2 * std::uint32_t{PointShellSettings::kMostPoints};
  const bool is_second = contact.id >= kFirstOfSecond;
  const PointShell& shell = is_second ? pair.second_shell() : pair.shell();
  const std::uint32_t first = is_second ? kFirstOfSecond : 0;
  const std::uint32_t segment = shell.segment_of(contact.id - first, level());
  return {is_second ? kMost + segment : segment,
          std::uint64_t{first} + shell.segment_elements(level(), segment).end};
}

void ModelAlgorithm::report(const PosedPair& pair, btManifoldResult& result) {
  const btCollisionObjectWrapper& a = pair.a.wrap();
  const btCollisionObjectWrapper& b = pair.b.wrap();
  // Of this manifold, the result wants only the order of the bodies.
  btPersistentManifold order(a.getCollisionObject(), b.getCollisionObject(), 0, BT_LARGE_FLOAT,
                             BT_LARGE_FLOAT);
  btPersistentManifold* const before = result.getPersistentManifold();
  result.setPersistentManifold(&order);
  const bool swapped = result.getBody0Internal() != a.getCollisionObject();
  const ManifoldPoints chosen = select_manifold(contacts_);
  for (const std::uint32_t index : chosen.chosen()) {
    const WorldContact contact = pair.to_world(contacts_[index]);
    const int id = static_cast<int>(contact.id);
    result.setShapeIdentifiersA((swapped ? b : a).m_partId, id);
    result.setShapeIdentifiersB((swapped ? a : b).m_partId, id);
    result.addContactPoint(to_bullet(contact.normal), to_bullet(contact.point_b),
                           static_cast<btScalar>(-contact.depth));
  }
  result.setPersistentManifold(before);
}

/// Drops points outside the surface that are farther from it than the nearest by more than `band`:
/// within a margin, points that carry nothing would span the largest area, and those that carry the
/// body would go without. Features are few, and the ends of what they are of.
void ModelAlgorithm::drop_idle_points(float band) {
  const float least = std::min(find_deepest(contacts_).depth - band, 0.0f);
  keep_if(contacts_, [&](const Contact& contact) {
    return (contact.depth >= least) | (contact.id >= kFirstFeature);
  });
}

/// Makes active_ the manifolds that contacts_ need, each with how many they are: one for each
/// segment that has some, or one for all.
void ModelAlgorithm::assign_manifolds(const PosedPair& pair, bool is_regular) {
  // Both lists ascend by segment: manifolds of segments that lost their contacts are emptied first,
  // so that segments which gained some can have them.
  auto old = active_.begin();
  next_.clear();
  Segment segment{0, 0};
  for (const Contact& contact : contacts_) {
    if (contact.id < segment.end) {
      ++next_.back().contact_count;
      continue;
    }
    segment = is_regular ? Segment{0, UINT64_MAX} : segment_of(pair, contact);
    for (; old != active_.end() && old->segment < segment.index; ++old) {
      idle_.push_back(old->manifold);
    }
    const bool continues = old != active_.end() && old->segment == segment.index;
    next_.push_back({segment.index, continues ? (old++)->manifold : nullptr, 1});
  }
  for (; old != active_.end(); ++old) idle_.push_back(old->manifold);
  for (btPersistentManifold* manifold : idle_) {
    if (manifold->getNumContacts() > 0) manifold->clearManifold();
  }
  active_.swap(next_);
  for (SegmentManifold& entry : active_) {
    if (entry.manifold == nullptr) entry.manifold = take_manifold(pair);
  }
}

/// Those of its contacts that each of active_ is to hold.
void ModelAlgorithm::choose_points(const PairStep& step, bool is_regular) {
  const bool is_few = is_regular || active_.size() <= kFewSegments;
  const float band = kCarriesOnOfMargin * static_cast<float>(step.rest_margin);
  std::span<const Contact> left(contacts_);
  for (SegmentManifold& entry : active_) {
    const std::span<const Contact> group = left.first(entry.contact_count);
    left = left.subspan(entry.contact_count);
    entry.rolling_lever = is_few ? rolling_lever_of(step, group, exact_) : 0.0;
    entry.chosen = choose(group, is_few ? kManifoldSize : 1, *entry.manifold, band);
  }
}

/// Fills the manifolds of active_ with the points that were chosen for them.
void ModelAlgorithm::fill(const PairStep& step, const StepContacts& of_step) {
  const ManifoldFiller filler(step.pair->a.wrap(), step.pair->b.wrap());
  chosen_.clear();
  const Contact* group = contacts_.data();
  std::array<WorldContact, kManifoldSize> world;
  for (const SegmentManifold& entry : active_) {
    for (std::size_t i = 0; i < entry.chosen.count; ++i) {
      const Contact& contact = group[entry.chosen.indices[i]];
      world[i] = to_world(step, of_step, contact, entry.rolling_lever);
      chosen_.push_back(contact);
    }
    filler.fill(*entry.manifold, std::span(world).first(entry.chosen.count));
    group += entry.contact_count;
  }
  memory_.patch.keep(chosen_);
}

btPersistentManifold* ModelAlgorithm::take_manifold(const PosedPair& pair) {
  if (!idle_.empty()) {
    btPersistentManifold* manifold = idle_.back();
    idle_.pop_back();
    return manifold;
  }
  btPersistentManifold* manifold = m_dispatcher->getNewManifold(pair.a.wrap().getCollisionObject(),
                                                                pair.b.wrap().getCollisionObject());
  // Compounds refresh their children's manifolds, which drops points that have moved by more than
  // the threshold, and their impulses with them. Here, ManifoldFiller alone decides.
  manifold->setContactBreakingThreshold(BT_LARGE_FLOAT);
  return manifold;
}

}  // namespace voxshell::bullet
