#pragma once

#include <algorithm>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "support/world.h"
#include "voxshell/bullet/model_shape.h"

namespace voxshell::bullet::test_support {

/// Kinetic and potential energy, J, under gravity of 9.81 m/s2 downwards from z = 0.
inline double energy_of(const btRigidBody& body) {
  const double mass = 1.0 / static_cast<double>(body.getInvMass());
  const btVector3 spin = body.getInvInertiaTensorWorld().inverse() * body.getAngularVelocity();
  return mass * 9.81 * height(body) +
         0.5 * mass * static_cast<double>(body.getLinearVelocity().length2()) +
         0.5 * static_cast<double>(spin.dot(body.getAngularVelocity()));
}

inline btVector3 place_of(const btRigidBody& body) { return body.getWorldTransform().getOrigin(); }

/// rad/s.
inline double turn_of(const btRigidBody& body) {
  return static_cast<double>(body.getAngularVelocity().length());
}

/// The deepest penetration among the world's contact points, meters; 0 without any.
template <class World>
double deepest_of(World& world) {
  double deepest = 0.0;
  for (const btManifoldPoint* point : world.points()) {
    deepest = std::max(deepest, -static_cast<double>(point->getDistance()));
  }
  return deepest;
}

/// A body whose frame lies at the model's center of mass, along its principal axes.
template <class World>
btRigidBody& add_at_principal_frame(World& world, const std::shared_ptr<const Model>& model,
                                    double mass, const Pose& world_from_body) {
  const BodyFrame frame = compute_principal_frame(model->solid_mass_properties());
  auto& shape = world.template make<ModelShape>(model, frame.model_from_body.inverse());
  return world.add(shape, mass, world_from_body);
}

/// Lets a body fall onto a ground whose top is at z = 0: it neither gains energy nor goes through.
template <class World, class Body>
void expect_true_landing(World& world, const Body& body, int steps) {
  const double energy = energy_of(body);
  double most_energy = 0.0;
  double deepest = 0.0;
  for (int i = 0; i < steps; ++i) {
    world.step(1);
    ASSERT_GT(place_of(body).z(), 0) << "through the ground in step " << i;
    most_energy = std::max(most_energy, energy_of(body));
    deepest = std::max(deepest, deepest_of(world));
  }
  EXPECT_LT(most_energy, 1.001 * energy);
  EXPECT_LT(deepest, 0.01);  // a voxel of the coarsest model
}

/// The least height of a body in so many steps at 60 Hz, as long as it is over a ground of which
/// half a side is `edge`. Meters.
template <class World, class Body>
double lowest_over(World& world, const Body& body, int steps, double edge) {
  double lowest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < steps; ++i) {
    world.step(1, 1.0 / 60.0);
    const btVector3 place = place_of(body);
    if (std::max(btFabs(place.x()), btFabs(place.y())) > scalar(edge)) break;
    lowest = std::min(lowest, static_cast<double>(place.z()));
  }
  return lowest;
}

/// rad/s. In single precision, four points leave a body rocking.
inline constexpr double kCalm = kIsDouble ? 0.02 : 0.4;

/// How a body lies, over 2 s.
struct Lying {
  double fastest_turn = 0.0;  ///< rad/s
  double drift = 0.0;         ///< meters

  bool is_calm(double calm = kCalm) const { return fastest_turn < calm && drift < 1e-3; }
};

/// The same for 15 s, and how the body lies after them.
template <class World, class Body>
Lying expect_true_landing_and_lie(World& world, const Body& body) {
  expect_true_landing(world, body, 3000);
  EXPECT_FALSE(world.points().empty());
  Lying lying;
  const btVector3 start = place_of(body);
  for (int i = 0; i < 400; ++i) {
    world.step(1);
    lying.fastest_turn = std::max(lying.fastest_turn, turn_of(body));
  }
  lying.drift = static_cast<double>((place_of(body) - start).length());
  return lying;
}

/// The same, after which it is to lie still, turning at less than `calm`, rad/s.
template <class World, class Body>
void expect_calm_landing(World& world, const Body& body, double calm = kCalm) {
  const Lying lying = expect_true_landing_and_lie(world, body);
  EXPECT_TRUE(lying.is_calm(calm))
      << "turns at " << lying.fastest_turn << " rad/s, has moved by " << lying.drift << " m";
}

}  // namespace voxshell::bullet::test_support
