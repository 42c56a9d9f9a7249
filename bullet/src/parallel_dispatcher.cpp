#include "voxshell/bullet/parallel_dispatcher.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <thread>
#include <typeinfo>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>

#include "model_algorithm.h"
#include "posed_pair.h"
#include "run_on_threads.h"
#include "support.h"
#include "wrap_object.h"

namespace voxshell::bullet {
namespace {

/// Pairs that search for contacts for each thread. Smaller: to start a thread takes longer than it
/// saves.
constexpr std::size_t kPairsOfThread = 8;

const btCollisionObject& object_of(const btBroadphaseProxy& proxy) {
  return *static_cast<const btCollisionObject*>(proxy.m_clientObject);
}

/// Bullet's triangles are read by callbacks, of which it does not say that threads may call them.
bool has_triangles(const btCollisionObject& object) {
  return collision_method_of(*object.getCollisionShape()) == CollisionMethod::kTriangles;
}

}  // namespace

/// A pair whose step can be prepared.
struct ParallelDispatcher::Job {
  ModelAlgorithm* algorithm;
  const btCollisionObject* a;
  const btCollisionObject* b;

  void prepare(double time_step) const {
    algorithm->prepare(wrap_object(*a), wrap_object(*b), time_step, nullptr);
  }
};

ParallelDispatcher::ParallelDispatcher(btCollisionConfiguration* configuration, unsigned threads)
    : btCollisionDispatcher(configuration),
      threads_(threads != 0 ? threads : std::max(1u, std::thread::hardware_concurrency())),
      support_(std::make_unique<Support>()) {}

ParallelDispatcher::~ParallelDispatcher() = default;

void ParallelDispatcher::dispatchAllCollisionPairs(btOverlappingPairCache* pairs,
                                                   const btDispatcherInfo& info,
                                                   btDispatcher* dispatcher) {
  parallel_seconds_ = 0.0;
  support_->read(*this);
  jobs_.clear();
  // A callback of the user's may pass some by, and so may an exception.
  struct DropAtEnd {
    const std::vector<Job>& jobs;
    explicit DropAtEnd(const std::vector<Job>& all) : jobs(all) {}
    DropAtEnd(const DropAtEnd&) = delete;
    DropAtEnd& operator=(const DropAtEnd&) = delete;
    ~DropAtEnd() {
      for (const Job& job : jobs) job.algorithm->drop_prepared();
    }
  } const drop_at_end(jobs_);
  if (threads_ > 1) prepare(*pairs, info);
  btCollisionDispatcher::dispatchAllCollisionPairs(pairs, info, dispatcher);
}

void ParallelDispatcher::prepare(btOverlappingPairCache& pairs, const btDispatcherInfo& info) {
  const btBroadphasePairArray& all = pairs.getOverlappingPairArray();
  // Pairs of a heap that trembles search in every other step or so. Which of them will is not
  // known, but about as many as before.
  std::size_t searches = 0;
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
    jobs_.push_back({algorithm, &a, &b});
    if (algorithm->has_searched()) ++searches;
  }
  const auto threads =
      static_cast<unsigned>(std::min<std::size_t>(threads_, searches / kPairsOfThread));
  if (threads < 2) {
    jobs_.clear();
    return;
  }
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto time_step = static_cast<double>(info.m_timeStep);
  run_on_threads(jobs_.size(), threads, kPairsOfThread, "contacts",
                 [&](std::size_t i) { jobs_[i].prepare(time_step); });
  parallel_seconds_ = std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace voxshell::bullet
