#include "app/render/film.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <string>

#include "core/error.h"

namespace cairn::render {
namespace {

constexpr int kOutput = 3;  // the descriptor of the film in ffmpeg

/// The last line of a file that is not empty.
std::string last_line(int file) {
  std::string text(4096, '\0');
  const off_t size = ::lseek(file, 0, SEEK_END);
  const off_t from = std::max<off_t>(0, size - static_cast<off_t>(text.size()));
  const ssize_t count = ::pread(file, text.data(), text.size(), from);
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(0, count)));
  text.erase(text.find_last_not_of(" \r\n") + 1);
  const std::size_t start = text.find_last_of("\r\n");
  return start == std::string::npos ? text : text.substr(start + 1);
}

int even(int side) {
  return side + side % 2;
}

std::vector<std::string> arguments(int width, int height, double rate) {
  return {"ffmpeg", "-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo", "-pixel_format", "rgb24",
          "-video_size", fmt::format("{}x{}", even(width), even(height)), "-framerate",
          fmt::format("{}", rate), "-i", "pipe:0", "-an", "-c:v", "libx264", "-preset", "medium", "-crf",
          "17", "-vf", "scale=out_color_matrix=bt709:out_range=tv", "-pix_fmt", "yuv420p", "-colorspace",
          "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-movflags", "+faststart", "-f", "mp4",
          // By descriptor: whatever becomes of names meanwhile, only the file that we have made is written.
          fmt::format("file:/proc/self/fd/{}", kOutput)};
}

/// Starts ffmpeg with the given standard input and error, and the file to write; returns 0 or an errno.
int spawn(pid_t& child, int input, int errors, int output, std::vector<std::string> words) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, errors, STDERR_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output, kOutput);
  const int result = ::posix_spawnp(&child, "ffmpeg", &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return result;
}

}  // namespace

Film::Film(std::filesystem::path path, int width, int height, double frames_per_second)
    : path_(std::move(path)), width_(width), height_(height), next_(path_) {
  if (width < 2 || height < 2 || !std::isfinite(frames_per_second) || frames_per_second <= 0.0)
    throw InputError("cannot make {}: a film of {} x {} pixels and {} frames per second", path_.string(),
                     width, height, frames_per_second);
  require_writable(path_, true);
  remove_leftovers(path_);
  errors_ = FileDescriptor(::memfd_create("ffmpeg", MFD_CLOEXEC));
  // A socket and not a pipe: writing to a dead ffmpeg is then an error and no SIGPIPE, in any thread.
  int ends[2] = {-1, -1};
  int result = 0;
  if (!errors_ || ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) result = errno;
  pipe_ = FileDescriptor(ends[0]);
  const FileDescriptor input(ends[1]);
  if (result == 0)
    result =
        spawn(child_, input.get(), errors_.get(), next_.fd(), arguments(width, height, frames_per_second));
  if (result == 0) return;
  child_ = -1;
  if (result == ENOENT)
    throw InputError("cannot make {}: the program ffmpeg is not installed", path_.string());
  throw InputError("cannot make {}: ffmpeg does not start: {}", path_.string(), reason(result));
}

Film::~Film() {
  if (child_ < 0) return;
  ::kill(child_, SIGKILL);
  wait();
}

int Film::wait() {
  pipe_ = FileDescriptor{};
  int status = 0;
  uninterrupted([&] { return ::waitpid(child_, &status, 0); });
  child_ = -1;
  return status;
}

void Film::fail() {
  if (child_ >= 0) wait();
  const std::string words = last_line(errors_.get());
  throw InputError("cannot make {}: ffmpeg failed: {}", path_.string(),
                   words.empty() ? "no reason given" : words);
}

void Film::add(const Image& frame) {
  if (child_ < 0) throw InputError("cannot add to {}: the film is finished", path_.string());
  if (frame.width != width_ || frame.height != height_)
    throw InputError("cannot make {}: a frame of {} x {} pixels in a film of {} x {}", path_.string(),
                     frame.width, frame.height, width_, height_);
  const std::size_t row = 3 * static_cast<std::size_t>(even(width_));
  std::vector<std::uint8_t> bytes(row * static_cast<std::size_t>(even(height_)));
  for (int y = 0; y < even(height_); ++y) {
    const std::uint8_t* from = frame.pixel(0, std::min(y, height_ - 1));
    std::uint8_t* to = &bytes[row * static_cast<std::size_t>(y)];
    std::copy_n(from, 3 * width_, to);
    if (width_ % 2 == 1) std::copy_n(from + 3 * (width_ - 1), 3, to + 3 * width_);
  }
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t count = uninterrupted(
        [&] { return ::send(pipe_.get(), bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL); });
    if (count <= 0) fail();
    sent += static_cast<std::size_t>(count);
  }
}

void Film::finish() {
  if (child_ < 0) return;
  if (wait() != 0) fail();
  next_.install(true);
  sync_folder(path_);
}

void write_film(const std::vector<Image>& frames, const std::filesystem::path& path,
                double frames_per_second) {
  if (frames.empty()) throw InputError("cannot make {}: there are no frames", path.string());
  Film film(path, frames.front().width, frames.front().height, frames_per_second);
  for (const Image& frame : frames) film.add(frame);
  film.finish();
}

}  // namespace cairn::render
