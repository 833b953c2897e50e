// The result file of a run: constants, snapshots, time series and the checkpoint, in one HDF5 file.
//
//   /                 attributes: format, format_version, finished, outcome, and those given to create()
//   /<group>          constants: /bodies, /spheres, ...
//   /<group>_<epoch>  the same of the bodies before a stage changed them, for the snapshots of that epoch
//   /snapshots/000000 one group each, attributes time (s), stage and epoch
//   /series           one dataset per column
//   /checkpoint       the state to continue from
//
// Datasets carry the attributes unit, help, axis and xxh3_128, the checksum of their bytes; that of the
// root's attributes (but scene, which has its own) is the root's. Equal results are equal files. Everything
// reads with any HDF5 1.10 or newer.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/safe_file.h"
#include "io/checksum.h"
#include "io/fields.h"

namespace cairn {

struct SeriesColumn {
  std::string name, unit, help;
};

struct SnapshotInfo {
  double time = 0.0;  ///< s
  std::string stage;
  std::uint64_t epoch = 0;  ///< how often bodies had been changed or taken away
};

/// What is added waits in memory until commit(), which writes all of it or nothing; only then can it be read.
/// A commit costs what is new: the version before the last stays beside the file, under a temporary name, and
/// becomes the next one, unless somebody is reading it.
/// Errors of the file are InputError with one line: file, object, reason. Not for use by several threads at
/// once.
class ResultFile {
 public:
  /// A new file; nothing is at `path` until the first commit. Checks now that it can be written there, and
  /// that nothing is there unless `overwrite`. `attributes` holds single values.
  static ResultFile create(const std::filesystem::path& path, const FieldTable& attributes, bool overwrite);
  /// For reading only; several processes may, also while another one writes.
  static ResultFile open(const std::filesystem::path& path);
  /// For reading what is left of a damaged file: of the snapshots only whole ones, the rest as it comes.
  static ResultFile open_damaged(const std::filesystem::path& path);
  /// For reading and adding; no other process can do the same meanwhile.
  static ResultFile open_to_continue(const std::filesystem::path& path);

  /// Replaces attributes given to create().
  void write_attributes(const FieldTable& attributes);
  /// Adds a group of constants; replaces the one of that name.
  void write_static(const std::string& group, const FieldTable& table);
  void add_snapshot(double time, const std::string& stage, const FieldTable& table, std::uint64_t epoch = 0);
  /// Once, before the first row. A file that has columns already must have the same ones.
  void declare_series(const std::vector<SeriesColumn>& columns);
  /// One value per column.
  void add_series_row(std::span<const double> values);

  /// Bytes that wait in memory for the next commit.
  std::uint64_t waiting() const { return waiting_; }

  /// Writes what was added and replaces the checkpoint. The file is at every moment the old or the new one,
  /// also if the process is killed; the new one is read back before it takes the old one's place. After a
  /// failure (a full disk) the old file is untouched, everything added is still waiting, and commit may be
  /// called again.
  void commit(const FieldTable& checkpoint);
  /// The same, but leaves checkpoint, finished and outcome as they are.
  void commit();
  /// Ends a run that cannot go on: leaves the checkpoint as it is, sets finished and `outcome` (one line).
  void abandon(const std::string& outcome);
  /// The last commit of a run: sets finished and `outcome` (one line). A later commit(checkpoint) unsets
  /// both.
  void finish(const FieldTable& checkpoint, const std::string& outcome);

  const std::filesystem::path& path() const { return path_; }
  bool finished() const { return finished_; }
  const std::string& outcome() const { return outcome_; }
  /// Whether the attribute `scene` is the text that was written.
  bool scene_is_as_written() const { return scene_as_written_; }
  /// The committed ones, in order.
  const std::vector<SnapshotInfo>& snapshots() const { return snapshots_; }

  void read_attributes(const FieldTable& table) const;
  bool has_group(const std::string& group) const;
  void read_static(const std::string& group, const FieldTable& table) const;
  /// The group of constants that belongs to snapshots of an epoch: `group`, or what it was before.
  std::string constants(const std::string& group, std::uint64_t epoch) const;
  void read_snapshot(std::size_t k, const FieldTable& table) const;
  bool has_checkpoint() const { return has_group("checkpoint"); }
  void read_checkpoint(const FieldTable& table) const;
  const std::vector<SeriesColumn>& series_columns() const { return columns_; }
  std::vector<double> read_series(const std::string& column) const;
  /// The datasets directly in a group ("spheres"), or in the group of snapshot k.
  std::vector<DatasetInfo> list(const std::string& group) const;
  std::vector<DatasetInfo> list_snapshot(std::size_t k) const;

 private:
  struct Group {
    std::string name;
    std::vector<StoredField> fields;
  };
  struct Snapshot {
    SnapshotInfo info;
    std::vector<StoredField> fields;
  };

  ResultFile() = default;
  static ResultFile load(const std::filesystem::path& path, FileDescriptor file, bool writable);
  void require_writable() const;
  void read_index();
  void read_damaged_index();
  void read_group(const std::string& group, const FieldTable& table) const;
  void write(const FieldTable* checkpoint, bool finished, const std::string& outcome);
  void write_lasting(std::int64_t file, const std::vector<RunningChecksum>& sums, const int& error) const;
  void read_back(std::int64_t file, const std::vector<RunningChecksum>& sums) const;
  template <class Work>
  auto reading(Work&& work) const;

  std::filesystem::path path_;
  FileDescriptor file_;  ///< the committed file; empty before the first commit, or the one to overwrite
  Spare spare_;          ///< the version before
  bool writable_ = false;
  bool damaged_ = false;    ///< opened as such
  bool committed_ = false;  ///< file_ holds this run
  bool overwrite_ = false;

  std::vector<SnapshotInfo> snapshots_;
  std::vector<SeriesColumn> columns_;
  std::vector<RunningChecksum> sums_;  ///< of the committed rows, by column; empty for reading only
  bool series_stored_ = false;
  bool finished_ = false;
  bool scene_as_written_ = true;
  std::string outcome_;

  std::vector<StoredField> new_attributes_;
  std::vector<Group> new_groups_;
  std::vector<Snapshot> new_snapshots_;
  std::vector<std::vector<double>> new_series_;  ///< by column
  std::uint64_t waiting_ = 0;                    ///< bytes
};

}  // namespace cairn
