#include "model_algorithm.h"

#include <algorithm>
#include <limits>
#include <span>
#include <typeinfo>
#include <utility>

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include "apart.h"
#include "contact_constants.h"
#include "contact_list.h"
#include "contact_rule.h"
#include "deep_on_the_way.h"
#include "impact.h"
#include "kept_contacts.h"
#include "of_this_thread.h"
#include "outer_contacts.h"
#include "pair_step.h"
#include "posed_pair.h"
#include "rolling_lever.h"
#include "stage_clock.h"
#include "supporting_places.h"
#include "voxshell/bullet/convert.h"
#include "voxshell/bullet/parallel_dispatcher.h"
#include "voxshell/manifold.h"

namespace voxshell::bullet {
namespace {

/// Null where the dispatcher does not tell.
const Support* support_in(const btDispatcher& dispatcher) {
  const auto* const known = dynamic_cast<const ParallelDispatcher*>(&dispatcher);
  return known != nullptr ? &known->support() : nullptr;
}

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
  const bool keeps_points = before.count <= most && deepest <= depth_of(before, contacts) + band;
  if (keeps_points && before.count >= std::min(kSupportingPoints, most)) return before;
  const ManifoldPoints chosen = select_manifold(contacts, most);
  return keeps_points && before.count >= chosen.count ? before : chosen;
}

/// Drops points outside the surface that are farther from it than the nearest by more than `band`:
/// within a margin, points that carry nothing would span the largest area, and those that carry the
/// body would go without. Features are few, and the ends of what they are of.
void drop_idle_points(float band, std::vector<Contact>& contacts) {
  const float least = std::min(find_deepest(contacts).depth - band, 0.0f);
  keep_if(contacts, [&](const Contact& contact) {
    return (contact.depth >= least) | (contact.id >= kFirstFeature);
  });
}

}  // namespace

ModelAlgorithm::ModelAlgorithm(const btCollisionAlgorithmConstructionInfo& info,
                               const ContactSettings& settings, Purpose purpose,
                               std::shared_ptr<const Hull> hull)
    : btCollisionAlgorithm(info),
      settings_(settings),
      purpose_(purpose),
      support_(support_in(*info.m_dispatcher1)),
      hull_(std::move(hull)) {}

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

/// A step of a pair as far as it changes nothing outside of its algorithm.
struct ModelAlgorithm::Prepared {
  btCollisionObjectWrapper a;
  btCollisionObjectWrapper b;
  PosedPair pair;
  PairStep step{};
  StepContacts of_step{};
  bool takes_all = false;       ///< all points within the margin, not one for each segment
  bool keeps_contacts = false;  ///< those of the last search

  static btCollisionObjectWrapper copy(const btCollisionObjectWrapper& of) {
    return {of.m_parent,
            of.getCollisionShape(),
            of.getCollisionObject(),
            of.getWorldTransform(),
            of.m_partId,
            of.m_index};
  }
  Prepared(const btCollisionObjectWrapper& of_a, const btCollisionObjectWrapper& of_b,
           const Hull* hull, ShellRule rule)
      : a(copy(of_a)), b(copy(of_b)), pair(a, b, hull, rule) {}
};

/// What is kept of bodies that are near each other.
struct ModelAlgorithm::Near {
  ContactSearch search;
  KeptContacts kept;
  PairMemory memory;
  std::optional<Prepared> prepared;
  bool is_on_few_segments = false;  ///< at the last search; or the contacts share one manifold
  bool is_spanned = false;          ///< the contacts are the outer ones of flat patches
};

bool ModelAlgorithm::has_searched() const {
  return near_ != nullptr && near_->prepared && !near_->prepared->keeps_contacts;
}

bool ModelAlgorithm::may_be_deep_on_the_way(const btCollisionObjectWrapper& a,
                                            const btCollisionObjectWrapper& b, double time_step,
                                            double depth) const {
  const PosedPair pair(a, b, hull_.get(), settings_.shell);
  return bullet::may_be_deep_on_the_way(pair, time_step, depth);
}

void ModelAlgorithm::processCollision(const btCollisionObjectWrapper* a,
                                      const btCollisionObjectWrapper* b,
                                      const btDispatcherInfo& info, btManifoldResult* result) {
  // A contact test without a threshold takes the step's algorithms for the children of compounds;
  // its result is of a class of its own.
  const bool simulates =
      purpose_ == Purpose::kSimulation && typeid(*result) == typeid(btManifoldResult);
  if (!simulates) {
    test_contact(*a, *b, *result);
    return;
  }
  StageClock clock(settings_.timings);
  if (!is_prepared_) prepare(*a, *b, static_cast<double>(info.m_timeStep), &clock);
  is_prepared_ = false;
  if (near_ == nullptr) {
    release_manifolds();
    clock.end(&NarrowPhaseTimings::query);
    return;
  }
  const std::optional<Prepared>& prepared = near_->prepared;
  if (prepared) commit(*prepared, clock);
}

void ModelAlgorithm::test_contact(const btCollisionObjectWrapper& a,
                                  const btCollisionObjectWrapper& b, btManifoldResult& result) {
  if (hull_) renew_hull(a, b);
  PosedPair pair(a, b, hull_.get(), settings_.shell);
  const auto margin = static_cast<double>(result.m_closestPointDistanceThreshold);
  ContactSearch search;
  search.find_near(settings_, pair, margin, nullptr, Wanted::kAll);
  report(pair, search.contacts(), result);
}

/// Whether the contacts of a search hold for poses near it. Those of segments and of worlds without
/// a margin are promised to be the samples of each pose. Triangles may change unseen.
bool ModelAlgorithm::may_keep(const PairStep& step) const {
  return settings_.mode != ContactMode::kSegmented && step.rest_margin > 0.0 &&
         !step.pair->has_triangles();
}

/// Of a body that lies still, leaves the contacts that span what it lies on. Uniform models round
/// their edges, and their outermost contacts have slanted normals.
void ModelAlgorithm::span_patches(const PairStep& step) {
  near_->is_spanned = false;
  if (!step.is_still || settings_.mode != ContactMode::kAutomatic ||
      !step.pair->a.has_sharp_field() || !step.pair->b.has_sharp_field() ||
      step.pair->has_triangles()) {
    return;
  }
  near_->is_on_few_segments = count_segments(step) <= kFewSegments;
  near_->is_spanned =
      leave_outer(kLeastPatchShrinkOfRadius * step.ball.radius,
                  kFlatOfMargin * static_cast<float>(step.rest_margin), near_->search.contacts());
}

/// Whether a contact that was found touches.
bool ModelAlgorithm::touches(const PairStep& step) const {
  return std::ranges::any_of(near_->search.contacts(), [&](const Contact& contact) {
    return is_contact(step, impact_of(step, contact));
  });
}

/// Whether what was found cannot push the bodies as their contacts did in the last step. It may
/// support one side of a body alone, which would fall on the other one within the step.
bool ModelAlgorithm::has_lost_support(const PairStep& step) const {
  const PosedPair& pair = *step.pair;
  auto& places = of_this_thread<SupportingPlaces>();
  places.before.clear();
  places.now.clear();
  for (const SegmentManifold& entry : active_) {
    const btPersistentManifold& manifold = *entry.manifold;
    const double side = manifold.getBody0() == pair.a.wrap().getCollisionObject() ? 1.0 : -1.0;
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
      const btManifoldPoint& point = manifold.getContactPoint(i);
      if (!(point.m_appliedImpulse > 0)) continue;
      places.before.push_back(
          {from_bullet(manifold.getBody1()->getWorldTransform()(point.m_localPointB)),
           side * from_bullet(point.m_normalWorldOnB),
           static_cast<double>(point.m_appliedImpulse)});
    }
  }
  for (const Contact& contact : near_->search.contacts()) {
    const WorldContact world = pair.to_world(contact);
    places.now.push_back({world.point_b, world.normal, 0.0});
  }
  return !places.can_support(step.rest_margin);
}

/// Describes the step, and looks for contacts or keeps those of the last search.
///
/// @param support            What supports the bodies, or null: nothing does.
/// @param may_keep_contacts  Of the last search, where they hold.
/// @return The fraction of the step after which contacts were looked for.
double ModelAlgorithm::look(Prepared& prepared, double time_step, const Support* support,
                            bool may_keep_contacts) {
  ContactSearch& search = near_->search;
  KeptContacts& kept = near_->kept;
  PosedPair& pair = prepared.pair;
  PairStep& step = prepared.step;
  const auto describe = [&] {
    return describe_step(pair, settings_, time_step, near_->memory.owed_energy, support);
  };
  step = describe();
  // A point a segment is what kSegmented promises of bodies that move.
  prepared.takes_all =
      !step.uses_ccd && (settings_.mode != ContactMode::kSegmented || step.is_still);
  prepared.keeps_contacts = may_keep_contacts && kept.hold_in(step, search.can_follow());
  if (prepared.keeps_contacts) {
    kept.move_to(step, search.contacts());
    if (kept.have_moved_in(step)) {
      search.follow(pair);
      kept.renew(step, search.contacts());
    }
    return 0.0;
  }
  if (step.uses_ccd && pair.has_triangles()) return search.find_on_the_way(settings_, step);
  const Wanted wanted = prepared.takes_all ? Wanted::kAll : Wanted::kOneASegment;
  const bool has_swapped_roles = search.find_near(settings_, pair, step.margin, &step, wanted);
  if (has_swapped_roles) step = describe();
  span_patches(step);
  // Of roles that were swapped for this search, the next step would not know.
  if (may_keep(step) && !has_swapped_roles) kept.keep(step, search.contacts());
  return 0.0;
}

void ModelAlgorithm::prepare(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b,
                             double time_step, StageClock* clock) {
  if (are_apart(a, b, settings_, time_step)) {
    near_.reset();
    is_prepared_ = true;
    return;
  }
  if (hull_) renew_hull(a, b);
  if (near_ == nullptr) near_ = std::make_unique<Near>();
  Prepared& prepared = near_->prepared.emplace(a, b, hull_.get(), settings_.shell);
  const PairStep& step = prepared.step;
  // Bodies that touch nothing may come to fall.
  double fraction =
      look(prepared, time_step, active_.empty() ? nullptr : support_, /*may_keep_contacts=*/true);
  if (step.is_supported && (!touches(step) || has_lost_support(step))) {
    fraction = look(prepared, time_step, nullptr, /*may_keep_contacts=*/false);
  }
  if (clock != nullptr) clock->end(&NarrowPhaseTimings::query);
  const ContactSearch& search = near_->search;
  std::vector<Contact>& contacts = near_->search.contacts();
  prepared.of_step = apply_contact_rule(step, search.features(), search.exact(), search.hits(),
                                        fraction, contacts, near_->memory);
  // Of bodies in a pile that move a little, such points carry in the next step. So do those of
  // bodies that gravity would move far.
  const bool lies = step.is_still || settings_.mode == ContactMode::kRegular;
  if (prepared.takes_all && lies && !step.is_supported && !contacts.empty()) {
    drop_idle_points(kIdleOfMargin * static_cast<float>(step.rest_margin), contacts);
  }
  is_prepared_ = true;
}

/// Puts what was found into manifolds.
void ModelAlgorithm::commit(const Prepared& prepared, StageClock& clock) {
  const PairStep& step = prepared.step;
  if (shell_was_a_ != prepared.pair.shell_is_a) {
    // Ids and segments now are another body's: nothing of the last step carries over.
    release_manifolds();
    near_->memory.patch.release();
    shell_was_a_ = prepared.pair.shell_is_a;
  }
  if (near_->search.contacts().empty()) {
    // Pairs whose bounds overlap outnumber those in contact: they keep nothing for the solver to
    // look through.
    release_manifolds();
    clock.end(&NarrowPhaseTimings::reduction);
    return;
  }
  // Four points do not hold a body that turns while it is stopped: fast steps have all segments.
  const bool is_regular = prepared.takes_all && settings_.mode == ContactMode::kRegular;
  if (!prepared.keeps_contacts && !near_->is_spanned) {
    near_->is_on_few_segments = is_regular || count_segments(step) <= kFewSegments;
  }
  assign_manifolds(step, is_regular);
  choose_points(step, prepared.keeps_contacts);
  clock.end(&NarrowPhaseTimings::reduction);
  fill(step, prepared.of_step);
  // While bodies move as far as followed contacts are kept for, others than these come to carry.
  const bool is_chosen_enough = near_->is_spanned || !near_->search.can_follow();
  if (!prepared.keeps_contacts && is_chosen_enough) near_->kept.reduce_to(chosen_);
  clock.end(&NarrowPhaseTimings::manifold);
}

/// Of a shape that was given points or scaled, if they still have a hull.
void ModelAlgorithm::renew_hull(const btCollisionObjectWrapper& a,
                                const btCollisionObjectWrapper& b) {
  const btCollisionShape* shape = a.getCollisionShape();
  if (!shape->isConvex()) shape = b.getCollisionShape();
  if (collision_method_of(*shape) != CollisionMethod::kHull) return;
  const auto& convex = static_cast<const btConvexShape&>(*shape);
  const Vec3 scaling = from_bullet(convex.getLocalScaling());
  const bool is_scaled = hull_scaling_ && !(*hull_scaling_ == scaling);
  hull_scaling_ = scaling;
  if (!is_scaled && hull_->is_of(convex)) return;
  if (auto made = Hull::create(Hull::points_of(convex))) {
    hull_ = std::make_shared<const Hull>(*std::move(made));
  }
}

ModelAlgorithm::Segment ModelAlgorithm::segment_of(const PosedPair& pair, const Contact& contact,
                                                   int level) {
  if (pair.has_triangles() || contact.id >= kInnerContact) {
    return {contact.id, std::uint64_t{contact.id} + 1};
  }
  // Segments of a tree and its edges number less than its elements, of which there are at most this
  // many.
  constexpr std::uint32_t kMost = 2 * std::uint32_t{PointShellSettings::kMostPoints};
  const bool is_second = contact.id >= kFirstOfSecond;
  const PointShell& shell = is_second ? pair.second_shell() : pair.shell();
  const std::uint32_t first = is_second ? kFirstOfSecond : 0;
  const std::uint32_t segment = shell.segment_of(contact.id - first, level);
  return {is_second ? kMost + segment : segment,
          std::uint64_t{first} + shell.segment_elements(level, segment).end};
}

void ModelAlgorithm::report(const PosedPair& pair, std::span<const Contact> contacts,
                            btManifoldResult& result) {
  const btCollisionObjectWrapper& a = pair.a.wrap();
  const btCollisionObjectWrapper& b = pair.b.wrap();
  // Of this manifold, the result wants only the order of the bodies.
  btPersistentManifold order(a.getCollisionObject(), b.getCollisionObject(), 0, BT_LARGE_FLOAT,
                             BT_LARGE_FLOAT);
  btPersistentManifold* const before = result.getPersistentManifold();
  result.setPersistentManifold(&order);
  const bool swapped = result.getBody0Internal() != a.getCollisionObject();
  const ManifoldPoints chosen = select_manifold(contacts);
  for (const std::uint32_t index : chosen.chosen()) {
    const WorldContact contact = pair.to_world(contacts[index]);
    const int id = static_cast<int>(contact.id);
    result.setShapeIdentifiersA((swapped ? b : a).m_partId, id);
    result.setShapeIdentifiersB((swapped ? a : b).m_partId, id);
    result.addContactPoint(to_bullet(contact.normal), to_bullet(contact.point_b),
                           static_cast<btScalar>(-contact.depth));
  }
  result.setPersistentManifold(before);
}

std::size_t ModelAlgorithm::count_segments(const PairStep& step) const {
  const int level = level_of(settings_, step.uses_ccd);
  std::size_t count = 0;
  std::uint64_t end = 0;
  for (const Contact& contact : near_->search.contacts()) {
    if (contact.id < end) continue;
    end = segment_of(*step.pair, contact, level).end;
    ++count;
  }
  return count;
}

/// Makes active_ the manifolds that the contacts need, each with how many they are: one for each
/// segment that has some, or one for all.
void ModelAlgorithm::assign_manifolds(const PairStep& step, bool is_regular) {
  const PosedPair& pair = *step.pair;
  const int level = level_of(settings_, step.uses_ccd);
  // Both lists ascend by segment: manifolds of segments that lost their contacts are emptied first,
  // so that segments which gained some can have them.
  auto old = active_.begin();
  next_.clear();
  Segment segment{0, 0};
  for (const Contact& contact : near_->search.contacts()) {
    if (contact.id < segment.end) {
      ++next_.back().contact_count;
      continue;
    }
    segment = is_regular ? Segment{0, UINT64_MAX} : segment_of(pair, contact, level);
    for (; old != active_.end() && old->segment < segment.index; ++old) {
      idle_.push_back(old->manifold);
    }
    const bool continues = old != active_.end() && old->segment == segment.index;
    next_.push_back({segment.index, nullptr, 1});
    if (!continues) continue;
    next_.back().manifold = old->manifold;
    next_.back().rolling_lever = old->rolling_lever;
    ++old;
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
/// @param keeps_contacts  The contacts are those that were chosen before, and not all there are.
void ModelAlgorithm::choose_points(const PairStep& step, bool keeps_contacts) {
  const bool is_few = near_->is_on_few_segments;
  // In steps with CCD a segment has the place that is nearest now and those that hit later.
  const bool has_hits = !near_->search.hits().empty() && settings_.mode != ContactMode::kSegmented;
  const std::size_t most = is_few || near_->is_spanned || has_hits ? kManifoldSize : 1;
  const float band = kKeepsPointsOfMargin * static_cast<float>(step.rest_margin);
  std::span<const Contact> left(near_->search.contacts());
  for (SegmentManifold& entry : active_) {
    const std::span<const Contact> group = left.first(entry.contact_count);
    left = left.subspan(entry.contact_count);
    if (!keeps_contacts) {
      entry.rolling_lever = is_few ? rolling_lever_of(step, group, near_->search.exact()) : 0.0;
    }
    entry.chosen = choose(group, most, *entry.manifold, band);
  }
}

/// Fills the manifolds of active_ with the points that were chosen for them.
void ModelAlgorithm::fill(const PairStep& step, const StepContacts& of_step) {
  const ManifoldFiller filler(step.pair->a.wrap(), step.pair->b.wrap());
  chosen_.clear();
  const Contact* group = near_->search.contacts().data();
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
  near_->memory.patch.keep(chosen_);
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
