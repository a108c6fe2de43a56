// That float exceptions are seen where they happen, in this thread and in those it starts: hard cases rely on it.

#include <thread>

#include "tests/support/float_exceptions.hpp"

namespace talus::support {
namespace {

volatile double big = 1e300, kept;

TEST(FloatExceptions, AreNotSeenWhereThereAreNone) {
  EXPECT_EQ(without_float_exceptions([] { return big / 2; }), 5e299);
}

TEST(FloatExceptions, OfThisThreadAreSeen) {
  const FloatExceptions watched;
  kept = big * big;
  EXPECT_NE(watched.seen().find("overflow"), std::string::npos) << watched.seen();
}

TEST(FloatExceptions, OfAThreadAreSeen) {
#ifndef __x86_64__
  GTEST_SKIP() << "only flags of the calling thread are read here";
#endif
  const FloatExceptions watched;
  std::thread([] { kept = big * big; }).join();
  EXPECT_NE(watched.seen().find("overflow"), std::string::npos) << watched.seen();
}

TEST(FloatExceptions, OfBeforeAreForgotten) {
  kept = big * big;
  const FloatExceptions watched;
  EXPECT_EQ(watched.seen(), "");
}

}  // namespace
}  // namespace talus::support
