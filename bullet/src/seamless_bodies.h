#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "motion.h"
#include "voxshell/pose.h"

namespace voxshell::bullet {

/// A body, one that it touches, and a manifold of theirs.
struct Touching {
  const btCollisionObject* body;
  const btCollisionObject* other;
  btPersistentManifold* manifold;
};

/// A body that was found to touch at no seam, and what it touched then. As long as it touches the
/// same bodies at the same points, and all of them have moved by far less than a seam is wide, its
/// contacts are not examined again. Decision 35.
class SeamlessBody {
 public:
  /// Whether the body, whose touches these are, was kept and may be passed over in this step. Never
  /// of compounds, whose parts may move unseen.
  bool hold(std::span<const Touching> of_body, double time_step);
  /// Keeps or forgets what hold() was last called for.
  void keep(bool has_seams);

 private:
  /// A body that is touched, as the one that touches it sees it.
  struct Other {
    const btCollisionObject* body;
    Pose pose;
    RelativeMotion motion;
  };
  struct Point {
    int id;
    Vec3 normal;  ///< in the frame of the body that touches
  };
  struct Surroundings {
    const btCollisionShape* shape = nullptr;  ///< null: nothing was kept
    double time_step = 0.0;
    std::vector<Other> others;
    std::vector<Point> points;
  };

  void describe(std::span<const Touching> of_body, double time_step);
  bool are_as_now(const Surroundings& then) const;

  Surroundings kept_;
  Surroundings now_;        ///< those that hold() was last called for
  bool has_parts_ = false;  ///< the body, or something that it touches, is a compound
  double radius_ = 0.0;     ///< about the body's origin, meters
  double smallest_ = 0.0;   ///< radius of it and what it touches, meters
};

/// What is kept of bodies that touch others.
class SeamlessBodies {
 public:
  /// Call it once a step, before of().
  void begin() { ++step_; }
  /// Stays where it is until the end of the step. Several threads may use those of several bodies.
  SeamlessBody& of(const btCollisionObject& body);
  /// Forgets bodies that were not asked for in this step.
  void end();

 private:
  struct Kept {
    SeamlessBody body;
    std::uint64_t step = 0;  ///< that it was last asked for in
  };

  std::map<const btCollisionObject*, Kept> kept_;
  std::uint64_t step_ = 0;
};

}  // namespace voxshell::bullet
