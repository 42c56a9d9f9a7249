#include "bullet/simulation.h"

#include <chrono>

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletDynamics/ConstraintSolver/btNNCGConstraintSolver.h>
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <BulletDynamics/MLCPSolvers/btSolveProjectedGaussSeidel.h>

#include "voxshell/bullet/convert.h"
#include "voxshell/bullet/model_shape.h"

namespace voxshell::python {
using bullet::from_bullet;
using bullet::to_bullet;

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

struct Simulation::Body {
  Pose body_from_geometry;
  BulletShape shape;
  btRigidBody rigid_body;

  Body(const BodySettings& settings, const bullet::BodyFrame& frame)
      : body_from_geometry(frame.model_from_body.inverse()),
        shape(settings.geometry, body_from_geometry),
        rigid_body(settings.mass_properties.mass, nullptr, shape.get(),
                   to_bullet(frame.principal_inertia)) {}
};

/// Bullet's dispatcher, which also says how long the narrow phase took.
class Simulation::TimedDispatcher : public btCollisionDispatcher {
 public:
  using btCollisionDispatcher::btCollisionDispatcher;

  void dispatchAllCollisionPairs(btOverlappingPairCache* pairs, const btDispatcherInfo& info,
                                 btDispatcher* dispatcher) override {
    const auto start = Clock::now();
    btCollisionDispatcher::dispatchAllCollisionPairs(pairs, info, dispatcher);
    seconds = seconds_since(start);
  }

  double seconds = 0.0;  ///< of the last dispatch
};

Simulation::Simulation(const SimulationSettings& settings) : settings_(settings) {
  settings_.contact.timings = &model_timings_;
  configuration_ = std::make_unique<bullet::CollisionConfiguration>(settings_.contact);
  dispatcher_ = std::make_unique<TimedDispatcher>(configuration_.get());
  btGImpactCollisionAlgorithm::registerAlgorithm(dispatcher_.get());
  broadphase_ = std::make_unique<btDbvtBroadphase>();
  make_solver();
  world_ = std::make_unique<btDiscreteDynamicsWorld>(dispatcher_.get(), broadphase_.get(),
                                                     solver_.get(), configuration_.get());
  world_->setGravity(to_bullet(settings_.gravity));
  world_->getSolverInfo().m_numIterations = settings_.iterations;
  world_->getSolverInfo().m_splitImpulse = 1;
  world_->getSolverInfo().m_splitImpulsePenetrationThreshold = settings_.split_impulse_threshold;
  world_->getDispatchInfo().m_deterministicOverlappingPairs = true;
}

void Simulation::make_solver() {
  switch (settings_.solver) {
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

Simulation::~Simulation() {
  for (const auto& body : bodies_) world_->removeRigidBody(&body->rigid_body);
}

std::size_t Simulation::add_body(const BodySettings& settings) {
  const bool is_dynamic = settings.mass_properties.mass > 0.0;
  const bullet::BodyFrame frame =
      is_dynamic ? bullet::compute_principal_frame(settings.mass_properties) : bullet::BodyFrame{};
  bodies_.push_back(std::make_unique<Body>(settings, frame));
  const std::size_t number = bodies_.size() - 1;
  btRigidBody& body = bodies_.back()->rigid_body;
  body.setUserIndex(static_cast<int>(number));
  body.setFriction(settings.friction);
  body.setRestitution(settings.restitution);
  if (!settings_.sleeping) body.setActivationState(DISABLE_DEACTIVATION);
  set_world_from_geometry(number, settings.world_from_geometry);
  world_->addRigidBody(&body);
  return number;
}

void Simulation::step() {
  model_timings_ = {};
  const auto start = Clock::now();
  world_->stepSimulation(settings_.time_step, 0);
  timings_.push_back({seconds_since(start), dispatcher_->seconds, model_timings_.query,
                      model_timings_.reduction, model_timings_.manifold});
  if (timings_.size() > kMostTimings) timings_.pop_front();
}

std::vector<SimulationContact> Simulation::compute_contacts() const {
  std::vector<SimulationContact> contacts;
  for (int m = 0; m < dispatcher_->getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *dispatcher_->getManifoldByIndexInternal(m);
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
      const btManifoldPoint& point = manifold.getContactPoint(i);
      contacts.push_back(
          {manifold.getBody0()->getUserIndex(), manifold.getBody1()->getUserIndex(), point.m_index0,
           from_bullet(point.getPositionWorldOnA()), from_bullet(point.getPositionWorldOnB()),
           from_bullet(point.m_normalWorldOnB), -point.getDistance(), point.getAppliedImpulse()});
    }
  }
  return contacts;
}

Pose Simulation::world_from_geometry(std::size_t body) const {
  return from_bullet(bodies_[body]->rigid_body.getWorldTransform()) *
         bodies_[body]->body_from_geometry;
}

void Simulation::set_world_from_geometry(std::size_t body, const Pose& pose) {
  btRigidBody& rigid_body = bodies_[body]->rigid_body;
  const btTransform world_from_body = to_bullet(pose * bodies_[body]->body_from_geometry.inverse());
  rigid_body.setCenterOfMassTransform(world_from_body);
  rigid_body.activate();
  if (rigid_body.isInWorld()) world_->updateSingleAabb(&rigid_body);
}

Vec3 Simulation::linear_velocity(std::size_t body) const {
  return from_bullet(bodies_[body]->rigid_body.getLinearVelocity());
}

Vec3 Simulation::angular_velocity(std::size_t body) const {
  return from_bullet(bodies_[body]->rigid_body.getAngularVelocity());
}

void Simulation::set_linear_velocity(std::size_t body, const Vec3& velocity) {
  bodies_[body]->rigid_body.setLinearVelocity(to_bullet(velocity));
  bodies_[body]->rigid_body.activate();
}

void Simulation::set_angular_velocity(std::size_t body, const Vec3& velocity) {
  bodies_[body]->rigid_body.setAngularVelocity(to_bullet(velocity));
  bodies_[body]->rigid_body.activate();
}

bool Simulation::is_asleep(std::size_t body) const { return !bodies_[body]->rigid_body.isActive(); }

}  // namespace voxshell::python
