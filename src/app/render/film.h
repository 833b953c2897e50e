// Films: frames piped into the ffmpeg program.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <vector>

#include "app/render/image.h"
#include "core/safe_file.h"

namespace cairn::render {

/// Writes an H.264 film (yuv420p, BT.709, mp4) frame by frame, so that no film has to fit into memory. The
/// file appears under its name when finish() succeeds; a Film destroyed before leaves nothing behind.
class Film {
 public:
  /// Frames are width x height pixels; an odd side gets its last row or column twice, as H.264 wants even
  /// ones.
  /// @throws InputError when ffmpeg is not installed or the folder is not writable.
  Film(std::filesystem::path path, int width, int height, double frames_per_second = 30.0);
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// @throws InputError for a frame of another size, or with ffmpeg's own words when it has given up.
  void add(const Image& frame);

  /// Closes the file and gives it its name; replaces one that is there. @throws InputError with ffmpeg's own
  /// words when it failed.
  void finish();

 private:
  [[noreturn]] void fail();
  int wait();

  std::filesystem::path path_;
  int width_, height_;
  Replacement next_;
  pid_t child_ = -1;
  FileDescriptor pipe_;    // to ffmpeg's standard input
  FileDescriptor errors_;  // nameless file that takes ffmpeg's standard error
};

/// All frames at once. @throws InputError as Film does, or when there are no frames.
void write_film(const std::vector<Image>& frames, const std::filesystem::path& path,
                double frames_per_second = 30.0);

}  // namespace cairn::render
