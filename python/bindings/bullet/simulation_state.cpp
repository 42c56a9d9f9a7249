#include "bullet/simulation_state.h"

#include <algorithm>
#include <limits>
#include <map>

#include "bullet/simulation_parts.h"
#include "bullet/state_rows.h"

namespace voxshell::python {
namespace {

using ManifoldState = SimulationState::ManifoldState;

/// A point of the state that no new point has taken over yet.
struct Saved {
  const btManifoldPoint* point;
  bool taken = false;
};

/// Transfers the state's points to those of a new manifold. Points of shells are matched by id,
/// Bullet's own points, which have no id, by position.
void carry_over(btManifoldPoint& point, std::vector<Saved>& saved, double threshold) {
  Saved* best = nullptr;
  double nearest = std::numeric_limits<double>::infinity();
  for (Saved& candidate : saved) {
    if (candidate.taken || candidate.point->m_index0 != point.m_index0 ||
        candidate.point->m_index1 != point.m_index1) {
      continue;
    }
    const double gap = candidate.point->m_localPointA.distance(point.m_localPointA);
    if (gap < nearest && gap <= threshold) {
      best = &candidate;
      nearest = gap;
    }
  }
  if (best == nullptr) return;
  best->taken = true;
  point = *best->point;
}

/// True if the state has exactly one manifold of these bodies.
bool is_whole(const SimulationState& state, const btPersistentManifold& manifold) {
  return std::ranges::count_if(state.manifolds, [&](const ManifoldState& saved) {
           return saved.body_0 == manifold.getBody0()->getUserIndex() &&
                  saved.body_1 == manifold.getBody1()->getUserIndex();
         }) == 1;
}

}  // namespace

std::shared_ptr<const SimulationState> Simulation::save() {
  auto state = std::make_shared<SimulationState>();
  state->gravity = settings_.gravity;
  state->contacts = compute_contacts();
  world_->renew_carried_contacts();
  for (const auto& [number, body] : bodies_) {
    const btRigidBody& rigid_body = body->rigid_body;
    state->bodies.push_back(
        {number, rigid_body.getWorldTransform(), rigid_body.getInterpolationWorldTransform(),
         rigid_body.getLinearVelocity(), rigid_body.getAngularVelocity(),
         rigid_body.getInterpolationLinearVelocity(), rigid_body.getInterpolationAngularVelocity(),
         rigid_body.getTotalForce(), rigid_body.getTotalTorque(), rigid_body.getActivationState(),
         rigid_body.getDeactivationTime(), body->material});
  }
  for (const auto& [number, joint] : joints_) {
    state->joints.push_back({number, joint->motor, joint->last_step()});
  }
  state->apart = apart_;
  for (int m = 0; m < dispatcher_->getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *dispatcher_->getManifoldByIndexInternal(m);
    if (manifold.getNumContacts() == 0) continue;
    ManifoldState saved{
        manifold.getBody0()->getUserIndex(), manifold.getBody1()->getUserIndex(), {}};
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
      saved.points.push_back(manifold.getContactPoint(i));
    }
    state->manifolds.push_back(std::move(saved));
  }
  state->step_count = step_count_;
  rebuild(*state);
  return state;
}

void Simulation::restore(const SimulationState& state) {
  const auto are_those_of = [](const auto& parts, const auto& saved) {
    return std::ranges::equal(parts, saved, {},
                              &std::ranges::range_value_t<decltype(parts)>::number,
                              &std::ranges::range_value_t<decltype(saved)>::number);
  };
  if (!are_those_of(bodies_, state.bodies) || !are_those_of(joints_, state.joints)) {
    throw std::out_of_range("the world has other bodies or joints than the state");
  }
  rebuild(state);
  step_count_ = state.step_count;
}

std::shared_ptr<const SimulationState> Simulation::adopt(const SimulationState& state) const {
  return renumber(state, bodies_.numbers(), joints_.numbers());
}

/// Bullet's caches (bounds, pairs, algorithms, manifolds) depend on the whole past. A new world has
/// only what the state contains.
void Simulation::rebuild(const SimulationState& state) {
  drop_world();
  settings_.gravity = state.gravity;
  make_world();
  apart_ = state.apart;
  for (const SimulationState::BodyState& saved : state.bodies) {
    Body& body = bodies_[saved.number];
    btRigidBody& rigid_body = body.rigid_body;
    body.material = saved.material;
    set_material(saved.number, saved.material);
    rigid_body.setCenterOfMassTransform(saved.world_from_body);
    rigid_body.setInterpolationWorldTransform(saved.interpolated_world_from_body);
    rigid_body.setLinearVelocity(saved.linear_velocity);
    rigid_body.setAngularVelocity(saved.angular_velocity);
    rigid_body.setInterpolationLinearVelocity(saved.interpolated_linear_velocity);
    rigid_body.setInterpolationAngularVelocity(saved.interpolated_angular_velocity);
    // Bodies stay awake until contacts are found: Bullet skips sleeping pairs.
    rigid_body.forceActivationState(ACTIVE_TAG);
    enter(body);
    rigid_body.clearForces();
  }
  for (const SimulationState::JointState& saved : state.joints) {
    Joint& joint = joints_[saved.number];
    joint.motor = saved.motor;
    joint.set_last_step(saved.last_step);
    world_->addConstraint(&joint.constraint());
  }
  world_->getDispatchInfo().m_timeStep = settings_.time_step;
  // Contacts are found as in a step: without gravity, nothing would count as resting.
  world_->applyGravity();
  world_->performDiscreteCollisionDetection();
  warm_up(state);
  for (const SimulationState::BodyState& saved : state.bodies) {
    btRigidBody& rigid_body = bodies_[saved.number].rigid_body;
    rigid_body.clearForces();
    rigid_body.applyCentralForce(saved.force);
    rigid_body.applyTorque(saved.torque);
    rigid_body.forceActivationState(saved.activation);
    rigid_body.setDeactivationTime(saved.still_for);
  }
  restored_contacts_ = state.contacts;
}

/// Gives the manifolds the impulses with which the next step begins.
void Simulation::warm_up(const SimulationState& state) {
  std::map<std::pair<int, int>, std::vector<Saved>> saved;
  for (const ManifoldState& manifold : state.manifolds) {
    for (const btManifoldPoint& point : manifold.points) {
      saved[{manifold.body_0, manifold.body_1}].push_back({&point});
    }
  }
  for (int m = 0; m < dispatcher_->getNumManifolds(); ++m) {
    btPersistentManifold& manifold = *dispatcher_->getManifoldByIndexInternal(m);
    const auto found =
        saved.find({manifold.getBody0()->getUserIndex(), manifold.getBody1()->getUserIndex()});
    if (found == saved.end()) continue;
    const double threshold = manifold.getContactBreakingThreshold();
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
      carry_over(manifold.getContactPoint(i), found->second, threshold);
    }
    // Bullet's algorithms find one point per step and accumulate points.
    const bool collects = threshold < BT_LARGE_FLOAT && is_whole(state, manifold);
    for (Saved& point : found->second) {
      if (!collects || point.taken || manifold.getNumContacts() >= MANIFOLD_CACHE_SIZE) continue;
      manifold.addManifoldPoint(*point.point);
      point.taken = true;
    }
  }
}

}  // namespace voxshell::python
