#include "voxshell/bullet/collision_configuration.h"

#include <algorithm>

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>

#include "model_algorithm.h"

namespace voxshell::bullet {
namespace {

bool is_model(int type) { return type == FAST_CONCAVE_MESH_PROXYTYPE; }

/// Shape types that ModelAlgorithm meets with a field or shell of their own.
bool has_field(int type) {
  return is_model(type) || type == STATIC_PLANE_PROXYTYPE || type == BOX_SHAPE_PROXYTYPE ||
         type == SPHERE_SHAPE_PROXYTYPE;
}

bool is_served(int type0, int type1) {
  return (is_model(type0) && has_field(type1)) || (is_model(type1) && has_field(type0));
}

/// The pools of the base class must hold our algorithm, whatever the caller asked for.
btDefaultCollisionConstructionInfo with_room(btDefaultCollisionConstructionInfo info) {
  info.m_customCollisionAlgorithmMaxElementSize = std::max(
      info.m_customCollisionAlgorithmMaxElementSize, static_cast<int>(sizeof(ModelAlgorithm)));
  return info;
}

}  // namespace

struct CollisionConfiguration::CreateFunctions {
  explicit CreateFunctions(const ContactSettings& contact_settings) : settings(contact_settings) {}

  ContactSettings settings;
  ModelAlgorithmCreateFunc simulation{settings, Purpose::kSimulation};
  ModelAlgorithmCreateFunc contact_test{settings, Purpose::kContactTest};
};

CollisionConfiguration::CollisionConfiguration(const ContactSettings& settings,
                                               btDefaultCollisionConstructionInfo info)
    : btDefaultCollisionConfiguration(with_room(info)),
      create_functions_(std::make_unique<CreateFunctions>(settings)) {}

CollisionConfiguration::~CollisionConfiguration() = default;

btCollisionAlgorithmCreateFunc* CollisionConfiguration::getCollisionAlgorithmCreateFunc(int type0,
                                                                                        int type1) {
  if (is_served(type0, type1)) return &create_functions_->simulation;
  return btDefaultCollisionConfiguration::getCollisionAlgorithmCreateFunc(type0, type1);
}

btCollisionAlgorithmCreateFunc* CollisionConfiguration::getClosestPointsAlgorithmCreateFunc(
    int type0, int type1) {
  if (is_served(type0, type1)) return &create_functions_->contact_test;
  return btDefaultCollisionConfiguration::getClosestPointsAlgorithmCreateFunc(type0, type1);
}

}  // namespace voxshell::bullet
