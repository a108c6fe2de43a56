// What a question is held to, alone: the stop token, the limits and how far the work is.

#include "query/pages/watch.hpp"

#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "talus/failure.hpp"
#include "tests/support/failure_of.hpp"

namespace talus::support {
namespace {

bool is_too_large(const std::function<void()>& work, const std::string& limit) {
  const auto failure = failure_of(work);
  if (!failure) return false;
  EXPECT_EQ(failure->cause(), Cause::too_large);
  EXPECT_THAT(failure->what(), ::testing::HasSubstr(limit));
  return true;
}

TEST(Watch, LooksAtTheStopTokenWheneverItLooksOrTells) {
  std::stop_source source;
  Question question;
  question.stop = source.get_token();
  Watch watch(question);
  const std::vector<std::function<void()>> all{[&] { watch.look(); }, [&] { watch.tell(0.5); },
                                               [&] { watch.stage("reading", 0, 1); }};
  for (const auto& look : all) EXPECT_NO_THROW(look());
  source.request_stop();
  for (const auto& look : all) {
    const auto failure = failure_of(look);
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->cause(), Cause::cancelled);
    EXPECT_THAT(failure->what(), ::testing::HasSubstr("Question::stop"));
  }
}

TEST(Watch, TellsNothingOnceItIsStopped) {
  std::stop_source source;
  int told = 0;
  Question question;
  question.stop = source.get_token();
  question.progress = [&](double, const char*) { ++told; };
  Watch watch(question);
  watch.stage("reading", 0, 1);
  EXPECT_EQ(told, 1);
  source.request_stop();
  EXPECT_TRUE(failure_of([&] { watch.tell(0.9); }));
  EXPECT_EQ(told, 1);
}

TEST(Watch, CountsVerticesUpToTheLimitAndNotOneMore) {
  Question question;
  question.limits.vertices = 100;
  Watch watch(question);
  EXPECT_NO_THROW(watch.add_vertices(60));
  EXPECT_NO_THROW(watch.add_vertices(40));
  EXPECT_TRUE(is_too_large([&] { watch.add_vertices(1); }, "Limits::vertices"));
  EXPECT_NO_THROW(watch.require_vertices(100));
  EXPECT_TRUE(is_too_large([&] { watch.require_vertices(101); }, "Limits::vertices"));
}

TEST(Watch, VerticesThatAreNotTheAnswersCountByTheirBytesAlone) {
  Question question;
  question.limits.vertices = 10;
  question.limits.memory_bytes = 20 * kBytesAVertex;
  Watch watch(question);
  {
    const Watch::Aside aside(watch);
    EXPECT_NO_THROW(watch.add_vertices(12));
  }
  EXPECT_NO_THROW(watch.add_vertices(8)) << "the first of the answer";
  EXPECT_TRUE(is_too_large([&] { watch.add_vertices(1); }, "Limits::memory_bytes"));
}

TEST(Watch, CountsBytesUpToTheLimitLessWhatIsFreeAgain) {
  Question question;
  question.limits.memory_bytes = 1000;
  Watch watch(question);
  watch.add_bytes(1000);
  watch.give_back(400);
  EXPECT_NO_THROW(watch.add_bytes(400));
  EXPECT_TRUE(is_too_large([&] { watch.add_bytes(1); }, "Limits::memory_bytes"));
}

TEST(Watch, WithoutLimitsCountsNothing) {
  Watch watch;
  EXPECT_NO_THROW(watch.add_vertices(std::uint64_t{1} << 50));
  EXPECT_NO_THROW(watch.require_vertices(std::uint64_t{1} << 50));
  watch.give_back(1000);
  EXPECT_NO_THROW(unwatched().add_bytes(std::uint64_t{1} << 60));
  EXPECT_NO_THROW(unwatched().look());
}

TEST(Watch, CountsOfSeveralThreadsAddUp) {
  Question question;
  question.limits.vertices = 4 * 1000;
  Watch watch(question);
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&] {
        for (int i = 0; i < 1000; ++i) watch.add_vertices(1);
      });
    }
  }
  EXPECT_TRUE(is_too_large([&] { watch.add_vertices(1); }, "Limits::vertices"));
}

TEST(Watch, TellsSharesOfStagesThatNeverFall) {
  std::vector<std::pair<double, std::string>> told;
  Question question;
  question.progress = [&](double fraction, const char* stage) { told.emplace_back(fraction, stage); };
  Watch watch(question);
  watch.stage("reading", 0, 0.25);
  watch.tell(0.5);
  watch.tell(0.5001);  // too little to be worth saying
  watch.tell(0.25);    // never back
  watch.tell(7);       // a share is 1 at most
  watch.stage("choosing", 0.25, 1);
  watch.tell(0.5);
  watch.tell(1);
  watch.tell(1);  // once
  EXPECT_THAT(told,
              ::testing::ElementsAre(std::pair{0.0, "reading"}, std::pair{0.125, "reading"}, std::pair{0.25, "reading"},
                                     std::pair{0.625, "choosing"}, std::pair{1.0, "choosing"}));
}

TEST(Watch, AMaskTakesABitASampleAndACountForSixtyFour) {
  EXPECT_EQ(bytes_of_mask({{0, 0}, {63, 0}}), 12u);
  EXPECT_EQ(bytes_of_mask({{0, 0}, {64, 0}}), 24u);
  EXPECT_EQ(bytes_of_mask({{-5, -5}, {-4, 4}}), 120u);
}

}  // namespace
}  // namespace talus::support
