#include "voxshell/bullet/parallel_dispatcher.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <thread>
#include <typeinfo>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>

#include "contact_constants.h"
#include "model_algorithm.h"
#include "posed_pair.h"
#include "voxshell/parallel.h"

namespace voxshell::bullet {
namespace {

/// A pair whose step can be prepared.
struct Job {
  ModelAlgorithm* algorithm;
  const btCollisionObject* a;
  const btCollisionObject* b;
};

const btCollisionObject& object_of(const btBroadphaseProxy& proxy) {
  return *static_cast<const btCollisionObject*>(proxy.m_clientObject);
}

/// Bullet's triangles are read by callbacks, of which it does not say that threads may call them.
bool has_triangles(const btCollisionObject& object) {
  return meeting_with(*object.getCollisionShape()) == Meeting::kTriangles;
}

void prepare(const Job& job, double time_step) {
  const auto wrap = [](const btCollisionObject& object) {
    return btCollisionObjectWrapper(nullptr, object.getCollisionShape(), &object,
                                    object.getWorldTransform(), -1, -1);
  };
  const btCollisionObjectWrapper a = wrap(*job.a);
  const btCollisionObjectWrapper b = wrap(*job.b);
  job.algorithm->prepare(a, b, time_step, nullptr);
}

}  // namespace

struct ParallelDispatcher::Jobs {
  std::vector<Job> near;  ///< bodies that were near each other, with the most to do
};

ParallelDispatcher::ParallelDispatcher(btCollisionConfiguration* configuration, unsigned threads)
    : btCollisionDispatcher(configuration),
      threads_(threads != 0 ? threads : std::max(1u, std::thread::hardware_concurrency())),
      jobs_(std::make_unique<Jobs>()) {}

ParallelDispatcher::~ParallelDispatcher() = default;

void ParallelDispatcher::dispatchAllCollisionPairs(btOverlappingPairCache* pairs,
                                                   const btDispatcherInfo& info,
                                                   btDispatcher* dispatcher) {
  parallel_seconds_ = 0.0;
  jobs_->near.clear();
  // A callback of the user's may pass some by, and so may an exception.
  struct DropAtEnd {
    const std::vector<Job>& jobs;
    explicit DropAtEnd(const std::vector<Job>& all) : jobs(all) {}
    DropAtEnd(const DropAtEnd&) = delete;
    DropAtEnd& operator=(const DropAtEnd&) = delete;
    ~DropAtEnd() {
      for (const Job& job : jobs) job.algorithm->drop_prepared();
    }
  } const drop_at_end(jobs_->near);
  if (threads_ > 1) prepare(*pairs, info);
  btCollisionDispatcher::dispatchAllCollisionPairs(pairs, info, dispatcher);
}

void ParallelDispatcher::prepare(btOverlappingPairCache& pairs, const btDispatcherInfo& info) {
  std::vector<Job>& near = jobs_->near;
  const btBroadphasePairArray& all = pairs.getOverlappingPairArray();
  for (int i = 0; i < all.size(); ++i) {
    const btBroadphasePair& pair = all[i];
    if (pair.m_algorithm == nullptr || typeid(*pair.m_algorithm) != typeid(ModelAlgorithm))
      continue;
    auto* const algorithm = static_cast<ModelAlgorithm*>(pair.m_algorithm);
    const btCollisionObject& a = object_of(*pair.m_pProxy0);
    const btCollisionObject& b = object_of(*pair.m_pProxy1);
    if (!algorithm->is_near() || has_triangles(a) || has_triangles(b) || !needsCollision(&a, &b)) {
      continue;
    }
    near.push_back({algorithm, &a, &b});
  }
  const auto threads =
      static_cast<unsigned>(std::min<std::size_t>(threads_, near.size() / kPairsOfThread));
  if (threads < 2) {
    near.clear();
    return;
  }
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto time_step = static_cast<double>(info.m_timeStep);
  parallel_for(near.size(), threads, "contacts", {},
               [&](std::size_t i) { voxshell::bullet::prepare(near[i], time_step); });
  parallel_seconds_ = std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace voxshell::bullet
