#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <BulletDynamics/MLCPSolvers/btMLCPSolverInterface.h>
#include <btBulletDynamicsCommon.h>

#include "bullet/joint.h"
#include "bullet/numbered.h"
#include "bullet/shapes.h"
#include "voxshell/bullet/collision_configuration.h"
#include "voxshell/bullet/coulomb_solver.h"
#include "voxshell/mass_properties.h"

namespace voxshell::python {

/// bullet::CoulombSolver, and Bullet's own constraint solvers.
enum class ConstraintSolver {
  kCoulomb,
  kSequentialImpulse,
  kNncg,
  kDantzig,
  kProjectedGaussSeidel,
};

struct SimulationSettings {
  Vec3 gravity{0.0, 0.0, -9.81};   ///< m/s2
  double time_step = 1.0 / 200.0;  ///< seconds
  bool sleeping = true;            ///< put resting bodies to sleep
  /// Split impulses resolve penetrations below minus this without adding velocity. At 0, this
  /// applies to all penetrations, so rebounds have exactly the energy that restitution gives.
  /// Bullet's own default is -0.04.
  double split_impulse_threshold = 0.0;
  ConstraintSolver solver = ConstraintSolver::kCoulomb;
  int iterations = 10;  ///< of the solver; not used by Dantzig's
  /// For the Coulomb solver: whether it continues if these iterations are not sufficient.
  bullet::SolverEffort effort = bullet::SolverEffort::kAsNeeded;
  /// Two fixed directions at each contact. Bullet's own default is only the direction of sliding:
  /// then a resting body falls freely for one step, until friction knows the direction.
  bool two_friction_directions = true;
  bullet::ContactSettings contact;
  unsigned threads = 0;  ///< that find contacts of models; 0: one per core
};

/// What moves a body.
enum class Motion {
  kDynamic,    ///< forces
  kStatic,     ///< nothing
  kKinematic,  ///< the user sets its poses
};

/// Properties of a body that can change at any time.
struct BodyMaterial {
  double friction = 0.5;
  double rolling_friction = 0.0;   ///< meters
  double spinning_friction = 0.0;  ///< meters
  double restitution = 0.0;
  double linear_damping = 0.0;  ///< fraction of the velocity that is lost in a second
  double angular_damping = 0.0;
  Vec3 surface_velocity;  ///< m/s, geometry's frame; of kinematic bodies under the Coulomb solver
  /// Bodies collide if each one's group is in the other's mask.
  int group = 1;
  int mask = -1;
};

struct BodySettings {
  Geometry geometry;
  MassProperties mass_properties;  ///< in the geometry's frame; only for dynamic bodies
  Motion motion = Motion::kDynamic;
  Pose world_from_geometry;
  BodyMaterial material;
};

/// Seconds of one step.
struct StepTimings {
  double step;          ///< all of it
  double narrow_phase;  ///< all pairs' collision algorithms
  double query;         ///< the parts of models: finding contacts,
  double reduction;     ///< choosing points,
  double manifold;      ///< filling manifolds
};

/// A contact point. Meters, world frame; normal on b, pointing toward a.
struct SimulationContact {
  int body_a;
  int body_b;
  int id;  ///< of the shell's element; for other shapes, Bullet's triangle or child index
  Vec3 point_a;
  Vec3 point_b;
  Vec3 normal;
  double depth;
  double impulse;  ///< normal impulse of the last step, N s; 0 in queries
  Vec3 friction;   ///< impulse of friction on body a in the last step, N s; 0 in queries
};

/// First hit of a ray. Meters, world frame.
struct RayHit {
  int body = -1;          ///< no hit
  double fraction = 1.0;  ///< of the ray
  Vec3 point;             ///< the ray's end without a hit
  Vec3 normal;            ///< of the surface, toward the ray's start; zero without a hit
};

struct Bounds {
  Vec3 lower;
  Vec3 upper;
};

struct SimulationState;

/// A world of stock Bullet, float64, with voxshell's collision configuration. Throws
/// std::out_of_range if the world has no body or joint with a number.
class Simulation {
 public:
  explicit Simulation(const SimulationSettings& settings);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Adds a body and returns its number, which is never reused.
  std::size_t add_body(const BodySettings& settings);
  /// Removes a body and the joints that hold it.
  void remove_body(std::size_t body);

  /// Adds a joint and returns its number, which is never reused.
  std::size_t add_joint(const JointSettings& settings);
  void remove_joint(std::size_t joint);
  void count_joint_turns_from(std::size_t joint, double position) {
    joints_[joint].count_turns_from(position);
  }
  JointReading read_joint(std::size_t joint) const { return joints_[joint].read(); }
  JointReaction joint_reaction(std::size_t joint) const { return joints_[joint].reaction(); }
  const Motor& motor(std::size_t joint) const { return joints_[joint].motor; }
  void set_motor(std::size_t joint, const Motor& motor);

  const Vec3& gravity() const { return settings_.gravity; }  ///< m/s2, world frame
  /// A change wakes all bodies.
  void set_gravity(const Vec3& gravity);

  void step();
  /// Number of steps since the start, or since the start of a restored state.
  std::uint64_t step_count() const { return step_count_; }
  /// Bodies that turn by more than kMostTurn in a step, with that angle, radians. Each body is
  /// reported once.
  std::vector<std::pair<std::size_t, double>> take_fast_spins() {
    return std::exchange(fast_spins_, {});
  }
  /// Bodies that move by more than kMostWay in a step, with that distance, meters. Each body is
  /// reported once.
  std::vector<std::pair<std::size_t, double>> take_long_ways() {
    return std::exchange(long_ways_, {});
  }
  /// A body whose pose or velocity is not finite.
  std::optional<std::size_t> find_lost_body() const;
  /// Limits of displacement per step, and of the diagonal of a moving body's box, meters. Bullet
  /// stops simulating a body when the diagonal of its box and its displacement reach 1e6 m
  /// (btCollisionWorld::updateSingleAabb). A box of this diagonal, rotated, has one of 8.7e5 m.
  static constexpr double kMostWay = 1e5;
  static constexpr double kWayThatBulletStops = 1e6;
  static constexpr double kMostExtent = 5e5;
  /// Kilograms. Bullet treats an inverse mass below 2.2e-16 (SIMD_EPSILON) as 0, so no contact
  /// stops a heavier body.
  static constexpr double kMostMass = 1e15;
  /// Bullet searches for pairs as if no body turned farther in a step, radians.
  static constexpr double kMostTurn = std::numbers::pi / 4.0;
  /// Timings of the steps since the start or clear_timings(), at most the last kMostTimings.
  const std::deque<StepTimings>& timings() const { return timings_; }
  void clear_timings() { timings_.clear(); }
  static constexpr std::size_t kMostTimings = 100'000;
  std::vector<SimulationContact> compute_contacts() const;

  Pose world_from_geometry(std::size_t body) const;
  void set_world_from_geometry(std::size_t body, const Pose& pose);
  /// The same at once and at rest, of kinematic bodies, too.
  void place(std::size_t body, const Pose& world_from_geometry);
  /// Of the center of mass, m/s, and rad/s; world frame.
  Vec3 linear_velocity(std::size_t body) const;
  Vec3 angular_velocity(std::size_t body) const;
  void set_linear_velocity(std::size_t body, const Vec3& velocity);
  void set_angular_velocity(std::size_t body, const Vec3& velocity);
  bool is_asleep(std::size_t body) const;
  void wake(std::size_t body);

  /// These act in the next step. `place` is a point in the world frame, by default the center of
  /// mass.
  void apply_force(std::size_t body, const Vec3& force, const std::optional<Vec3>& place);
  void apply_torque(std::size_t body, const Vec3& torque);
  /// These act at once.
  void apply_impulse(std::size_t body, const Vec3& impulse, const std::optional<Vec3>& place);
  void apply_torque_impulse(std::size_t body, const Vec3& impulse);

  const BodyMaterial& material(std::size_t body) const;
  void set_material(std::size_t number, const BodyMaterial& material);
  /// Lets two bodies collide or not, if their groups permit.
  void set_collision(std::size_t a, std::size_t b, bool collides);

  /// Queries use the present poses, and do not affect the simulation.
  std::vector<RayHit> cast_rays(const std::vector<Vec3>& starts,
                                const std::vector<Vec3>& ends) const;
  Bounds bounds(std::size_t body) const;
  /// Points of two bodies within `margin` of each other, a few for each pair of parts.
  std::vector<SimulationContact> find_contacts(std::size_t a, std::size_t b, double margin) const;

  /// Both functions rebuild Bullet's caches in the same way, so that later steps have the same
  /// bits.
  std::shared_ptr<const SimulationState> save();
  /// Bodies and joints must be those of the state.
  void restore(const SimulationState& state);
  /// A state of another simulation with as many bodies and joints, in the same order, for this one.
  std::shared_ptr<const SimulationState> adopt(const SimulationState& state) const;

 private:
  struct Body;
  class TimedDispatcher;
  class Filter;
  class World;

  void note_spins();
  void note_ways();
  void make_solver();
  void move_surface(const Body& body);
  void make_world();
  void drop_world();
  void enter(Body& body);
  void wake_touching(std::size_t body);
  void forget_contacts(std::size_t body);
  void update_pairs(const Body& body);
  void update_pair(const Body& body, const Body& other);
  void rebuild(const SimulationState& state);
  void warm_up(const SimulationState& state);
  bool may_meet(const btCollisionObject& a, const btCollisionObject& b) const;
  bool are_jointed_apart(int a, int b) const;
  btRigidBody& body_or_world(int number);

  SimulationSettings settings_;
  bullet::NarrowPhaseTimings model_timings_;
  std::unique_ptr<bullet::CollisionConfiguration> configuration_;
  std::unique_ptr<TimedDispatcher> dispatcher_;
  std::unique_ptr<Filter> filter_;
  std::unique_ptr<btBroadphaseInterface> broadphase_;
  std::unique_ptr<btMLCPSolverInterface> lcp_;  ///< for solvers of all constraints at once
  std::unique_ptr<btConstraintSolver> solver_;
  btRigidBody anchor_;  ///< the fixed body of joints to the world
  Numbered<Body> bodies_;
  Numbered<Joint> joints_;
  std::set<std::pair<int, int>> apart_;  ///< numbers of bodies that do not collide, ascending
  std::unique_ptr<World> world_;
  std::optional<std::vector<SimulationContact>> restored_contacts_;  ///< until the next step
  std::uint64_t step_count_ = 0;
  std::deque<StepTimings> timings_;
  std::vector<std::pair<std::size_t, double>> fast_spins_;
  std::vector<std::pair<std::size_t, double>> long_ways_;
};

}  // namespace voxshell::python
