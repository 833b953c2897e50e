// Standard input, output and error that can neither get in the way of the program's files nor stop it.
#pragma once

namespace cairn {

/// To be called before any file is opened. Afterwards
/// * descriptors 0, 1 and 2 are open, so that no file of the program takes their place and gets what was
///   meant for the user; what is written to one that was closed still fails;
/// * whatever cannot be written to stdout or stderr (a full disk, a reader that has gone) is dropped and
///   remembered: nothing that prints sees it;
/// * neither SIGPIPE nor SIGXFSZ ends the program, unless the caller handles them.
void guard_standard_streams();

/// What has become of standard output.
struct OutputEnd {
  int error = 0;                ///< of the first write that failed; 0: everything has arrived
  bool was_closed = false;      ///< from the start
  bool ask_for_signal = false;  ///< the reader has gone, and has not asked for SIGPIPE to be ignored
};

/// Writes out what is still held back.
OutputEnd end_of_output();

}  // namespace cairn
