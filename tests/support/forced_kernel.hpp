#pragma once
// Runs a test with a kernel of our choice.

#include <cstdlib>
#include <optional>
#include <string>

namespace talus::support {

/// TALUS_KERNEL as long as this lives; afterwards what it was.
class ForcedKernel {
 public:
  explicit ForcedKernel(const std::string& name) {
    if (const char* before = std::getenv("TALUS_KERNEL")) before_ = before;
    ::setenv("TALUS_KERNEL", name.c_str(), 1);
  }
  ~ForcedKernel() { before_ ? ::setenv("TALUS_KERNEL", before_->c_str(), 1) : ::unsetenv("TALUS_KERNEL"); }
  ForcedKernel(const ForcedKernel&) = delete;
  ForcedKernel& operator=(const ForcedKernel&) = delete;

 private:
  std::optional<std::string> before_;
};

}  // namespace talus::support
