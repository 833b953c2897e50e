// Which program this is.
#pragma once

#include <string>

namespace cairn {

/// Compiler, instruction set and the linker's number of this very build: "GCC 12.2.0, AVX-512,
/// 1f3a5c7e9b2d4f60". Runs of one build give equal bits.
std::string build_name();

}  // namespace cairn
