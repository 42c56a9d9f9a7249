#pragma once

#include <memory>

#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>

#include "voxshell/bullet/contact_settings.h"

namespace voxshell::bullet {

/// Use it in place of btDefaultCollisionConfiguration: the same, with algorithms for ModelShape
/// against ModelShape, btStaticPlaneShape, btBoxShape and btSphereShape. Other convex shapes meet a
/// model's triangles through Bullet's own algorithms.
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
