#include "app/standard_streams.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>

#include "core/safe_file.h"

namespace cairn {
namespace {

/// One of the streams that are written.
struct Stream {
  int fd;
  int error = 0;
};

std::array<Stream, 2> g_streams{{{STDOUT_FILENO}, {STDERR_FILENO}}};
bool g_output_was_closed = false, g_pipe_signal_taken = false;

/// For a FILE: writes what it can and says that it has written all.
ssize_t write_or_drop(void* cookie, const char* data, std::size_t size) {
  Stream& stream = *static_cast<Stream*>(cookie);
  for (std::size_t done = 0; done < size;) {
    const ssize_t put = uninterrupted([&] { return write(stream.fd, data + done, size - done); });
    if (put < 0 && errno == EAGAIN) {  // somebody has made a shared terminal or pipe non-blocking
      pollfd ready{stream.fd, POLLOUT, 0};
      poll(&ready, 1, -1);
      continue;
    }
    if (put <= 0) {
      if (stream.error == 0) stream.error = put < 0 ? errno : EIO;
      break;
    }
    done += static_cast<std::size_t>(put);
  }
  return static_cast<ssize_t>(size);
}

void guard(FILE*& file, Stream& stream, int buffering) {
  FILE* guarded = fopencookie(&stream, "w", {nullptr, write_or_drop, nullptr, nullptr});
  if (guarded == nullptr) return;
  std::setvbuf(guarded, nullptr, buffering, BUFSIZ);
  file = guarded;
}

}  // namespace

void guard_standard_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(fd, F_GETFD) != -1 || errno != EBADF) continue;
    if (fd == STDOUT_FILENO) g_output_was_closed = true;
    if (open("/dev/null", O_RDONLY) != fd) _exit(2);  // nothing can be said, and nothing is safe
  }
  guard(stdout, g_streams[0], isatty(STDOUT_FILENO) != 0 ? _IOLBF : _IOFBF);
  guard(stderr, g_streams[1], _IONBF);
  struct sigaction now {};
  if (sigaction(SIGPIPE, nullptr, &now) == 0 && (now.sa_flags & SA_SIGINFO) == 0 && now.sa_handler == SIG_DFL)
    g_pipe_signal_taken = std::signal(SIGPIPE, SIG_IGN) != SIG_ERR;
  survive_file_size_limit();
}

OutputEnd end_of_output() {
  std::fflush(stdout);
  const int error = g_streams[0].error;
  return {error, g_output_was_closed, error == EPIPE && g_pipe_signal_taken};
}

}  // namespace cairn
