#pragma once
// Runs independent tasks on several threads.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace talus {

/// 0: as many as the machine has.
[[nodiscard]] inline int threads_or_all(int threads) {
  return threads == 0 ? std::max(1, static_cast<int>(std::thread::hardware_concurrency())) : std::max(1, threads);
}

/// Calls work(who, task) for the tasks 0 to count − 1, starting them in this order. `who` is the number of the thread;
/// 0 is the caller's. After an exception no further task starts, and the caller gets the first exception.
template <class Work>
void for_each_task(int threads, std::size_t count, Work&& work) {
  if (threads <= 1 || count <= 1) {
    for (std::size_t task = 0; task < count; ++task) work(0, task);
    return;
  }
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr thrown;
  const auto run = [&](int who) {
    try {
      for (std::size_t task; (task = next.fetch_add(1, std::memory_order_relaxed)) < count;) work(who, task);
    } catch (...) {
      next.store(count, std::memory_order_relaxed);
      const std::lock_guard lock(mutex);
      if (!thrown) thrown = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (int who = 1; who < threads && static_cast<std::size_t>(who) < count; ++who) others.emplace_back(run, who);
    run(0);
  }
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace talus
