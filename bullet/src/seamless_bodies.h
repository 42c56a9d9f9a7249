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

/// The bodies that were found to touch at no seam, and what they touched then. As long as a body
/// touches the same bodies at the same points, and all of them have moved by far less than a seam
/// is wide, its contacts are not examined again. Decision 35.
class SeamlessBodies {
 public:
  /// Call it once a step, before hold().
  void begin() { ++step_; }
  /// Whether a body, whose touches these are, was kept and may be passed over in this step. Never
  /// of compounds, whose parts may move unseen.
  bool hold(std::span<const Touching> of_body, double time_step);
  /// Keeps or forgets the body that hold() was last called for.
  void keep(bool has_seams);
  /// Forgets bodies that hold() was not called for in this step.
  void end();

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
    const btCollisionShape* shape = nullptr;
    double time_step = 0.0;
    std::vector<Other> others;
    std::vector<Point> points;
    std::uint64_t step = 0;  ///< that they were last asked about in
  };

  void describe(std::span<const Touching> of_body, double time_step);
  bool are_as_now(const Surroundings& then) const;

  std::map<const btCollisionObject*, Surroundings> kept_;
  std::uint64_t step_ = 0;
  /// Of the body that hold() was last called for.
  const btCollisionObject* body_ = nullptr;
  bool has_parts_ = false;  ///< it, or something that it touches, is a compound
  double radius_ = 0.0;     ///< about the body's origin, metres
  double smallest_ = 0.0;   ///< radius of it and what it touches, metres
  Surroundings now_;
};

}  // namespace voxshell::bullet
