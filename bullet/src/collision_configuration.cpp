#include "voxshell/bullet/collision_configuration.h"

#include <algorithm>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <LinearMath/btPoolAllocator.h>

#include "compound_algorithm.h"
#include "hull.h"
#include "model_algorithm.h"
#include "plane_algorithm.h"
#include "posed_pair.h"

namespace voxshell::bullet {
namespace {

/// How the model of a pair meets the other shape; none where neither is a model.
std::optional<CollisionMethod> find_collision_method(int type0, int type1) {
  const CollisionMethod methods[] = {collision_method_of(type0), collision_method_of(type1)};
  if (methods[0] == CollisionMethod::kModel) return methods[1];
  if (methods[1] == CollisionMethod::kModel) return methods[0];
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
    const bool model_is_a =
        collision_method_of(a->getCollisionShape()->getShapeType()) == CollisionMethod::kModel;
    throw std::logic_error(refusal_of((model_is_a ? b : a)->getCollisionShape()->getName()));
  }
};

/// For pairs of types that are served, though some shapes of them may not be, or by Bullet's own
/// algorithms.
class ServingCreateFunc : public btCollisionAlgorithmCreateFunc {
 public:
  ServingCreateFunc(const ContactSettings& settings, Purpose purpose, Hulls& hulls,
                    btDefaultCollisionConfiguration& bullet)
      : settings_(settings), purpose_(purpose), hulls_(hulls), bullet_(bullet) {}

  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* a,
                                                 const btCollisionObjectWrapper* b) override {
    std::shared_ptr<const Hull> hull;
    for (const btCollisionObjectWrapper* side : {a, b}) {
      const btCollisionShape& shape = *side->getCollisionShape();
      const CollisionMethod method = collision_method_of(shape);
      if (method == CollisionMethod::kUnserved) {
        return RefusingCreateFunc().CreateCollisionAlgorithm(info, a, b);
      }
      if (method == CollisionMethod::kHull) {
        hull = hulls_.of(static_cast<const btConvexShape&>(shape));
        if (!hull) return of_bullet(*a, *b).CreateCollisionAlgorithm(info, a, b);
      }
    }
    void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(ModelAlgorithm));
    return new (memory) ModelAlgorithm(info, settings_, purpose_, std::move(hull));
  }

 private:
  btCollisionAlgorithmCreateFunc& of_bullet(const btCollisionObjectWrapper& a,
                                            const btCollisionObjectWrapper& b) {
    return *bullet_.btDefaultCollisionConfiguration::getCollisionAlgorithmCreateFunc(
        a.getCollisionShape()->getShapeType(), b.getCollisionShape()->getShapeType());
  }

  const ContactSettings& settings_;
  Purpose purpose_;
  Hulls& hulls_;
  btDefaultCollisionConfiguration& bullet_;
};

constexpr std::size_t kLargestAlgorithm =
    std::max({sizeof(CompoundAlgorithm), sizeof(ModelAlgorithm), sizeof(PlaneAlgorithm)});

/// Whether PlaneAlgorithm serves a pair. Of polyhedra on planes, Bullet finds several corners.
bool is_on_plane(int type0, int type1) {
  return btBroadphaseProxy::isConvex(type0) && !btBroadphaseProxy::isPolyhedral(type0) &&
         type1 == STATIC_PLANE_PROXYTYPE;
}

/// The pools of the base class must hold our algorithms, whatever the caller asked for.
btDefaultCollisionConstructionInfo with_room(btDefaultCollisionConstructionInfo info) {
  const btPoolAllocator* pool = info.m_collisionAlgorithmPool;
  if (pool != nullptr && pool->getElementSize() < static_cast<int>(kLargestAlgorithm)) {
    throw std::logic_error(
        "the pool for collision algorithms has elements of " +
        std::to_string(pool->getElementSize()) + " bytes, an algorithm of voxshell's takes " +
        std::to_string(kLargestAlgorithm) + ": give a pool of larger elements, or none");
  }
  info.m_customCollisionAlgorithmMaxElementSize =
      std::max(info.m_customCollisionAlgorithmMaxElementSize, static_cast<int>(kLargestAlgorithm));
  return info;
}

}  // namespace

Result<std::monostate> check_served(const btCollisionShape& shape) {
  if (collision_method_of(shape) == CollisionMethod::kUnserved) {
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
  CreateFunctions(const ContactSettings& contact_settings, btDefaultCollisionConfiguration& bullet)
      : settings(contact_settings),
        simulation(settings, Purpose::kSimulation, hulls, bullet),
        contact_test(settings, Purpose::kContactTest, hulls, bullet) {}

  ContactSettings settings;
  Hulls hulls;
  ServingCreateFunc simulation;
  ServingCreateFunc contact_test;
  RefusingCreateFunc refusing;
  PlaneAlgorithm::CreateFunc on_plane{/*is_plane_first=*/false};
  PlaneAlgorithm::CreateFunc under_convex{/*is_plane_first=*/true};
  CompoundCreateFunc compound{/*compound_is_second=*/false};
  CompoundCreateFunc compound_second{/*compound_is_second=*/true};

  /// Ours for a pair of types, or null.
  btCollisionAlgorithmCreateFunc* of(int type0, int type1, ServingCreateFunc& served) {
    switch (find_collision_method(type0, type1).value_or(CollisionMethod::kNever)) {
      case CollisionMethod::kModel:
      case CollisionMethod::kField:
      case CollisionMethod::kHull:
      case CollisionMethod::kTriangles:
        return &served;
      case CollisionMethod::kUnserved:
        return &refusing;
      default:
        return nullptr;
    }
  }
};

CollisionConfiguration::CollisionConfiguration(const ContactSettings& settings,
                                               btDefaultCollisionConstructionInfo info)
    : btDefaultCollisionConfiguration(with_room(info)),
      create_functions_(std::make_unique<CreateFunctions>(settings, *this)) {}

CollisionConfiguration::~CollisionConfiguration() = default;

btCollisionAlgorithmCreateFunc* CollisionConfiguration::getCollisionAlgorithmCreateFunc(int type0,
                                                                                        int type1) {
  if (auto* ours = create_functions_->of(type0, type1, create_functions_->simulation)) return ours;
  if (is_on_plane(type0, type1)) return &create_functions_->on_plane;
  if (is_on_plane(type1, type0)) return &create_functions_->under_convex;
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
