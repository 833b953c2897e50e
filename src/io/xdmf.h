// The sidecar by which ParaView opens a result file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "io/results.h"

namespace cairn {

/// FILE.xdmf beside a result file: in time, the spheres of every snapshot that has the field sphere_position
/// (N x 3, m), each with the constants in /spheres and the snapshot's own fields whose axis is "sphere". Of
/// several snapshots at one time the later ones are shown a billionth later, because ParaView tells snapshots
/// apart by their times. Replaces an older sidecar, and nothing else.
class Sidecar {
 public:
  /// Takes in what has been committed since the last call; writes when that is a sixteenth of all snapshots
  /// (so that the work of a long run does not grow with the square of their number), when bodies have
  /// changed, or at the end of the run. Throws InputError.
  void update(const ResultFile& result);
  /// The same, and writes in any case. Returns the sidecar's name.
  std::filesystem::path write(const ResultFile& result);

 private:
  void take_in(const ResultFile& result);

  std::string grids_;                                       ///< the text of the snapshots taken in
  std::size_t taken_ = 0;                                   ///< snapshots
  std::size_t shown_ = 0;                                   ///< of them, in the sidecar that was last written
  double time_ = -std::numeric_limits<double>::infinity();  ///< of the last one, as shown (s)
  std::optional<std::uint64_t> epoch_;                      ///< of the last one
  std::string constants_group_;                             ///< of that epoch
  std::vector<DatasetInfo> constants_;
};

/// Throws InputError when something else than a sidecar of this program has the name of a result's sidecar.
void require_sidecar(const std::filesystem::path& result);

}  // namespace cairn
