#include "tests/support/float_exceptions.hpp"

#include <atomic>
#include <csignal>
#include <sstream>

#if defined(__x86_64__) && defined(__GLIBC__)
#define TALUS_FLOAT_TRAPS
#include <dlfcn.h>
#include <ucontext.h>
#endif

namespace talus::support {
namespace {

#ifdef TALUS_FLOAT_TRAPS

std::atomic<int> met{0};
std::atomic<void*> first_at{nullptr};
struct sigaction handler_before;

/// Notes the exception and masks all of them in the thread that was stopped, so that its instruction goes through.
void note(int, siginfo_t* info, void* context) {
  met |= info->si_code == FPE_FLTDIV ? FE_DIVBYZERO : info->si_code == FPE_FLTOVF ? FE_OVERFLOW : FE_INVALID;
  void* nothing = nullptr;
  first_at.compare_exchange_strong(nothing, info->si_addr);
  auto* const registers = static_cast<ucontext_t*>(context)->uc_mcontext.fpregs;
  registers->mxcsr |= 0x1f80u;                                          // SSE and AVX
  registers->cwd = static_cast<std::uint16_t>(registers->cwd | 0x3fu);  // long double
}

#endif

}  // namespace

FloatExceptions::FloatExceptions(int kinds) : kinds_(kinds) {
  std::fegetenv(&before_);
  std::feclearexcept(FE_ALL_EXCEPT);
#ifdef TALUS_FLOAT_TRAPS
  met = 0;
  first_at = nullptr;
  struct sigaction handler {};
  handler.sa_sigaction = note;
  handler.sa_flags = SA_SIGINFO;
  sigaction(SIGFPE, &handler, &handler_before);
  feenableexcept(kinds_);
#endif
}

FloatExceptions::~FloatExceptions() {
  std::fesetenv(&before_);
#ifdef TALUS_FLOAT_TRAPS
  sigaction(SIGFPE, &handler_before, nullptr);
#endif
}

std::string FloatExceptions::seen() const {
  int all = std::fetestexcept(kinds_);
  std::ostringstream said;
#ifdef TALUS_FLOAT_TRAPS
  all |= met.load();
#endif
  if ((all & FE_INVALID) != 0) said << "invalid ";
  if ((all & FE_DIVBYZERO) != 0) said << "division by zero ";
  if ((all & FE_OVERFLOW) != 0) said << "overflow ";
#ifdef TALUS_FLOAT_TRAPS
  Dl_info object;
  if (void* at = first_at.load(); at != nullptr && dladdr(at, &object) != 0) {
    said << "at " << object.dli_fname << "+0x" << std::hex
         << reinterpret_cast<std::uintptr_t>(at) - reinterpret_cast<std::uintptr_t>(object.dli_fbase);
    if (object.dli_sname != nullptr) said << " in " << object.dli_sname;
  }
#endif
  return said.str();
}

}  // namespace talus::support
