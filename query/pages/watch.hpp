#pragma once
// What a question is held to while it is worked on.

#include <atomic>
#include <cstdint>
#include <functional>
#include <stop_token>

#include "talus/question.hpp"

namespace talus {

/// Ends a question that its caller has cancelled or that needs more than it may, and tells how far it is. Looking costs
/// one load: it is done for each page and for each triangle that is held against samples.
///
/// Threads: all may call look() and the add functions; only the asking one may call stage() and tell().
class Watch {
 public:
  /// A question that may go on for as long as it likes.
  Watch() = default;
  explicit Watch(const Question& question)
      : stop_(question.stop), progress_(question.progress), limits_(question.limits) {}
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// fails  cancelled
  void look() const {
    if (stop_.stop_requested()) cancel();
  }
  /// Counts what the answer and the work on it take, before it is asked of the system.
  /// fails  too_large
  void add_bytes(std::uint64_t bytes);
  /// What was counted and is free again.
  void give_back(std::uint64_t bytes);
  /// Counts vertices of the answer; `require_vertices` has the count already.
  /// fails  too_large
  void add_vertices(std::uint64_t vertices);
  void require_vertices(std::uint64_t vertices) const;

  /// While one lives, vertices are counted by the bytes they take alone: they are not the answer's.
  class Aside {
   public:
    explicit Aside(Watch& watch) : watch_(watch) { watch_.is_aside_ = true; }
    ~Aside() { watch_.is_aside_ = false; }
    Aside(const Aside&) = delete;
    Aside& operator=(const Aside&) = delete;

   private:
    Watch& watch_;
  };

  /// What follows is this stage, and goes from one share of the whole work to another.
  void stage(const char* name, double from, double to);
  /// A share of the stage, 0 to 1. Looks first; passes on what the caller's function throws.
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

/// Nobody waits for it and it has no limits: for questions that Talus asks itself. It counts nothing, so that any
/// number of threads may share it.
[[nodiscard]] Watch& unwatched();

/// Bytes of a sealed mask over a region.
[[nodiscard]] std::uint64_t bytes_of_mask(GridRect region);
/// Bytes of a vertex: as it was found, and in the quadtree.
inline constexpr std::uint64_t kBytesAVertex = 26;

}  // namespace talus
