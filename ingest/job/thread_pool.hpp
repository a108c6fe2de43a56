#pragma once
// Threads that share a queue of work.

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace talus {

/// Work is begun in the order given. The destructor drops waiting work and waits for running work.
class ThreadPool {
 public:
  explicit ThreadPool(unsigned threads) {
    for (unsigned i = 0; i < threads; ++i) {
      threads_.emplace_back([this, i](const std::stop_token& stop) { work(stop, i); });
    }
  }
  ~ThreadPool() {
    for (std::jthread& thread : threads_) thread.request_stop();
    ready_.notify_all();
  }
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  /// work(thread number, from 0). The future holds its result or its exception.
  template <class Work>
  [[nodiscard]] auto give(Work work) {
    using Result = decltype(work(0u));
    auto task = std::make_shared<std::packaged_task<Result(unsigned)>>(std::move(work));
    std::future<Result> result = task->get_future();
    {
      const std::lock_guard lock(mutex_);
      waiting_.emplace_back([task](unsigned who) { (*task)(who); });
    }
    ready_.notify_one();
    return result;
  }

 private:
  void work(const std::stop_token& stop, unsigned who) {
    for (;;) {
      std::function<void(unsigned)> next;
      {
        std::unique_lock lock(mutex_);
        if (!ready_.wait(lock, stop, [&] { return !waiting_.empty(); }) || stop.stop_requested()) return;
        next = std::move(waiting_.front());
        waiting_.pop_front();
      }
      next(who);
    }
  }

  std::mutex mutex_;
  std::condition_variable_any ready_;
  std::deque<std::function<void(unsigned)>> waiting_;
  std::vector<std::jthread> threads_;  // last: threads end before the members they use
};

}  // namespace talus
