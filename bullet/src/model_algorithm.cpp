#include "model_algorithm.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <new>
#include <optional>
#include <span>
#include <typeinfo>

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include "contact_rule.h"
#include "extreme_contact.h"
#include "posed_pair.h"
#include "voxshell/bullet/convert.h"
#include "voxshell/manifold.h"

namespace voxshell::bullet {
namespace {

constexpr int kDefaultLevel = 4;
/// Points that change from step to step keep a body rocking: those of the step before stay as long
/// as none is deeper by more than this share of the rest margin.
constexpr float kCarriesOn = 0.25f;

/// Adds the time from its making to its end.
class Stopwatch {
 public:
  Stopwatch(NarrowPhaseTimings* timings, double NarrowPhaseTimings::* part)
      : timings_(timings), part_(part) {
    if (timings_ != nullptr) start_ = std::chrono::steady_clock::now();
  }
  ~Stopwatch() {
    if (timings_ == nullptr) return;
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
    timings_->*part_ += elapsed.count();
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  NarrowPhaseTimings* timings_;
  double NarrowPhaseTimings::* part_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace

ModelAlgorithm::ModelAlgorithm(const btCollisionAlgorithmConstructionInfo& info,
                               const ContactSettings& settings, Purpose purpose)
    : btCollisionAlgorithm(info), settings_(settings), purpose_(purpose) {}

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
  PosedPair pair(*a, *b);
  // A contact test without a threshold takes the step's algorithms for the children of compounds;
  // its result is of a class of its own.
  const bool simulates =
      purpose_ == Purpose::kSimulation && typeid(*result) == typeid(btManifoldResult);
  if (!simulates) {
    const auto margin = static_cast<double>(result->m_closestPointDistanceThreshold);
    find_near(pair, margin, Wanted::kAll);
    report(pair, *result);
    return;
  }

  std::optional<ContactRule> rule;
  {
    const Stopwatch watch(settings_.timings, &NarrowPhaseTimings::query);
    rule.emplace(pair, settings_, static_cast<double>(info.m_timeStep), memory_);
    const bool takes_all =
        rule->is_still() || (settings_.mode == ContactMode::kRegular && !rule->sweeps());
    find_near(pair, rule->margin(), takes_all ? Wanted::kAll : Wanted::kOneASegment);
  }
  bool is_regular = false;
  {
    const Stopwatch watch(settings_.timings, &NarrowPhaseTimings::reduction);
    rule->apply(contacts_);
    is_regular = takes_one_manifold(*rule);
    if (!is_regular && rule->is_still()) {
      keep_one_a_segment(pair, kCarriesOn * static_cast<float>(rule->rest_margin()));
    }
  }
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
  } else if (is_regular) {
    fill_regular(pair, *rule);
  } else {
    fill_segmented(pair, *rule);
  }
}

/// Fills contacts_, ascending by id, with the points within the margin or the deepest of these of
/// each segment.
void ModelAlgorithm::find_near(PosedPair& pair, double margin, Wanted wanted) {
  // Of surfaces thickened by Bullet's margins, contacts are points that near.
  const auto reach = static_cast<float>(margin + pair.thickness());
  if (pair.has_triangles()) {
    const Model& model = *pair.field_side().model();
    const std::vector<Contact>& found = triangle_contacts_.find(
        *pair.shell_side().triangles(), model, pair.field_from_shell(), level(), reach);
    contacts_.assign(found.begin(), found.end());
    return;
  }
  const auto ask = [&] {
    const std::span<const Contact> found =
        wanted == Wanted::kAll
            ? find_contacts(pair.field(), pair.shell(), pair.field_from_shell(), {.margin = reach},
                            scratch_)
            : find_deepest_per_segment(pair.field(), pair.shell(), pair.field_from_shell(), level(),
                                       reach, scratch_);
    contacts_.assign(found.begin(), found.end());
  };
  ask();
  if (contacts_.empty() && pair.swap_roles_if_enclosed()) ask();
  if (const auto extreme = find_extreme_contact(pair, static_cast<float>(margin)))
    contacts_.push_back(*extreme);
}

/// Four points do not hold a body that turns while it is stopped: fast steps take all segments. A
/// small patch may lie in one segment, whose one point does not keep a body upright.
bool ModelAlgorithm::takes_one_manifold(const ContactRule& rule) const {
  switch (settings_.mode) {
    case ContactMode::kRegular:
      return !rule.sweeps();
    case ContactMode::kAutomatic:
      return !rule.sweeps() && rule.lie_on_small_patch();
    case ContactMode::kSegmented:
      break;
  }
  return false;
}

int ModelAlgorithm::level() const {
  return settings_.level > 0 ? std::min(settings_.level, PointSphereTree::kMaxLevel)
                             : kDefaultLevel;
}

/// The number that a contact's manifold goes by.
std::uint32_t ModelAlgorithm::segment_of(const PosedPair& pair, const Contact& contact) const {
  if (pair.has_triangles() || contact.id == kExtremeContact) return contact.id;
  return pair.shell().tree().segment(contact.id, level());
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

void ModelAlgorithm::fill_regular(const PosedPair& pair, const ContactRule& rule) {
  ManifoldPoints chosen;
  {
    const Stopwatch watch(settings_.timings, &NarrowPhaseTimings::reduction);
    drop_idle_points(static_cast<float>(rule.rest_margin()) / 5.0f);
    chosen = select_manifold(contacts_);
    const ManifoldPoints before = points_of_last_step();
    constexpr std::size_t kCarrying = 3;
    if (before.count >= kCarrying &&
        depth_of(chosen) <=
            depth_of(before) + kCarriesOn * static_cast<float>(rule.rest_margin())) {
      chosen = before;
    }
  }
  const Stopwatch watch(settings_.timings, &NarrowPhaseTimings::manifold);
  std::array<WorldContact, kManifoldSize> world;
  std::array<Contact, kManifoldSize> contacts;
  for (std::size_t i = 0; i < chosen.count; ++i) {
    contacts[i] = contacts_[chosen.indices[i]];
    world[i] = rule.to_world(contacts[i]);
  }
  memory_.patch.keep(std::span(contacts).first(chosen.count));
  if (active_.empty()) active_.push_back({0, take_manifold(pair)});
  for (; active_.size() > 1; active_.pop_back()) {  // of a fast step before
    m_dispatcher->releaseManifold(active_.back().manifold);
  }
  fill_manifold(*active_[0].manifold, std::span(world).first(chosen.count), pair.a.wrap(),
                pair.b.wrap());
}

/// Drops points outside the surface that are farther from it than the nearest by more than `band`:
/// within a margin, points that carry nothing would span the largest area, and those that carry the
/// body would go without.
void ModelAlgorithm::drop_idle_points(float band) {
  const auto deepest = std::ranges::max_element(contacts_, {}, &Contact::depth);
  const float least = std::min(deepest->depth - band, 0.0f);
  std::erase_if(contacts_, [&](const Contact& contact) { return contact.depth < least; });
}

/// The depth of the deepest.
float ModelAlgorithm::depth_of(const ManifoldPoints& points) const {
  float depth = -std::numeric_limits<float>::infinity();
  for (const std::uint32_t index : points.chosen()) {
    depth = std::max(depth, contacts_[index].depth);
  }
  return depth;
}

/// Those of contacts_ that were in the one manifold, if all that were are still contacts.
ManifoldPoints ModelAlgorithm::points_of_last_step() const {
  ManifoldPoints points;
  if (active_.size() != 1) return points;
  const btPersistentManifold& manifold = *active_[0].manifold;
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    const auto id = static_cast<std::uint32_t>(manifold.getContactPoint(i).m_index0);
    const auto found = std::ranges::lower_bound(contacts_, id, {}, &Contact::id);
    if (found == contacts_.end() || found->id != id) return {};
    points.indices[points.count++] = static_cast<std::uint32_t>(found - contacts_.begin());
  }
  return points;
}

/// Leaves of contacts_ the deepest of each segment, or the one of the step before if that is less
/// deep by `band` at most.
void ModelAlgorithm::keep_one_a_segment(const PosedPair& pair, float band) {
  std::size_t kept = 0;
  auto before = active_.begin();
  for (auto first = contacts_.begin(); first != contacts_.end();) {
    const std::uint32_t segment = segment_of(pair, *first);
    const auto last = std::find_if(first, contacts_.end(), [&](const Contact& contact) {
      return segment_of(pair, contact) != segment;
    });
    auto chosen = std::max_element(
        first, last, [](const Contact& a, const Contact& b) { return a.depth < b.depth; });
    before = std::find_if(before, active_.end(),
                          [&](const SegmentManifold& entry) { return entry.segment >= segment; });
    if (before != active_.end() && before->segment == segment) {
      const auto id = static_cast<std::uint32_t>(before->manifold->getContactPoint(0).m_index0);
      const auto same = std::ranges::find(first, last, id, &Contact::id);
      if (same != last && same->depth >= chosen->depth - band) chosen = same;
    }
    contacts_[kept++] = *chosen;
    first = last;
  }
  contacts_.resize(kept);
}

/// For contacts_ that are one a segment.
void ModelAlgorithm::fill_segmented(const PosedPair& pair, const ContactRule& rule) {
  const Stopwatch watch(settings_.timings, &NarrowPhaseTimings::manifold);
  memory_.patch.keep(contacts_);
  // Both lists ascend by segment: manifolds of segments that lost their contacts are emptied first,
  // so that segments which gained some can have them.
  auto old = active_.begin();
  next_.clear();
  for (const Contact& contact : contacts_) {
    const std::uint32_t segment = segment_of(pair, contact);
    for (; old != active_.end() && old->segment < segment; ++old) idle_.push_back(old->manifold);
    const bool continues = old != active_.end() && old->segment == segment;
    next_.push_back({segment, continues ? (old++)->manifold : nullptr});
  }
  for (; old != active_.end(); ++old) idle_.push_back(old->manifold);
  for (btPersistentManifold* manifold : idle_) {
    if (manifold->getNumContacts() > 0) manifold->clearManifold();
  }
  active_.swap(next_);
  for (std::size_t i = 0; i < active_.size(); ++i) {
    SegmentManifold& entry = active_[i];
    if (entry.manifold == nullptr) entry.manifold = take_manifold(pair);
    const WorldContact world = rule.to_world(contacts_[i]);
    fill_manifold(*entry.manifold, std::span(&world, 1), pair.a.wrap(), pair.b.wrap());
  }
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
  // the threshold, and their impulses with them. Here, fill_manifold() alone decides.
  manifold->setContactBreakingThreshold(BT_LARGE_FLOAT);
  return manifold;
}

btCollisionAlgorithm* ModelAlgorithmCreateFunc::CreateCollisionAlgorithm(
    btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper*,
    const btCollisionObjectWrapper*) {
  void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(ModelAlgorithm));
  return new (memory) ModelAlgorithm(info, settings_, purpose_);
}

}  // namespace voxshell::bullet
