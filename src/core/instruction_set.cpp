#include "core/instruction_set.h"

#include <fmt/ranges.h>
#include <hwy/highway.h>

#include <cstdlib>

#include "core/error.h"

namespace cairn {

namespace {

const char* name_of(std::int64_t target) {
  switch (target) {
    case HWY_AVX3:
      return "AVX-512";
    case HWY_AVX2:
      return "AVX2";
    case HWY_SSE4:
      return "SSE4";
    default:
      return hwy::TargetName(target);
  }
}

/// Those of the program on this processor, the best first.
std::vector<std::int64_t> targets() {
  static const std::vector<std::int64_t> all = hwy::SupportedAndGeneratedTargets();
  return all;
}

}  // namespace

bool processor_suffices() {
#if defined(__x86_64__) && !defined(__clang__)
  return __builtin_cpu_supports("x86-64-v2") != 0;
#else
  return true;
#endif
}

std::vector<std::string> instruction_sets() {
  std::vector<std::string> out;
  for (const std::int64_t target : targets()) out.emplace_back(name_of(target));
  return out;
}

std::string instruction_set() {
  return name_of(hwy::SupportedAndGeneratedTargets().front());
}

std::string promise_of_bits() {
  return instruction_set() == "SSE4" ? "no fused multiply-adds" : "fused multiply-adds";
}

void obey_environment() {
  if (const char* name = std::getenv("CAIRN_INSTRUCTION_SET"); name != nullptr && *name != '\0')
    use_instruction_set(name);
}

void use_instruction_set(const std::string& name) {
  for (const std::int64_t target : targets()) {
    if (name_of(target) != name) continue;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    return;
  }
  throw InputError("instruction set '{}': expected one of {}", name, fmt::join(instruction_sets(), ", "));
}

}  // namespace cairn
