// Preloaded into the program by tests: makes one of its system calls on some files fail, stop half way, or be
// its last.
//   FAULT_PATHS  calls on files whose whole path begins so are counted, from 1
//   FAULT_CALL   only those of this name, if set
//   FAULT_LOG    the name of every counted call is added to this file, one a line
//   FAULT_AT     the call that is touched
//   FAULT_DEED   kill_before, kill_after, torn (half is written, then killed), short, or a number of errno
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

enum deed { nothing, kill_before, kill_after, torn, less, failure };

static int counted(const char* path) {
  const char* begin = getenv("FAULT_PATHS");
  if (begin == NULL || path == NULL) return 0;
  char full[8192];
  if (path[0] != '/') {
    if (getcwd(full, 4096) == NULL) return 0;
    strncat(full, "/", 2);
    strncat(full, path, 4000);
    path = full;
  }
  return strncmp(path, begin, strlen(begin)) == 0;
}

static int counted_file(int fd) {
  char link[64], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t size = readlink(link, path, sizeof path - 1);
  if (size < 0) return 0;
  path[size] = '\0';
  return counted(path);
}

static void die(void) {
  kill(getpid(), SIGKILL);
  for (;;) pause();
}

/// Counts a call and says what becomes of it.
static enum deed count(const char* name) {
  static long calls = 0;
  if (getenv("CAIRN_TUNED") == NULL) return nothing;  // the program starts itself anew
  const char* only = getenv("FAULT_CALL");
  if (only != NULL && strcmp(only, name) != 0) return nothing;
  const long call = __atomic_add_fetch(&calls, 1, __ATOMIC_SEQ_CST);
  const char *log = getenv("FAULT_LOG"), *at = getenv("FAULT_AT"), *what = getenv("FAULT_DEED");
  if (log != NULL) {
    char line[64];
    const int size = snprintf(line, sizeof line, "%s\n", name);
    const int fd = (int)syscall(SYS_openat, AT_FDCWD, log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    if (syscall(SYS_write, fd, line, size) != size) die();
    syscall(SYS_close, fd);
  }
  if (at == NULL || what == NULL || call != atol(at)) return nothing;
  if (strcmp(what, "kill_before") == 0) die();
  if (strcmp(what, "kill_after") == 0) return kill_after;
  if (strcmp(what, "torn") == 0) return torn;
  if (strcmp(what, "short") == 0) return less;
  errno = atoi(what);
  return failure;
}

#define REAL(name)        \
  __typeof__(&name) real; \
  *(void**)&real = dlsym(RTLD_NEXT, #name)

/// The call, or what becomes of it; `part` is the call with half of the bytes.
#define WITH_FAULT(type, is_counted, name, call, part)                \
  const enum deed deed = (is_counted) ? count(name) : nothing;        \
  if (deed == failure) return (type)-1;                               \
  const type result = deed == torn || deed == less ? (part) : (call); \
  if (deed == kill_after || deed == torn) die();                      \
  return result

ssize_t write(int fd, const void* data, size_t size) {
  REAL(write);
  WITH_FAULT(ssize_t, counted_file(fd), "write", real(fd, data, size), real(fd, data, (size + 1) / 2));
}
ssize_t pwrite(int fd, const void* data, size_t size, off_t at) {
  REAL(pwrite);
  WITH_FAULT(ssize_t, counted_file(fd), "pwrite", real(fd, data, size, at),
             real(fd, data, (size + 1) / 2, at));
}
ssize_t pread(int fd, void* data, size_t size, off_t at) {
  REAL(pread);
  WITH_FAULT(ssize_t, counted_file(fd), "pread", real(fd, data, size, at),
             real(fd, data, (size + 1) / 2, at));
}
ssize_t copy_file_range(int from, off64_t* in, int to, off64_t* out, size_t size, unsigned flags) {
  REAL(copy_file_range);
  WITH_FAULT(ssize_t, counted_file(to), "copy_file_range", real(from, in, to, out, size, flags),
             real(from, in, to, out, 100, flags));
}
int ftruncate(int fd, off_t size) {
  REAL(ftruncate);
  WITH_FAULT(int, counted_file(fd), "ftruncate", real(fd, size), real(fd, size));
}
int fsync(int fd) {
  REAL(fsync);
  WITH_FAULT(int, counted_file(fd), "fsync", real(fd), real(fd));
}
int fchmod(int fd, mode_t mode) {
  REAL(fchmod);
  WITH_FAULT(int, counted_file(fd), "fchmod", real(fd, mode), real(fd, mode));
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  REAL(renameat2);
  WITH_FAULT(int, counted(to), "rename", real(from_folder, from, to_folder, to, flags),
             real(from_folder, from, to_folder, to, flags));
}
int unlink(const char* path) {
  REAL(unlink);
  WITH_FAULT(int, counted(path), "unlink", real(path), real(path));
}
int open(const char* path, int flags, ...) {
  REAL(open);
  mode_t mode = 0;
  if (flags & (O_CREAT | O_TMPFILE)) {
    va_list more;
    va_start(more, flags);
    mode = va_arg(more, mode_t);
    va_end(more);
  }
  WITH_FAULT(int, counted(path), "open", real(path, flags, mode), real(path, flags, mode));
}
