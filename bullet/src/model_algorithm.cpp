#include "model_algorithm.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <optional>
#include <typeinfo>

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "rest_margin.h"
#include "voxshell/bullet/convert.h"
#include "voxshell/bullet/model_shape.h"
#include "voxshell/manifold.h"

namespace voxshell::bullet {
namespace {

constexpr int kDefaultLevel = 4;

/// One side of a pair as the core sees it. Analytic fields live here, models in their shapes.
class Side {
 public:
  explicit Side(const btCollisionObjectWrapper& wrap)
      : wrap_(wrap), world_from_geometry_(from_bullet(wrap.getWorldTransform())) {
    const btCollisionShape* shape = wrap.getCollisionShape();
    switch (shape->getShapeType()) {
      case FAST_CONCAVE_MESH_PROXYTYPE: {
        const auto* model_shape = static_cast<const ModelShape*>(shape);
        world_from_geometry_ = world_from_geometry_ * model_shape->body_from_model();
        participant_ = {&model_shape->model().field(), &model_shape->model().shell()};
        return;
      }
      case STATIC_PLANE_PROXYTYPE: {
        const auto* plane = static_cast<const btStaticPlaneShape*>(shape);
        analytic_ = PlaneField{from_bullet(plane->getPlaneNormal()),
                               static_cast<double>(plane->getPlaneConstant())};
        break;
      }
      case BOX_SHAPE_PROXYTYPE:
        analytic_ = BoxField{
            from_bullet(static_cast<const btBoxShape*>(shape)->getHalfExtentsWithMargin())};
        break;
      case SPHERE_SHAPE_PROXYTYPE:
        analytic_ =
            SphereField{static_cast<double>(static_cast<const btSphereShape*>(shape)->getRadius())};
        break;
      default:
        btAssert(!"ModelAlgorithm is registered for the shapes above only");
        return;
    }
    participant_ = {&*analytic_, nullptr};
  }
  Side(const Side&) = delete;
  Side& operator=(const Side&) = delete;

  const Participant& participant() const { return participant_; }
  const Pose& world_from_geometry() const { return world_from_geometry_; }
  const btCollisionObjectWrapper& wrap() const { return wrap_; }

  /// Velocity of the material point at `world_point`, m/s.
  Vec3 velocity_at(const Vec3& world_point) const {
    const btRigidBody* body = btRigidBody::upcast(wrap_.getCollisionObject());
    if (body == nullptr) return {};
    return from_bullet(
        body->getVelocityInLocalPoint(to_bullet(world_point) - body->getCenterOfMassPosition()));
  }

 private:
  const btCollisionObjectWrapper& wrap_;
  Pose world_from_geometry_;
  std::optional<Field> analytic_;
  Participant participant_;
};

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

/// The two sides with their roles settled.
struct ModelAlgorithm::PosedPair {
  PosedPair(const btCollisionObjectWrapper& a_wrap, const btCollisionObjectWrapper& b_wrap)
      : a(a_wrap),
        b(b_wrap),
        // One of the two is a model, or the algorithm would not have been made.
        shell_is_a(*choose_shell(a.participant(), b.participant(), ShellChoice::kAutomatic) ==
                   PairBody::kA) {}

  const Side& shell_side() const { return shell_is_a ? a : b; }
  const Side& field_side() const { return shell_is_a ? b : a; }
  const PointShell& shell() const { return *shell_side().participant().shell; }
  const Field& field() const { return *field_side().participant().field; }
  Pose field_from_shell() const {
    return field_side().world_from_geometry().inverse() * shell_side().world_from_geometry();
  }

  /// Makes the other body the shell where it may lie inside the one that is. For pairs without
  /// contact.
  bool swap_roles_if_enclosed() {
    if (!is_enclosed(field_side().participant(), shell_side().participant(),
                     field_from_shell().inverse())) {
      return false;
    }
    shell_is_a = !shell_is_a;
    return true;
  }

  WorldContact to_world(const Contact& contact) const {
    const Pose& world_from_shell = shell_side().world_from_geometry();
    const Vec3 on_shell = world_from_shell.transform_point(static_cast<Vec3>(contact.point));
    const Vec3 out_of_field = world_from_shell.rotate(static_cast<Vec3>(contact.normal));
    const auto depth = static_cast<double>(contact.depth);
    const Vec3 on_field = on_shell + depth * out_of_field;
    return {contact.id, shell_is_a ? on_shell : on_field, shell_is_a ? on_field : on_shell,
            shell_is_a ? out_of_field : -out_of_field, depth};
  }

  Side a;
  Side b;
  bool shell_is_a;
};

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
  NarrowPhaseTimings* timings = simulates ? settings_.timings : nullptr;
  double margin = 0.0;
  std::span<const Contact> found;
  const auto ask = [&] {
    margin = simulates ? rest_margin(pair)
                       : static_cast<double>(result->m_closestPointDistanceThreshold);
    found = find_contacts(pair.field(), pair.shell(), pair.field_from_shell(),
                          {.margin = static_cast<float>(margin)}, scratch_);
  };
  {
    const Stopwatch watch(timings, &NarrowPhaseTimings::query);
    ask();
    if (found.empty() && pair.swap_roles_if_enclosed()) ask();
  }
  contacts_.assign(found.begin(), found.end());
  if (!simulates) {
    report(pair, *result);
    return;
  }
  {
    const Stopwatch watch(timings, &NarrowPhaseTimings::reduction);
    drop_fast_approaches(pair, margin, static_cast<double>(info.m_timeStep));
  }
  if (shell_was_a_ != pair.shell_is_a) {
    // Ids and segments now are another body's: nothing of the last step carries over.
    release_manifolds();
    shell_was_a_ = pair.shell_is_a;
  }
  if (contacts_.empty()) {
    // Pairs whose bounds overlap outnumber those in contact: they keep nothing for the solver to
    // look through.
    release_manifolds();
  } else if (settings_.mode == ContactMode::kRegular) {
    fill_regular(pair);
  } else {
    fill_segmented(pair, pair.shell().tree());
  }
}

/// Keeps penetrating points, and of those within the margin the slow ones.
void ModelAlgorithm::drop_fast_approaches(const PosedPair& pair, double margin, double time_step) {
  std::erase_if(contacts_, [&](const Contact& contact) {
    if (contact.depth > 0.0f) return false;
    const WorldContact world = pair.to_world(contact);
    const Vec3 velocity = pair.a.velocity_at(world.point_a) - pair.b.velocity_at(world.point_b);
    const double approach = -dot(velocity, world.normal);
    return approach * time_step > margin;
  });
}

double ModelAlgorithm::rest_margin(const PosedPair& pair) const {
  return settings_.margin >= 0.0 ? settings_.margin : default_rest_margin(pair.shell());
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

void ModelAlgorithm::fill_regular(const PosedPair& pair) {
  ManifoldPoints chosen;
  {
    const Stopwatch watch(settings_.timings, &NarrowPhaseTimings::reduction);
    chosen = select_manifold(contacts_);
  }
  const Stopwatch watch(settings_.timings, &NarrowPhaseTimings::manifold);
  std::array<WorldContact, kManifoldSize> world;
  for (std::size_t i = 0; i < chosen.count; ++i) {
    world[i] = pair.to_world(contacts_[chosen.indices[i]]);
  }
  if (active_.empty()) active_.push_back({0, take_manifold(pair)});
  fill_manifold(*active_[0].manifold, std::span(world).first(chosen.count), pair.a.wrap(),
                pair.b.wrap());
}

void ModelAlgorithm::fill_segmented(const PosedPair& pair, const PointSphereTree& tree) {
  const int level =
      settings_.level > 0 ? std::min(settings_.level, PointSphereTree::kMaxLevel) : kDefaultLevel;
  {
    const Stopwatch watch(settings_.timings, &NarrowPhaseTimings::reduction);
    select_deepest_per_segment(contacts_, tree, level, deepest_);
  }
  const Stopwatch watch(settings_.timings, &NarrowPhaseTimings::manifold);
  // Both lists ascend by segment: manifolds of segments that lost their contacts are emptied first,
  // so that segments which gained some can have them.
  auto old = active_.begin();
  next_.clear();
  for (const std::uint32_t index : deepest_) {
    const std::uint32_t segment = tree.segment(contacts_[index].id, level);
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
    const WorldContact world = pair.to_world(contacts_[deepest_[i]]);
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
