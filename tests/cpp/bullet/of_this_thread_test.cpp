#include "of_this_thread.h"

#include <memory>
#include <thread>

#include <gtest/gtest.h>

namespace voxshell::bullet::of_this_thread_test {
namespace {

struct Counted {
  std::shared_ptr<int> held;
};

TEST(OfThisThread, IsTheSameObjectWithinAThreadAndAnotherOneElsewhere) {
  Counted* const here = &of_this_thread<Counted>();
  EXPECT_EQ(&of_this_thread<Counted>(), here);
  Counted* there = nullptr;
  std::thread([&] { there = &of_this_thread<Counted>(); }).join();
  EXPECT_NE(there, here);
}

TEST(OfThisThread, EndsWithItsThread) {
  const auto held = std::make_shared<int>(0);
  std::thread([&] {
    of_this_thread<Counted>().held = held;
    EXPECT_EQ(held.use_count(), 2);
  }).join();
  EXPECT_EQ(held.use_count(), 1);
}

}  // namespace
}  // namespace voxshell::bullet::of_this_thread_test
