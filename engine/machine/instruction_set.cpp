#include "engine/machine/instruction_set.hpp"

#include <cstdlib>
#include <string>
#include <vector>

#include "engine/machine/fail.hpp"

namespace talus {
namespace {

std::vector<InstructionSet> supported() {
  std::vector<InstructionSet> sets{InstructionSet::portable};
#if defined(__x86_64__)
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
                    __builtin_cpu_supports("popcnt");
  const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512vbmi") && __builtin_cpu_supports("avx512vbmi2") &&
                      __builtin_cpu_supports("avx512bitalg") && __builtin_cpu_supports("avx512vpopcntdq");
  if (avx2) sets.push_back(InstructionSet::avx2);
  if (avx512) sets.push_back(InstructionSet::avx512);
#endif
  return sets;
}

}  // namespace

std::string_view to_string(InstructionSet set) {
  switch (set) {
    case InstructionSet::portable: return "portable";
    case InstructionSet::avx2: return "avx2";
    case InstructionSet::avx512: return "avx512";
  }
  return "unknown";
}

std::span<const InstructionSet> instruction_sets_here() {
  static const std::vector<InstructionSet> sets = supported();
  return sets;
}

InstructionSet instruction_set() {
  const std::span<const InstructionSet> here = instruction_sets_here();
  const char* wanted = std::getenv("TALUS_KERNEL");
  if (wanted == nullptr || *wanted == '\0') return here.back();
  std::string names;
  for (const InstructionSet set : here) {
    if (to_string(set) == wanted) return set;
    names += (names.empty() ? "" : ", ") + std::string(to_string(set));
  }
  refuse("TALUS_KERNEL is {}: choose one that this machine has: {}", wanted, names);
}

bool has_slow_pext() {
#if defined(__x86_64__)
  return __builtin_cpu_is("znver1") || __builtin_cpu_is("znver2") || __builtin_cpu_is("bdver4");
#else
  return false;
#endif
}

}  // namespace talus
