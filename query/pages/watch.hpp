#pragma once
// Stop token, limits and progress of a question that Talus works on.

#include <atomic>
#include <cstdint>
#include <functional>
#include <stop_token>

#include "talus/question.hpp"

namespace talus {

/// Ends a question that its caller has cancelled or that exceeds its limits, and reports progress. look() costs one
/// load. It is called for each page, and for each triangle that is compared with samples.
///
/// Threads: all may call look() and the add functions. Only the thread that asks may call stage() and tell().
class Watch {
 public:
  /// A question without limits, which nobody can cancel.
  Watch() = default;
  explicit Watch(const Question& question)
      : stop_(question.stop), progress_(question.progress), limits_(question.limits) {}
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// fails  cancelled
  void look() const {
    if (stop_.stop_requested()) cancel();
  }
  /// Counts memory for the answer and the work on it, before it is allocated.
  /// fails  too_large
  void add_bytes(std::uint64_t bytes);
  /// Subtracts memory that was counted and is free again.
  void give_back(std::uint64_t bytes);
  /// Counts vertices of the answer. require_vertices() only checks a count.
  /// fails  too_large
  void add_vertices(std::uint64_t vertices);
  void require_vertices(std::uint64_t vertices) const;

  /// While it exists, vertices count for the memory limit only, because they are not in the answer.
  class Aside {
   public:
    explicit Aside(Watch& watch) : watch_(watch) { watch_.is_aside_ = true; }
    ~Aside() { watch_.is_aside_ = false; }
    Aside(const Aside&) = delete;
    Aside& operator=(const Aside&) = delete;

   private:
    Watch& watch_;
  };

  /// Begins a stage of the work. `from` and `to` are its shares of the whole work, 0 to 1.
  void stage(const char* name, double from, double to);
  /// Reports a share of the stage, 0 to 1, after a look(). The caller's function may throw.
  void tell(double share);

 private:
  [[noreturn]] static void cancel();

  std::stop_token stop_;
  std::function<void(double, const char*)> progress_;
  Limits limits_;
  std::atomic<std::uint64_t> bytes_ = 0, vertices_ = 0;
  bool is_aside_ = false;
  const char* stage_ = "";
  double from_ = 0, to_ = 1, told_ = -1;
};

/// A watch without limits, for questions that Talus asks itself. It counts nothing, so any number of threads may share
/// it.
[[nodiscard]] Watch& unwatched();

/// Memory of a sealed mask over a region.
[[nodiscard]] std::uint64_t bytes_of_mask(GridRect region);
/// Memory of a vertex, in the list of found vertices and in the quadtree together.
inline constexpr std::uint64_t kBytesAVertex = 26;

}  // namespace talus
