// How long single queries take, for `./dev soak`: all contacts of two bodies of one model that move
// in each other as a hand moves one at 1 kHz, half a millimeter clear to two deep.
//
//     voxshell_query_latency MODEL_FILE SEED QUERIES
//
// Prints the worst time in nanoseconds, how often the system took the processor away, how many
// queries found contacts, and then the times as a histogram: a line "bucket count" for each bucket
// that is not empty. Bucket b begins at 2^(b / 16) nanoseconds.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <sys/resource.h>

#include "support/pairs.h"
#include "support/random.h"
#include "voxshell/contacts.h"
#include "voxshell/model.h"
#include "voxshell/model_file.h"

using namespace voxshell;

namespace {

constexpr std::uint64_t kQueriesAPath = 1000;  // a second at 1 kHz
constexpr double kStep = 1e-4;                 // meters from one query to the next, at most
constexpr double kBucketsAnOctave = 16.0;
constexpr std::size_t kBuckets = 640;  // up to 18 minutes

long count_interruptions() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nivcsw;
}

int measure(const Model& model, std::uint64_t seed, std::uint64_t queries) {
  using Clock = std::chrono::steady_clock;
  test_support::Random random(seed);
  QueryScratch scratch;
  std::array<std::uint64_t, kBuckets> histogram{};
  double worst = 0.0;
  std::uint64_t touching = 0;
  const long interruptions = count_interruptions();
  Pose pose;
  Vec3 velocity{};
  for (std::uint64_t i = 0; i < queries; ++i) {
    if (i % kQueriesAPath == 0) {
      const double clearance = random.uniform(-2e-3, 5e-4);
      pose = test_support::make_pose_at(model.field(), model.shell(), clearance, random);
      velocity = random.uniform(0.0, kStep) * random.direction();
      find_contacts(model.field(), model.shell(), pose, {}, scratch);  // warm
    }
    // There and back, so that the bodies stay about where they touch.
    const double way = i / 20 % 2 == 0 ? 1.0 : -1.0;
    pose.translation += way * velocity;
    const Clock::time_point start = Clock::now();
    const auto contacts = find_contacts(model.field(), model.shell(), pose, {}, scratch);
    const Clock::time_point end = Clock::now();
    const double nanoseconds = std::chrono::duration<double, std::nano>(end - start).count();
    const double octaves = std::log2(std::max(nanoseconds, 1.0));
    ++histogram[std::min(static_cast<std::size_t>(kBucketsAnOctave * octaves), kBuckets - 1)];
    worst = std::max(worst, nanoseconds);
    if (!contacts.empty()) ++touching;
  }
  std::printf("worst %.0f\ninterruptions %ld\ntouching %llu\n", worst,
              count_interruptions() - interruptions, static_cast<unsigned long long>(touching));
  for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) {
    if (histogram[bucket] > 0) {
      std::printf("%zu %llu\n", bucket, static_cast<unsigned long long>(histogram[bucket]));
    }
  }
  return EXIT_SUCCESS;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 4) {
    std::fprintf(stderr, "usage: %s MODEL_FILE SEED QUERIES\n", arguments[0]);
    return 2;
  }
  const auto model = load_model(arguments[1]);
  if (!model) {
    std::fprintf(stderr, "%s\n", model.error().message.c_str());
    return EXIT_FAILURE;
  }
  return measure(**model, std::strtoull(arguments[2], nullptr, 10),
                 std::strtoull(arguments[3], nullptr, 10));
}
