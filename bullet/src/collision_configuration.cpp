#include "voxshell/bullet/collision_configuration.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <LinearMath/btPoolAllocator.h>

#include "compound_algorithm.h"
#include "model_algorithm.h"
#include "posed_pair.h"

namespace voxshell::bullet {
namespace {

/// How the model of a pair meets the other shape; none where neither is a model.
std::optional<Meeting> meeting_of(int type0, int type1) {
  const Meeting meetings[] = {meeting_with(type0), meeting_with(type1)};
  if (meetings[0] == Meeting::kModel) return meetings[1];
  if (meetings[1] == Meeting::kModel) return meetings[0];
  return std::nullopt;
}

std::string refusal_of(const char* name) {
  return std::string("a ModelShape cannot meet a ") + name +
         ": use a triangle mesh, a convex shape, a compound of them, or a model in its place";
}

/// For pairs that nobody serves.
class RefusingCreateFunc : public btCollisionAlgorithmCreateFunc {
 public:
  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo&,
                                                 const btCollisionObjectWrapper* a,
                                                 const btCollisionObjectWrapper* b) override {
    const bool model_is_a = meeting_with(a->getCollisionShape()->getShapeType()) == Meeting::kModel;
    throw std::logic_error(refusal_of((model_is_a ? b : a)->getCollisionShape()->getName()));
  }
};

/// For pairs of types that are served, though some shapes of them may not be.
class ServingCreateFunc : public ModelAlgorithmCreateFunc {
 public:
  using ModelAlgorithmCreateFunc::ModelAlgorithmCreateFunc;

  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* a,
                                                 const btCollisionObjectWrapper* b) override {
    for (const btCollisionObjectWrapper* side : {a, b}) {
      if (meeting_with(*side->getCollisionShape()) == Meeting::kUnserved) {
        return RefusingCreateFunc().CreateCollisionAlgorithm(info, a, b);
      }
    }
    return ModelAlgorithmCreateFunc::CreateCollisionAlgorithm(info, a, b);
  }
};

/// The pools of the base class must hold our algorithm, whatever the caller asked for.
btDefaultCollisionConstructionInfo with_room(btDefaultCollisionConstructionInfo info) {
  const btPoolAllocator* pool = info.m_collisionAlgorithmPool;
  if (pool != nullptr && pool->getElementSize() < static_cast<int>(sizeof(ModelAlgorithm))) {
    throw std::logic_error(
        "the pool for collision algorithms has elements of " +
        std::to_string(pool->getElementSize()) + " bytes, an algorithm of voxshell's takes " +
        std::to_string(sizeof(ModelAlgorithm)) + ": give a pool of larger elements, or none");
  }
  info.m_customCollisionAlgorithmMaxElementSize = std::max(
      info.m_customCollisionAlgorithmMaxElementSize, static_cast<int>(sizeof(ModelAlgorithm)));
  return info;
}

}  // namespace

Result<std::monostate> check_served(const btCollisionShape& shape) {
  if (meeting_with(shape) == Meeting::kUnserved) {
    return Error{ErrorCode::kInvalidArgument, refusal_of(shape.getName())};
  }
  if (shape.isCompound()) {
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    for (int i = 0; i < compound.getNumChildShapes(); ++i) {
      if (auto checked = check_served(*compound.getChildShape(i)); !checked) return checked;
    }
  }
  return std::monostate{};
}

struct CollisionConfiguration::CreateFunctions {
  explicit CreateFunctions(const ContactSettings& contact_settings) : settings(contact_settings) {}

  ContactSettings settings;
  ServingCreateFunc simulation{settings, Purpose::kSimulation};
  ServingCreateFunc contact_test{settings, Purpose::kContactTest};
  RefusingCreateFunc refusing;
  CompoundCreateFunc compound{/*compound_is_second=*/false};
  CompoundCreateFunc compound_second{/*compound_is_second=*/true};

  /// Ours for a pair of types, or null.
  btCollisionAlgorithmCreateFunc* of(int type0, int type1, ServingCreateFunc& served) {
    switch (meeting_of(type0, type1).value_or(Meeting::kNever)) {
      case Meeting::kModel:
      case Meeting::kField:
      case Meeting::kTriangles:
        return &served;
      case Meeting::kUnserved:
        return &refusing;
      default:
        return nullptr;
    }
  }
};

CollisionConfiguration::CollisionConfiguration(const ContactSettings& settings,
                                               btDefaultCollisionConstructionInfo info)
    : btDefaultCollisionConfiguration(with_room(info)),
      create_functions_(std::make_unique<CreateFunctions>(settings)) {}

CollisionConfiguration::~CollisionConfiguration() = default;

btCollisionAlgorithmCreateFunc* CollisionConfiguration::getCollisionAlgorithmCreateFunc(int type0,
                                                                                        int type1) {
  if (auto* ours = create_functions_->of(type0, type1, create_functions_->simulation)) return ours;
  if (btBroadphaseProxy::isCompound(type0)) return &create_functions_->compound;
  if (btBroadphaseProxy::isCompound(type1)) return &create_functions_->compound_second;
  return btDefaultCollisionConfiguration::getCollisionAlgorithmCreateFunc(type0, type1);
}

btCollisionAlgorithmCreateFunc* CollisionConfiguration::getClosestPointsAlgorithmCreateFunc(
    int type0, int type1) {
  if (auto* ours = create_functions_->of(type0, type1, create_functions_->contact_test)) {
    return ours;
  }
  return btDefaultCollisionConfiguration::getClosestPointsAlgorithmCreateFunc(type0, type1);
}

}  // namespace voxshell::bullet
