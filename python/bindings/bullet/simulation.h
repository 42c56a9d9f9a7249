#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <vector>

#include <BulletDynamics/MLCPSolvers/btMLCPSolverInterface.h>
#include <btBulletDynamicsCommon.h>

#include "bullet/shapes.h"
#include "voxshell/bullet/collision_configuration.h"
#include "voxshell/mass_properties.h"

namespace voxshell::python {

/// Bullet's solvers of constraints.
enum class ConstraintSolver { kSequentialImpulse, kNncg, kDantzig, kProjectedGaussSeidel };

struct SimulationSettings {
  Vec3 gravity{0.0, 0.0, -9.81};   ///< m/s2
  double time_step = 1.0 / 200.0;  ///< seconds
  bool sleeping = true;            ///< whether resting bodies are put to sleep
  /// Penetrations below minus this are resolved by split impulses, without adding velocity. At 0,
  /// all of them: impacts then rebound with the energy that their restitution says, and no more.
  /// Bullet's own default is -0.04.
  double split_impulse_threshold = 0.0;
  ConstraintSolver solver = ConstraintSolver::kSequentialImpulse;
  int iterations = 10;  ///< of the solver; Dantzig's has none
  bullet::ContactSettings contact;
};

struct BodySettings {
  Geometry geometry;
  MassProperties mass_properties;  ///< in the geometry's frame; mass 0: static
  Pose world_from_geometry;
  double friction = 0.5;
  double restitution = 0.0;
};

/// Seconds of one step.
struct StepTimings {
  double step;          ///< all of it
  double narrow_phase;  ///< dispatching all pairs: every shape's algorithms
  double query;         ///< the parts of models: finding contacts,
  double reduction;     ///< choosing points,
  double manifold;      ///< filling manifolds
};

/// A contact point after a step. Metres, world frame; normal on b, pointing towards a.
struct SimulationContact {
  int body_a;
  int body_b;
  int id;  ///< of the shell's point; Bullet's triangle or child index for other shapes
  Vec3 point_a;
  Vec3 point_b;
  Vec3 normal;
  double depth;
  double impulse;  ///< normal impulse of the last step, N s
};

/// A world of stock Bullet, float64, with voxshell's collision configuration.
class Simulation {
 public:
  explicit Simulation(const SimulationSettings& settings);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Adds a body and returns its number.
  std::size_t add_body(const BodySettings& settings);
  std::size_t body_count() const { return bodies_.size(); }

  void step();
  /// Of the steps since the start or clear_timings(), the last kMostTimings at most.
  const std::deque<StepTimings>& timings() const { return timings_; }
  void clear_timings() { timings_.clear(); }
  static constexpr std::size_t kMostTimings = 100'000;
  std::vector<SimulationContact> compute_contacts() const;

  Pose world_from_geometry(std::size_t body) const;
  void set_world_from_geometry(std::size_t body, const Pose& pose);
  /// Of the centre of mass, m/s, and rad/s; world frame.
  Vec3 linear_velocity(std::size_t body) const;
  Vec3 angular_velocity(std::size_t body) const;
  void set_linear_velocity(std::size_t body, const Vec3& velocity);
  void set_angular_velocity(std::size_t body, const Vec3& velocity);
  bool is_asleep(std::size_t body) const;

 private:
  struct Body;
  class TimedDispatcher;

  void make_solver();

  SimulationSettings settings_;
  bullet::NarrowPhaseTimings model_timings_;
  std::unique_ptr<bullet::CollisionConfiguration> configuration_;
  std::unique_ptr<TimedDispatcher> dispatcher_;
  std::unique_ptr<btBroadphaseInterface> broadphase_;
  std::unique_ptr<btMLCPSolverInterface> lcp_;  ///< of solvers that solve all constraints as one
  std::unique_ptr<btConstraintSolver> solver_;
  std::vector<std::unique_ptr<Body>> bodies_;
  std::unique_ptr<btDiscreteDynamicsWorld> world_;
  std::deque<StepTimings> timings_;
};

}  // namespace voxshell::python
