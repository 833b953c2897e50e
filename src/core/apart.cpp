#include "core/apart.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "core/error.h"

namespace cairn {
namespace {

constexpr rlim_t kBytes = rlim_t{8} << 30;
#if defined(__SANITIZE_ADDRESS__) || defined(__clang__)  // clang builds the fuzzers only
constexpr bool kSanitized = true;                        // which reserves terabytes
#else
constexpr bool kSanitized = false;
#endif
constexpr char kResult = 'R', kComplaint = 'C';  // first byte of what the child sends

void write_all(int to, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = write(to, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno != EINTR) _exit(1);
    done += static_cast<std::size_t>(std::max<ssize_t>(n, 0));
  }
}

std::string read_all(int from) {
  std::string bytes;
  char block[1 << 16];
  for (;;) {
    const ssize_t n = read(from, block, sizeof block);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return bytes;
    bytes.append(block, static_cast<std::size_t>(n));
  }
}

[[noreturn]] void run_child(const std::function<std::string()>& work, unsigned seconds, int to) {
  for (const int signal : {SIGINT, SIGTERM, SIGSEGV, SIGABRT}) std::signal(signal, SIG_DFL);
  const rlimit time{seconds, seconds + 1};  // a signal that tells why, then the end
  setrlimit(RLIMIT_CPU, &time);
  const rlimit bytes{kBytes, kBytes};
  if (!kSanitized) setrlimit(RLIMIT_AS, &bytes);
  if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0)
    dup2(nowhere, STDERR_FILENO);  // what breaks down says so at length
  std::string answer;
  try {
    answer = kResult + work();
  } catch (const InputError& error) {
    answer = kComplaint + std::string(error.what());
  } catch (const std::exception& error) {
    answer = kComplaint + std::string("cannot be read: ") + error.what();
  }
  write_all(to, answer);
  _exit(0);  // without the destructors and buffers of the parent
}

}  // namespace

std::string run_apart(const std::function<std::string()>& work, unsigned seconds) {
  int ends[2];
  if (pipe(ends) != 0) throw InputError("no pipe to another process: {}", std::strerror(errno));
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    run_child(work, seconds, ends[1]);
  }
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    throw InputError("no other process: {}", std::strerror(errno));
  }
  const std::string answer = read_all(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || answer.empty())
    throw InputError("cannot be read: {}", WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU
                                               ? fmt::format("it takes more than {} s", seconds)
                                               : "the reader broke down over it");
  if (answer.front() == kComplaint) throw InputError("{}", answer.substr(1));
  return answer.substr(1);
}

}  // namespace cairn
