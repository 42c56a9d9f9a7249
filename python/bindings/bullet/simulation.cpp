#include "bullet/simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletDynamics/ConstraintSolver/btNNCGConstraintSolver.h>
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <BulletDynamics/MLCPSolvers/btSolveProjectedGaussSeidel.h>

#include "bullet/simulation_parts.h"
#include "voxshell/bullet/convert.h"
#include "voxshell/bullet/model_shape.h"

namespace voxshell::python {
using bullet::from_bullet;
using bullet::to_bullet;

namespace {

using Clock = std::chrono::steady_clock;

constexpr double kMostReboundThreshold = 0.2;  // m/s, Bullet's default

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::pair<int, int> ascending(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

/// The frame of a Bullet body in its geometry. Shapes that are aligned with their axes keep these
/// if they are principal axes.
bullet::BodyFrame choose_frame(const BodySettings& settings) {
  if (settings.motion != Motion::kDynamic) return {};
  const MassProperties& matter = settings.mass_properties;
  const Vec3 moments{matter.inertia.row_x.x, matter.inertia.row_y.y, matter.inertia.row_z.z};
  constexpr double kNothing = 1e-9;
  const double most_off =
      std::max({std::abs(matter.inertia.row_x.y), std::abs(matter.inertia.row_x.z),
                std::abs(matter.inertia.row_y.z)});
  if (!is_axis_bound(settings.geometry) ||
      most_off > kNothing * (moments.x + moments.y + moments.z)) {
    return bullet::compute_principal_frame(matter);
  }
  const bool is_centered = length(matter.center_of_mass) < kNothing;
  return {{{}, is_centered ? Vec3{} : matter.center_of_mass}, moments};
}

}  // namespace

Simulation::Body::Body(const BodySettings& settings, const bullet::BodyFrame& frame)
    : body_from_geometry(frame.model_from_body.inverse()),
      shape(settings.geometry, body_from_geometry),
      rigid_body(settings.motion == Motion::kDynamic ? settings.mass_properties.mass : 0.0, nullptr,
                 shape.get(), to_bullet(frame.principal_inertia)),
      motion(settings.motion) {}

void Simulation::TimedDispatcher::dispatchAllCollisionPairs(btOverlappingPairCache* pairs,
                                                            const btDispatcherInfo& info,
                                                            btDispatcher* dispatcher) {
  const auto start = Clock::now();
  bullet::ParallelDispatcher::dispatchAllCollisionPairs(pairs, info, dispatcher);
  seconds = seconds_since(start);
}

Simulation::Simulation(const SimulationSettings& settings)
    : settings_(settings),
      filter_(std::make_unique<Filter>(*this)),
      anchor_(0.0, nullptr, nullptr),
      bodies_("body"),
      joints_("joint") {
  settings_.contact.timings = &model_timings_;
  make_world();
}

Simulation::~Simulation() { drop_world(); }

void Simulation::make_world() {
  configuration_ = std::make_unique<bullet::CollisionConfiguration>(settings_.contact);
  // With one point per step, Bullet's own boxes sink into Bullet's planes at 60 Hz.
  configuration_->setPlaneConvexMultipointIterations();
  dispatcher_ = std::make_unique<TimedDispatcher>(configuration_.get(), settings_.threads);
  btGImpactCollisionAlgorithm::registerAlgorithm(dispatcher_.get());
  broadphase_ = std::make_unique<btDbvtBroadphase>();
  broadphase_->getOverlappingPairCache()->setOverlapFilterCallback(filter_.get());
  make_solver();
  world_ = std::make_unique<World>(dispatcher_.get(), broadphase_.get(), solver_.get(),
                                   configuration_.get());
  world_->setGravity(to_bullet(settings_.gravity));
  world_->getSolverInfo().m_numIterations = settings_.iterations;
  if (settings_.effort == bullet::SolverEffort::kAsNeeded) {
    world_->getSolverInfo().m_minimumSolverBatchSize = 1;
  }
  world_->getSolverInfo().m_splitImpulse = 1;
  world_->getSolverInfo().m_splitImpulsePenetrationThreshold = settings_.split_impulse_threshold;
  if (settings_.two_friction_directions) {
    world_->getSolverInfo().m_solverMode |=
        SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
  }
  world_->getDispatchInfo().m_deterministicOverlappingPairs = true;
}

/// Constraints are removed before their bodies, and bodies before the broad phase.
void Simulation::drop_world() {
  for (const auto& [number, joint] : joints_) world_->removeConstraint(&joint->constraint());
  for (const auto& [number, body] : bodies_) world_->removeRigidBody(&body->rigid_body);
  world_.reset();
  solver_.reset();
  lcp_.reset();
  broadphase_.reset();
  dispatcher_.reset();
  configuration_.reset();
}

void Simulation::make_solver() {
  switch (settings_.solver) {
    case ConstraintSolver::kCoulomb:
      solver_ = std::make_unique<bullet::CoulombSolver>(settings_.effort);
      return;
    case ConstraintSolver::kSequentialImpulse:
      solver_ = std::make_unique<btSequentialImpulseConstraintSolver>();
      return;
    case ConstraintSolver::kNncg:
      solver_ = std::make_unique<btNNCGConstraintSolver>();
      return;
    case ConstraintSolver::kDantzig:
      lcp_ = std::make_unique<btDantzigSolver>();
      break;
    case ConstraintSolver::kProjectedGaussSeidel:
      lcp_ = std::make_unique<btSolveProjectedGaussSeidel>();
      break;
  }
  solver_ = std::make_unique<btMLCPSolver>(lcp_.get());
}

std::size_t Simulation::add_body(const BodySettings& settings) {
  const std::size_t number = bodies_.add(std::make_unique<Body>(settings, choose_frame(settings)));
  Body& body = bodies_[number];
  body.rigid_body.setUserIndex(static_cast<int>(number));
  if (body.motion == Motion::kKinematic) {
    const int flags = body.rigid_body.getCollisionFlags() & ~btCollisionObject::CF_STATIC_OBJECT;
    body.rigid_body.setCollisionFlags(flags | btCollisionObject::CF_KINEMATIC_OBJECT);
  }
  if (!settings_.sleeping || body.motion == Motion::kKinematic) {
    body.rigid_body.setActivationState(DISABLE_DEACTIVATION);
  }
  set_world_from_geometry(number, settings.world_from_geometry);
  body.rigid_body.setInterpolationWorldTransform(body.rigid_body.getWorldTransform());
  set_material(number, settings.material);
  enter(body);
  return number;
}

void Simulation::enter(Body& body) { world_->addRigidBody(&body.rigid_body); }

void Simulation::remove_body(std::size_t body) {
  Body& removed = bodies_[body];
  const int number = static_cast<int>(body);
  for (const std::size_t joint : joints_.numbers()) {
    const JointSettings& settings = joints_[joint].settings();
    if (settings.parent == number || settings.child == number) remove_joint(joint);
  }
  wake_touching(body);
  world_->removeRigidBody(&removed.rigid_body);
  removed.material.surface_velocity = {};
  move_surface(removed);
  bodies_.remove(body);
  if (restored_contacts_) {
    std::erase_if(*restored_contacts_, [&](const SimulationContact& contact) {
      return contact.body_a == number || contact.body_b == number;
    });
  }
  std::erase_if(apart_,
                [&](const auto& pair) { return pair.first == number || pair.second == number; });
}

/// What lies on a body, carries it, or is joined to it, must notice that it changes.
void Simulation::wake_touching(std::size_t body) {
  const int number = static_cast<int>(body);
  for (const auto& [joint_number, joint] : joints_) {
    const JointSettings& settings = joint->settings();
    if (settings.parent == number) body_or_world(settings.child).activate();
    if (settings.child == number) body_or_world(settings.parent).activate();
  }
  for (int m = 0; m < dispatcher_->getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *dispatcher_->getManifoldByIndexInternal(m);
    if (manifold.getBody0()->getUserIndex() == number) manifold.getBody1()->activate();
    if (manifold.getBody1()->getUserIndex() == number) manifold.getBody0()->activate();
  }
}

/// Lets the next step find the body's contacts as if it had none.
void Simulation::forget_contacts(std::size_t body) {
  btBroadphaseProxy* const proxy = bodies_[body].rigid_body.getBroadphaseProxy();
  if (proxy == nullptr) return;
  broadphase_->getOverlappingPairCache()->cleanProxyFromPairs(proxy, dispatcher_.get());
}

btRigidBody& Simulation::body_or_world(int number) {
  return number == JointSettings::kWorld ? anchor_
                                         : bodies_[static_cast<std::size_t>(number)].rigid_body;
}

std::size_t Simulation::add_joint(const JointSettings& settings) {
  const Pose parent_from_geometry =
      settings.parent == JointSettings::kWorld
          ? Pose{}
          : bodies_[static_cast<std::size_t>(settings.parent)].body_from_geometry;
  const Body& child = bodies_[static_cast<std::size_t>(settings.child)];
  const std::size_t number = joints_.add(std::make_unique<Joint>(
      settings, settings_.solver == ConstraintSolver::kCoulomb, body_or_world(settings.parent),
      body_or_world(settings.child), to_bullet(parent_from_geometry * settings.parent_from_joint),
      to_bullet(child.body_from_geometry * settings.child_from_joint)));
  world_->addConstraint(&joints_[number].constraint());
  update_pairs(child);
  body_or_world(settings.parent).activate();
  body_or_world(settings.child).activate();
  return number;
}

void Simulation::remove_joint(std::size_t joint) {
  const JointSettings settings = joints_[joint].settings();
  for (const auto& [number, other] : joints_) {
    if (other->motor.mode != MotorMode::kFollow) continue;
    if (other->motor.leader == static_cast<int>(joint)) other->motor = {};
  }
  world_->removeConstraint(&joints_[joint].constraint());
  joints_.remove(joint);
  update_pairs(bodies_[static_cast<std::size_t>(settings.child)]);
  body_or_world(settings.parent).activate();
  body_or_world(settings.child).activate();
}

void Simulation::set_motor(std::size_t joint, const Motor& motor) {
  Joint& driven = joints_[joint];
  if (motor.mode == MotorMode::kFollow) joints_.check(static_cast<std::size_t>(motor.leader));
  driven.motor = motor;
  body_or_world(driven.settings().parent).activate();
  body_or_world(driven.settings().child).activate();
}

bool Simulation::are_jointed_apart(int a, int b) const {
  return std::ranges::any_of(joints_, [&](const auto& entry) {
    const JointSettings& settings = entry.part->settings();
    return !settings.collides && ascending(settings.parent, settings.child) == ascending(a, b);
  });
}

bool Simulation::may_meet(const btCollisionObject& a, const btCollisionObject& b) const {
  if (a.isStaticOrKinematicObject() && b.isStaticOrKinematicObject()) return false;
  const int number_a = a.getUserIndex();
  const int number_b = b.getUserIndex();
  const BodyMaterial& of_a = bodies_[static_cast<std::size_t>(number_a)].material;
  const BodyMaterial& of_b = bodies_[static_cast<std::size_t>(number_b)].material;
  return (of_a.group & of_b.mask) != 0 && (of_b.group & of_a.mask) != 0 &&
         !apart_.contains(ascending(number_a, number_b)) && !are_jointed_apart(number_a, number_b);
}

/// Call it after a change of the groups that a body collides with.
void Simulation::update_pairs(const Body& body) {
  for (const auto& [number, other] : bodies_) {
    if (other.get() != &body) update_pair(body, *other);
  }
}

/// Call it after a change of whether two bodies may collide.
void Simulation::update_pair(const Body& body, const Body& other) {
  btBroadphaseProxy* const proxy =
      const_cast<btBroadphaseProxy*>(body.rigid_body.getBroadphaseHandle());
  btBroadphaseProxy* const met =
      const_cast<btBroadphaseProxy*>(other.rigid_body.getBroadphaseHandle());
  if (proxy == nullptr || met == nullptr) return;
  btOverlappingPairCache& pairs = *broadphase_->getOverlappingPairCache();
  if (!may_meet(body.rigid_body, other.rigid_body)) {
    pairs.removeOverlappingPair(proxy, met, dispatcher_.get());
  } else if (pairs.findPair(proxy, met) == nullptr &&
             TestAabbAgainstAabb2(proxy->m_aabbMin, proxy->m_aabbMax, met->m_aabbMin,
                                  met->m_aabbMax)) {
    pairs.addOverlappingPair(proxy, met);
  }
}

void Simulation::set_collision(std::size_t a, std::size_t b, bool collides) {
  const Body& first = bodies_[a];
  const Body& second = bodies_[b];
  wake(a);
  wake(b);
  const auto pair = ascending(static_cast<int>(a), static_cast<int>(b));
  if (collides) {
    apart_.erase(pair);
  } else {
    apart_.insert(pair);
  }
  update_pair(first, second);
}

void Simulation::set_gravity(const Vec3& gravity) {
  if (to_bullet(gravity) == to_bullet(settings_.gravity)) return;
  settings_.gravity = gravity;
  // Bullet changes only bodies that are awake.
  for (const auto& [number, body] : bodies_) body->rigid_body.activate();
  world_->setGravity(to_bullet(gravity));
}

void Simulation::step() {
  restored_contacts_.reset();
  for (const auto& [number, joint] : joints_) {
    const bool follows = joint->motor.mode == MotorMode::kFollow;
    joint->prepare_step(
        settings_.time_step,
        follows ? joints_[static_cast<std::size_t>(joint->motor.leader)].read() : JointReading{});
  }
  // Bullet's default is too much for small bodies. Gravity ends slower rebounds within the step.
  world_->getSolverInfo().m_restitutionVelocityThreshold =
      std::min(kMostReboundThreshold, 2.0 * world_->getGravity().length() * settings_.time_step);
  model_timings_ = {};
  const auto start = Clock::now();
  world_->stepSimulation(settings_.time_step, 0);
  ++step_count_;
  timings_.push_back({seconds_since(start), dispatcher_->seconds,
                      model_timings_.query + dispatcher_->parallel_seconds(),
                      model_timings_.reduction, model_timings_.manifold});
  if (timings_.size() > kMostTimings) timings_.pop_front();
  for (const auto& [number, joint] : joints_) joint->finish_step();
  note_spins();
  note_ways();
}

std::optional<std::size_t> Simulation::find_lost_body() const {
  const auto is_finite = [](const btVector3& v) { return std::isfinite(v.x() + v.y() + v.z()); };
  for (const auto& [number, body] : bodies_) {
    const btTransform& pose = body->rigid_body.getWorldTransform();
    const btMatrix3x3& basis = pose.getBasis();
    for (const btVector3& v :
         {basis[0], basis[1], basis[2], pose.getOrigin(), body->rigid_body.getLinearVelocity(),
          body->rigid_body.getAngularVelocity()}) {
      if (!is_finite(v)) return number;
    }
  }
  return std::nullopt;
}

void Simulation::note_ways() {
  for (const auto& [number, body] : bodies_) {
    if (body->moves_far || body->motion != Motion::kDynamic) continue;
    double way = body->rigid_body.getLinearVelocity().length() * settings_.time_step;
    if (body->rigid_body.getActivationState() == DISABLE_SIMULATION) {
      way = std::max(way, kWayThatBulletStops);  // Bullet has stopped it
    }
    if (!(way > kMostWay)) continue;
    body->moves_far = true;
    long_ways_.push_back({number, way});
  }
}

void Simulation::note_spins() {
  for (const auto& [number, body] : bodies_) {
    if (body->spins_fast) continue;
    const double turn = body->rigid_body.getAngularVelocity().length() * settings_.time_step;
    if (!(turn > kMostTurn)) continue;
    body->spins_fast = true;
    fast_spins_.push_back({number, turn});
  }
}

std::vector<SimulationContact> Simulation::compute_contacts() const {
  if (restored_contacts_) return *restored_contacts_;
  std::vector<SimulationContact> contacts;
  for (int m = 0; m < dispatcher_->getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *dispatcher_->getManifoldByIndexInternal(m);
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
      const btManifoldPoint& point = manifold.getContactPoint(i);
      const btVector3 friction = point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1 +
                                 point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2;
      contacts.push_back({manifold.getBody0()->getUserIndex(), manifold.getBody1()->getUserIndex(),
                          point.m_index0, from_bullet(point.getPositionWorldOnA()),
                          from_bullet(point.getPositionWorldOnB()),
                          from_bullet(point.m_normalWorldOnB), -point.getDistance(),
                          point.getAppliedImpulse(), from_bullet(friction)});
    }
  }
  return contacts;
}

Pose Simulation::world_from_geometry(std::size_t body) const {
  return from_bullet(bodies_[body].rigid_body.getWorldTransform()) *
         bodies_[body].body_from_geometry;
}

void Simulation::set_world_from_geometry(std::size_t body, const Pose& pose) {
  btRigidBody& rigid_body = bodies_[body].rigid_body;
  const btTransform world_from_body = to_bullet(pose * bodies_[body].body_from_geometry.inverse());
  const bool is_moved = !(rigid_body.getWorldTransform() == world_from_body);
  if (bodies_[body].motion == Motion::kKinematic) {
    // Keep the pose of the last step, which determines the velocity.
    rigid_body.setWorldTransform(world_from_body);
  } else {
    rigid_body.setCenterOfMassTransform(world_from_body);
  }
  rigid_body.activate();
  if (!rigid_body.isInWorld()) return;
  world_->updateSingleAabb(&rigid_body);
  if (!is_moved) return;
  wake_touching(body);
  if (bodies_[body].motion == Motion::kKinematic) return;
  forget_contacts(body);  // friction would pull a body at rest back to where it was held
}

void Simulation::place(std::size_t body, const Pose& world_from_geometry) {
  btRigidBody& rigid_body = bodies_[body].rigid_body;
  wake_touching(body);
  set_world_from_geometry(body, world_from_geometry);
  // Bullet keeps the pose of the last step for the velocity of a kinematic body.
  rigid_body.setInterpolationWorldTransform(rigid_body.getWorldTransform());
  rigid_body.setLinearVelocity({0, 0, 0});
  rigid_body.setAngularVelocity({0, 0, 0});
  forget_contacts(body);
}

Vec3 Simulation::linear_velocity(std::size_t body) const {
  return from_bullet(bodies_[body].rigid_body.getLinearVelocity());
}

Vec3 Simulation::angular_velocity(std::size_t body) const {
  return from_bullet(bodies_[body].rigid_body.getAngularVelocity());
}

void Simulation::set_linear_velocity(std::size_t body, const Vec3& velocity) {
  bodies_[body].rigid_body.setLinearVelocity(to_bullet(velocity));
  wake(body);
}

void Simulation::set_angular_velocity(std::size_t body, const Vec3& velocity) {
  bodies_[body].rigid_body.setAngularVelocity(to_bullet(velocity));
  wake(body);
}

bool Simulation::is_asleep(std::size_t body) const { return !bodies_[body].rigid_body.isActive(); }

void Simulation::wake(std::size_t body) { bodies_[body].rigid_body.activate(); }

void Simulation::apply_force(std::size_t body, const Vec3& force,
                             const std::optional<Vec3>& place) {
  btRigidBody& rigid_body = bodies_[body].rigid_body;
  rigid_body.applyCentralForce(to_bullet(force));
  if (place) {
    const btVector3 lever = to_bullet(*place) - rigid_body.getCenterOfMassPosition();
    rigid_body.applyTorque(lever.cross(to_bullet(force)));
  }
  wake(body);
}

void Simulation::apply_torque(std::size_t body, const Vec3& torque) {
  bodies_[body].rigid_body.applyTorque(to_bullet(torque));
  wake(body);
}

void Simulation::apply_impulse(std::size_t body, const Vec3& impulse,
                               const std::optional<Vec3>& place) {
  btRigidBody& rigid_body = bodies_[body].rigid_body;
  rigid_body.applyCentralImpulse(to_bullet(impulse));
  if (place) {
    const btVector3 lever = to_bullet(*place) - rigid_body.getCenterOfMassPosition();
    rigid_body.applyTorqueImpulse(lever.cross(to_bullet(impulse)));
  }
  wake(body);
}

void Simulation::apply_torque_impulse(std::size_t body, const Vec3& impulse) {
  bodies_[body].rigid_body.applyTorqueImpulse(to_bullet(impulse));
  wake(body);
}

const BodyMaterial& Simulation::material(std::size_t body) const { return bodies_[body].material; }

void Simulation::set_material(std::size_t number, const BodyMaterial& material) {
  Body& body = bodies_[number];
  body.rigid_body.setFriction(material.friction);
  body.rigid_body.setRollingFriction(material.rolling_friction);
  body.rigid_body.setSpinningFriction(material.spinning_friction);
  body.rigid_body.setRestitution(material.restitution);
  body.rigid_body.setDamping(material.linear_damping, material.angular_damping);
  const bool meets_others =
      material.group != body.material.group || material.mask != body.material.mask;
  const bool touches_otherwise = material.friction != body.material.friction ||
                                 material.rolling_friction != body.material.rolling_friction ||
                                 material.spinning_friction != body.material.spinning_friction ||
                                 material.restitution != body.material.restitution;
  body.material = material;
  move_surface(body);
  wake_touching(number);
  // Bullet's shapes keep the friction that their contacts began with.
  if (touches_otherwise) forget_contacts(number);
  if (meets_others) update_pairs(body);
  body.rigid_body.activate();
}

void Simulation::move_surface(const Body& body) {
  if (settings_.solver != ConstraintSolver::kCoulomb) return;
  const Vec3 velocity = body.body_from_geometry.rotate(body.material.surface_velocity);
  static_cast<bullet::CoulombSolver&>(*solver_).set_surface_velocity(body.rigid_body,
                                                                     to_bullet(velocity));
}

}  // namespace voxshell::python
