#pragma once
// Float exceptions that should not be: numbers that are none, division by zero, overflow.

#include <cfenv>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace talus::support {

/// Watches the calling thread, and every thread that is started meanwhile, as long as this lives; one at a time.
///
/// On x86-64 with glibc the processor stops at the first such instruction of each thread, which is noted and goes on as
/// if nobody had looked. Elsewhere only the calling thread's flags are read.
///
/// kinds  FE_INVALID, FE_DIVBYZERO, FE_OVERFLOW
class FloatExceptions {
 public:
  explicit FloatExceptions(int kinds = FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
  ~FloatExceptions();
  FloatExceptions(const FloatExceptions&) = delete;
  FloatExceptions& operator=(const FloatExceptions&) = delete;

  /// Their names so far and where the first was met; empty: none.
  [[nodiscard]] std::string seen() const;

 private:
  int kinds_;
  std::fenv_t before_{};
};

/// What `work` returns; the running test fails if a float exception was met on the way.
template <class Work>
auto without_float_exceptions(Work&& work, int kinds = FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW) {
  const FloatExceptions watched(kinds);
  auto result = std::forward<Work>(work)();
  EXPECT_EQ(watched.seen(), "") << "a float exception";
  return result;
}

}  // namespace talus::support
