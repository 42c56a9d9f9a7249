#pragma once

#include <memory>
#include <variant>

#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include "voxshell/bullet/contact_settings.h"
#include "voxshell/result.h"

namespace voxshell::bullet {

/// Whether a shape, and what it is composed of, can meet a ModelShape. Error kInvalidArgument, with
/// the reason, where it cannot: btSdfCollisionShape and other concave shapes of user types,
/// btGImpactCompoundShape, soft bodies, fluids. docs/bullet-pairs.md lists all.
Result<std::monostate> check_served(const btCollisionShape& shape);

/// Use it in place of btDefaultCollisionConfiguration: the same, with algorithms for ModelShape
/// against every shape of Bullet's that has none of its own for it, in either order. Where
/// check_served() refuses a shape, the first overlap of its bounds with a model's throws
/// std::logic_error out of the world's step, or of the query: no pair passes through in silence.
///
/// A pool of the caller's for algorithms whose elements are too small throws std::logic_error.
///
/// For true rebounds, set m_splitImpulsePenetrationThreshold of the world's solver info to 0.
class CollisionConfiguration : public btDefaultCollisionConfiguration {
 public:
  explicit CollisionConfiguration(const ContactSettings& settings = {},
                                  btDefaultCollisionConstructionInfo info = {});
  ~CollisionConfiguration() override;

  btCollisionAlgorithmCreateFunc* getCollisionAlgorithmCreateFunc(int type0, int type1) override;
  btCollisionAlgorithmCreateFunc* getClosestPointsAlgorithmCreateFunc(int type0,
                                                                      int type1) override;

 private:
  struct CreateFunctions;
  std::unique_ptr<CreateFunctions> create_functions_;
};

}  // namespace voxshell::bullet
