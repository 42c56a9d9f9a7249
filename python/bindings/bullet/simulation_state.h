#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "bullet/simulation.h"

namespace voxshell::python {

/// Everything in a simulation that changes, except the existence of bodies and joints.
struct SimulationState {
  struct BodyState {
    std::size_t number;
    btTransform world_from_body;
    btTransform interpolated_world_from_body;
    btVector3 linear_velocity;
    btVector3 angular_velocity;
    btVector3 interpolated_linear_velocity;
    btVector3 interpolated_angular_velocity;
    btVector3 force;
    btVector3 torque;
    int activation;
    double still_for;  ///< seconds
    BodyMaterial material;
  };
  struct JointState {
    std::size_t number;
    Motor motor;
    Joint::LastStep last_step;
  };
  struct ManifoldState {
    int body_0;
    int body_1;
    std::vector<btManifoldPoint> points;
  };

  Vec3 gravity;  ///< m/s2
  std::vector<BodyState> bodies;
  std::vector<JointState> joints;
  std::set<std::pair<int, int>> apart;
  std::vector<ManifoldState> manifolds;  ///< with the impulses that the next step begins with
  std::vector<SimulationContact> contacts;
  std::uint64_t step_count = 0;
};

}  // namespace voxshell::python
