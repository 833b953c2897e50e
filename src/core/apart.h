// Work in a process of its own, for libraries that damaged files can crash, hang or fill the memory with.
#pragma once

#include <functional>
#include <string>

namespace cairn {

/// What `work` returns, done in a child process with at most `seconds` of computing and 8 GB of memory.
/// @throws InputError with the message of what was thrown there, or one that says how the child ended.
std::string run_apart(const std::function<std::string()>& work, double seconds = 60.0);

}  // namespace cairn
