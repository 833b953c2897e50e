#include "core/apart.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>

namespace cairn {
namespace {

constexpr rlim_t kBytes = rlim_t{8} << 30;
#if defined(__SANITIZE_ADDRESS__)
constexpr bool kSanitized = true;
#elif defined(__has_feature)
constexpr bool kSanitized = __has_feature(address_sanitizer);  // which reserves terabytes
#else
constexpr bool kSanitized = false;
#endif
constexpr char kResult = 'R', kComplaint = 'C', kMemory = 'M';  // first byte of what the child sends

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

[[noreturn]] void run_child(const std::function<std::string()>& work, double seconds, int to) {
  for (const int signal : {SIGINT, SIGTERM, SIGSEGV, SIGABRT, SIGPROF}) std::signal(signal, SIG_DFL);
  double whole = 0.0;
  const double part = std::modf(seconds, &whole);
  const itimerval time{{0, 0}, {static_cast<time_t>(whole), static_cast<suseconds_t>(1e6 * part)}};
  setitimer(ITIMER_PROF, &time, nullptr);  // ends the child by SIGPROF
  const rlimit bytes{kBytes, kBytes};
  if (!kSanitized) setrlimit(RLIMIT_AS, &bytes);
  if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0)
    dup2(nowhere, STDERR_FILENO);  // what breaks down says so at length
  std::string answer;
  try {
    answer = kResult + work();
  } catch (const InputError& error) {
    answer = kComplaint + std::string(error.what());
  } catch (const std::bad_alloc&) {
    answer = kMemory;
  } catch (const std::exception& error) {
    answer = kComplaint + std::string("cannot be read: ") + error.what();
  }
  write_all(to, answer);
  _exit(0);  // without the destructors and buffers of the parent
}

}  // namespace

std::string run_apart(const std::function<std::string()>& work, double seconds) {
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
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF)
    throw InputError("cannot be read: it takes more than {:g} s", seconds);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || answer.empty())
    throw BrokeDown("cannot be read: the reader broke down over it");
  if (answer.front() == kMemory) throw BrokeDown("cannot be read: it takes more memory than there is");
  if (answer.front() == kComplaint) throw InputError("{}", answer.substr(1));
  return answer.substr(1);
}

}  // namespace cairn
