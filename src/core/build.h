// Which program this is.
#pragma once

#include <string>

namespace cairn {

/// Compiler, promise of bits and the linker's number of this very build: "GCC 12.2.0, fused multiply-adds,
/// 1f3a5c7e9b2d4f60". Runs of one build and promise give equal bits.
std::string build_name();

}  // namespace cairn
