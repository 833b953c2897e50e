// Which instruction set the hot code runs with.
#pragma once

#include <string>
#include <vector>

namespace cairn {

/// Whether this processor has what all of the program needs: x86-64-v2, that is SSE4.2, on x86-64.
bool processor_suffices();

/// Those that this program has code for and this processor can run, the best first: "AVX-512", "AVX2",
/// "SSE4", "NEON".
std::vector<std::string> instruction_sets();

/// The one in use. Those with fused multiply-adds, all but SSE4, give equal bits.
std::string instruction_set();

/// Which runs give equal bits with one in use now: "fused multiply-adds", on whatever processor, or "no fused
/// multiply-adds".
std::string promise_of_bits();

/// From now on the one that the variable CAIRN_INSTRUCTION_SET names, if it is set.
/// @throws InputError as use_instruction_set.
void obey_environment();

/// From now on the one of this name; for tests and measurements.
/// @throws InputError when it is not one of `instruction_sets`.
void use_instruction_set(const std::string& name);

}  // namespace cairn
