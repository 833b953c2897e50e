// Work in a process of its own, for libraries that damaged files can crash, hang or fill the memory with.
#pragma once

#include <functional>
#include <string>

#include "core/error.h"

namespace cairn {

/// The child crashed, left without an answer or ran out of memory.
class BrokeDown : public InputError {
 public:
  using InputError::InputError;
};

/// What `work` returns, done in a child process with at most `seconds` of computing and 8 GB of memory.
/// @throws InputError with the message of what was thrown there, or one that says how the child ended (a
/// BrokeDown where that was not the limit of time).
std::string run_apart(const std::function<std::string()>& work, double seconds = 60.0);

}  // namespace cairn
