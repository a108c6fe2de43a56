// One piece of work on several threads: each task once, in order, and what is thrown ends it.

#include "engine/machine/parallel.hpp"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace talus::support {
namespace {

TEST(Parallel, NoughtStandsForAllThreadsOfTheMachine) {
  EXPECT_GE(threads_or_all(0), 1);
  EXPECT_EQ(threads_or_all(1), 1);
  EXPECT_EQ(threads_or_all(7), 7);
  EXPECT_EQ(threads_or_all(-3), 1);
}

TEST(Parallel, EachTaskIsDoneOnceAndEachThreadTakesThemInOrder) {
  for (const int threads : {-1, 0, 1, 2, 3, 8}) {
    for (const std::size_t count :
         {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{5}, std::size_t{1000}}) {
      SCOPED_TRACE(std::to_string(threads) + " threads, " + std::to_string(count) + " tasks");
      std::vector<std::atomic<int>> done(count);
      std::vector<std::vector<std::size_t>> taken(8);
      std::atomic<int> strangers = 0;
      const auto caller = std::this_thread::get_id();
      for_each_task(threads, count, [&](int who, std::size_t task) {
        ++done[task];
        if (who < 0 || who >= std::max(1, threads) || (who == 0) != (std::this_thread::get_id() == caller)) {
          ++strangers;
          return;
        }
        taken[static_cast<std::size_t>(who)].push_back(task);
      });
      EXPECT_EQ(strangers, 0) << "thread 0 is the caller's, and there are no more than wanted";
      for (const auto& d : done) EXPECT_EQ(d, 1);
      for (const auto& tasks : taken) EXPECT_TRUE(std::is_sorted(tasks.begin(), tasks.end()));
    }
  }
}

TEST(Parallel, TasksRunAtTheSameTime) {
  std::atomic<int> arrived = 0;
  std::atomic<bool> met = true;
  for_each_task(3, 3, [&](int, std::size_t) {
    ++arrived;
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (arrived < 3 && std::chrono::steady_clock::now() < end) std::this_thread::yield();
    if (arrived < 3) met = false;
  });
  EXPECT_TRUE(met);
}

TEST(Parallel, WhatATaskThrowsReachesTheCallerAndNoTaskBeginsAfterwards) {
  for (const int threads : {1, 4}) {
    SCOPED_TRACE(threads);
    std::atomic<bool> thrown = false;
    std::atomic<int> after = 0;
    const auto work = [&](int, std::size_t task) {
      if (task == 5) {
        thrown = true;
        throw std::runtime_error("the fifth");
      }
      if (task < 5) return;
      while (!thrown) std::this_thread::yield();
      ++after;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    };
    try {
      for_each_task(threads, 2000, work);
      ADD_FAILURE() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "the fifth");
    }
    EXPECT_LE(after, threads == 1 ? 0 : 1000) << "only those that were about to begin";
  }
}

TEST(Parallel, OfManyThrowsTheCallerGetsOne) {
  EXPECT_THROW(for_each_task(4, 100, [](int, std::size_t) { throw std::runtime_error("each"); }), std::runtime_error);
}

}  // namespace
}  // namespace talus::support
