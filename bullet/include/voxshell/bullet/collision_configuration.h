#pragma once

#include <memory>
#include <variant>

#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include "voxshell/bullet/contact_settings.h"
#include "voxshell/result.h"

namespace voxshell::bullet {

/// Whether a shape, and everything that it is composed of, can collide with a ModelShape. Error
/// kInvalidArgument, with the reason, if it cannot: btSdfCollisionShape and other concave shapes of
/// user types, btGImpactCompoundShape, soft bodies and fluids. docs/bullet-pairs.md lists all.
Result<std::monostate> check_served(const btCollisionShape& shape);

/// Replaces btDefaultCollisionConfiguration. It adds algorithms for ModelShape against every Bullet
/// shape, in either order. If check_served() refuses a shape, the first overlap of its bounds with
/// a model's throws std::logic_error out of the world's step, or of the query: no pair passes
/// through silently.
///
/// Throws std::logic_error if you pass a pool for algorithms whose elements are too small.
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
