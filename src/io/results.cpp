#include "io/results.h"

#include <sys/stat.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "core/error.h"
#include "io/hdf5.h"

namespace cairn {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormat = "cairn result";
constexpr std::int64_t kFormatVersion = 2;
constexpr const char *kScene = "scene", *kSceneChecksum = "scene_xxh3_128";
constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();  // of what we wrote ourselves

std::string snapshot_group(std::size_t k) {
  return fmt::format("snapshots/{:06}", k);
}

std::uint64_t size_of(const FileDescriptor& file) {
  struct stat info {};
  return fstat(file.get(), &info) == 0 ? static_cast<std::uint64_t>(info.st_size) : 0;
}

template <class T>
T read_value(hid_t object, const std::string& name, std::uint64_t limit) {
  T value{};
  decode(h5::read_attribute(object, name, limit), {h5::attribute_label(object, name), "", "", &value});
  return value;
}

template <class T>
void write_value(hid_t object, const std::string& name, T value) {
  h5::write_attribute(object, name, encode({name, "", "", &value}).value);
}

SnapshotInfo read_info(hid_t file, std::size_t k, std::uint64_t limit) {
  const h5::Group group = h5::open_group(file, snapshot_group(k));
  return {read_value<double>(group, "time", limit), read_value<std::string>(group, "stage", limit),
          read_value<std::uint64_t>(group, "epoch", limit)};
}

/// Writes fields, one at a time, until an error; returns their checksums.
template <class Fields>
std::vector<std::string> write_fields(hid_t group, const Fields& fields, const int& error) {
  std::vector<std::string> sums;
  for (const auto& field : fields) {
    if (error != 0) break;  // the rest would be dropped anyway
    if constexpr (std::is_same_v<Fields, FieldTable>)
      sums.push_back(h5::write_field(group, encode(field)));  // a large state is never copied whole
    else
      sums.push_back(h5::write_field(group, field));
  }
  return sums;
}

/// Checksum of the root's attributes but itself and the scene, which users may edit.
std::string root_checksum(hid_t file, std::uint64_t limit) {
  RunningChecksum sum;
  for (const std::string& name : h5::attribute_names(file)) {
    if (name == h5::kChecksum || name == kScene) continue;
    sum.add(std::as_bytes(std::span(name)));
    sum.add(h5::read_attribute(file, name, limit).bytes);
  }
  return sum.digest();
}

std::uint64_t size_of(const std::vector<StoredField>& fields) {
  std::uint64_t size = 0;
  for (const StoredField& field : fields) size += field.value.bytes.size();
  return size;
}

[[noreturn]] void fail_reading_back(const std::string& what) {
  throw h5::Error(what + ": read back from the disk it is another; the file is left as it was");
}

/// Throws unless a dataset's checksum, which fits its bytes, is this one.
void read_back_field(hid_t file, const std::string& name, const std::string& sum, std::uint64_t limit) {
  if (checksum(h5::read_array(file, name, limit).bytes) != sum) fail_reading_back(name);
}

void read_back_fields(hid_t file, const std::string& group, const std::vector<StoredField>& fields,
                      std::uint64_t limit) {
  for (const StoredField& field : fields)
    read_back_field(file, group + "/" + field.name, checksum(field.value.bytes), limit);
}

}  // namespace

/// work(HDF5 file, largest sensible array in bytes), with errors that name the file.
template <class Work>
auto ResultFile::reading(Work&& work) const {
  if (!committed_) throw std::logic_error("nothing has been committed yet");
  h5::DiskLog log;
  try {
    const h5::File file = h5::open_file(file_.get(), damaged_ ? h5::Mode::read_cut_off : h5::Mode::read, log);
    return work(file, size_of(file_));
  } catch (const h5::Error& e) {
    throw InputError("{}: {}", path_.string(), log.error != 0 ? reason(log.error) : e.what());
  } catch (const InputError& e) {
    throw InputError("{}: {}", path_.string(), e.what());
  }
}

ResultFile ResultFile::create(const fs::path& path, const FieldTable& attributes, bool overwrite) {
  ResultFile result;
  result.path_ = path;
  result.file_ = claim(path, overwrite);
  if (result.file_.get() >= 0) try {
      load(path, open_for_reading(path), false);
    } catch (const InputError& error) {
      throw InputError("{}; only a result file of this program is replaced", error.what());
    }
  result.writable_ = true;
  result.overwrite_ = overwrite;
  result.new_attributes_ = encode(attributes);
  return result;
}

ResultFile ResultFile::open(const fs::path& path) {
  return load(path, open_for_reading(path), false);
}

ResultFile ResultFile::open_damaged(const fs::path& path) {
  ResultFile result;
  result.path_ = path;
  result.file_ = open_for_reading(path);
  result.committed_ = result.damaged_ = true;
  result.read_damaged_index();
  return result;
}

ResultFile ResultFile::open_to_continue(const fs::path& path) {
  return load(path, open_locked(path), true);
}

ResultFile ResultFile::load(const fs::path& path, FileDescriptor file, bool writable) {
  ResultFile result;
  result.path_ = path;
  result.file_ = std::move(file);
  result.writable_ = writable;
  result.committed_ = result.overwrite_ = true;
  result.read_index();
  return result;
}

void ResultFile::read_index() {
  reading([&](hid_t file, std::uint64_t limit) {
    if (!h5::has_attribute(file, "format") || read_value<std::string>(file, "format", limit) != kFormat)
      throw InputError("an HDF5 file, but not a result of this program");
    if (const auto version = read_value<std::int64_t>(file, "format_version", limit);
        version != kFormatVersion)
      throw InputError("format version {}, this program reads {}", version, kFormatVersion);
    if (read_value<std::string>(file, h5::kChecksum, limit) != root_checksum(file, limit))
      throw InputError("damaged, the checksum of its attributes is another");
    if (h5::has_attribute(file, kScene))
      scene_as_written_ = h5::has_attribute(file, kSceneChecksum) &&
                          read_value<std::string>(file, kSceneChecksum, limit) ==
                              checksum(h5::read_attribute(file, kScene, limit).bytes);
    finished_ = read_value<bool>(file, "finished", limit);
    outcome_ = read_value<std::string>(file, "outcome", limit);
    const std::size_t count = h5::names(h5::open_group(file, "snapshots")).size();
    for (std::size_t k = 0; k < count; ++k) snapshots_.push_back(read_info(file, k, limit));
    series_stored_ = h5::exists(file, "series");
    if (!series_stored_) return;
    const h5::Group series = h5::open_group(file, "series");
    for (const std::string& name : h5::names(series)) {
      h5::exists(series, name);  // in this file
      const h5::Dataset column(H5Dopen2(series, name.c_str(), H5P_DEFAULT), "series/" + name);
      columns_.push_back({name, read_value<std::string>(column, "unit", limit),
                          read_value<std::string>(column, "help", limit)});
    }
    const std::vector<DatasetInfo> stored = h5::datasets(series);
    for (const DatasetInfo& column : stored)
      if (column.shape.size() != 1 || column.shape != stored.front().shape)
        throw InputError("series/{}: has not as many rows as the other columns", column.name);
    new_series_.resize(columns_.size());
    if (!writable_) return;
    sums_.resize(columns_.size());
    for (std::size_t c = 0; c < columns_.size(); ++c)
      sums_[c].add(h5::read_array(series, columns_[c].name, limit).bytes);
  });
}

void ResultFile::read_damaged_index() {
  reading([&](hid_t file, std::uint64_t limit) {
    for (std::size_t k = 0; h5::exists(file, snapshot_group(k)); ++k) {
      try {
        snapshots_.push_back(read_info(file, k, limit));
      } catch (const h5::Error&) {
        snapshots_.emplace_back();  // keeps the numbers of the others
      }
    }
  });
}

void ResultFile::require_writable() const {
  if (!writable_) throw std::logic_error("the result file is open for reading only");
}

void ResultFile::write_attributes(const FieldTable& attributes) {
  require_writable();
  new_attributes_ = encode(attributes);
}

void ResultFile::write_static(const std::string& group, const FieldTable& table) {
  require_writable();
  std::erase_if(new_groups_, [&](const Group& g) { return g.name == group; });
  new_groups_.push_back({group, encode(table)});
}

void ResultFile::add_snapshot(double time, const std::string& stage, const FieldTable& table,
                              std::uint64_t epoch) {
  require_writable();
  new_snapshots_.push_back({{time, stage, epoch}, encode(table)});
  waiting_ += size_of(new_snapshots_.back().fields);
}

void ResultFile::declare_series(const std::vector<SeriesColumn>& columns) {
  require_writable();
  if (columns_.empty()) {
    columns_ = columns;
    new_series_.resize(columns.size());
    sums_.resize(columns.size());
    return;
  }
  if (!std::ranges::equal(columns_, columns, {}, &SeriesColumn::name, &SeriesColumn::name))
    throw InputError("{}: series: the file has other columns than this program writes", path_.string());
}

void ResultFile::add_series_row(std::span<const double> values) {
  require_writable();
  if (values.size() != columns_.size()) throw std::logic_error("a series row needs one value per column");
  for (std::size_t c = 0; c < values.size(); ++c) new_series_[c].push_back(values[c]);
  waiting_ += values.size_bytes();
}

void ResultFile::commit(const FieldTable& checkpoint) {
  write(&checkpoint, false, "");
}

void ResultFile::commit() {
  write(nullptr, finished_, outcome_);
}

void ResultFile::abandon(const std::string& outcome) {
  write(nullptr, true, outcome);
}

void ResultFile::finish(const FieldTable& checkpoint, const std::string& outcome) {
  write(&checkpoint, true, outcome);
}

void ResultFile::write(const FieldTable* checkpoint, bool finished, const std::string& outcome) {
  require_writable();
  const FileDescriptor nothing;
  Replacement next = Replacement::of(path_, committed_ ? file_ : nothing, std::exchange(spare_, {}));
  std::vector<RunningChecksum> sums = sums_;
  for (std::size_t c = 0; c < columns_.size(); ++c) sums[c].add(std::as_bytes(std::span(new_series_[c])));
  h5::DiskLog log;
  std::string problem;
  const auto session = [&](h5::Mode mode, auto&& work) {
    if (log.error != 0) return;
    h5::File file = h5::open_file(next.fd(), mode, log);
    work(file);
    h5::close_file(file);
  };
  try {
    // HDF5 keeps no account of free space between two openings, but cuts it off where it is at the end of the
    // file. So the checkpoint is always written last and by itself, and taken away first and by itself.
    if (committed_ && checkpoint != nullptr)
      session(h5::Mode::append, [](hid_t file) { h5::remove(file, "checkpoint"); });
    session(committed_ ? h5::Mode::append : h5::Mode::create, [&](hid_t file) {
      write_lasting(file, sums, log.error);
      write_value(file, "finished", finished);
      h5::write_attribute(file, "outcome", outcome);
      h5::write_attribute(file, h5::kChecksum, root_checksum(file, kUnlimited));
    });
    std::vector<std::string> checkpoint_sums;
    if (checkpoint != nullptr)
      session(h5::Mode::append, [&](hid_t file) {
        checkpoint_sums = write_fields(h5::create_group(file, "checkpoint"), *checkpoint, log.error);
      });
    session(h5::Mode::read, [&](hid_t file) {
      read_back(file, sums);
      for (std::size_t f = 0; f < checkpoint_sums.size(); ++f)
        read_back_field(file, "checkpoint/" + (*checkpoint)[f].name, checkpoint_sums[f], kUnlimited);
    });
  } catch (const h5::Error& e) {
    problem = e.what();
  }
  // What HDF5 says after a failed write is only a consequence.
  if (log.error != 0) throw InputError("{}: {}", path_.string(), reason(log.error));
  if (!problem.empty()) throw InputError("{}: {}", path_.string(), problem);
  Spare former;
  if (committed_)
    former = next.exchange(file_, std::move(log.changes));
  else
    file_ = next.install(overwrite_);

  committed_ = true;
  finished_ = finished;
  outcome_ = outcome;
  series_stored_ = !columns_.empty();
  sums_ = std::move(sums);
  for (Snapshot& snapshot : new_snapshots_) snapshots_.push_back(std::move(snapshot.info));
  new_attributes_.clear();
  new_groups_.clear();
  new_snapshots_.clear();
  for (auto& column : new_series_) column.clear();
  waiting_ = 0;
  sync_folder(path_);
  if (!finished) spare_ = std::move(former);  // only now does nothing need it on the disk
}

/// Everything that was added.
void ResultFile::write_lasting(std::int64_t file, const std::vector<RunningChecksum>& sums,
                               const int& error) const {
  if (!committed_) {
    write_value(file, "format", std::string(kFormat));
    write_value(file, "format_version", kFormatVersion);
    h5::create_group(file, "snapshots");
  }
  for (const StoredField& attribute : new_attributes_) {
    h5::write_attribute(file, attribute.name, attribute.value);
    if (attribute.name == kScene) h5::write_attribute(file, kSceneChecksum, checksum(attribute.value.bytes));
  }
  for (const Group& group : new_groups_) {
    h5::remove(file, group.name);
    write_fields(h5::create_group(file, group.name), group.fields, error);
  }
  if (!series_stored_ && !columns_.empty()) {
    const h5::Group series = h5::create_group(file, "series");
    for (const SeriesColumn& column : columns_) {
      const h5::Dataset dataset = h5::create_growing(series, column.name);
      h5::write_attribute(dataset, "unit", column.unit);
      h5::write_attribute(dataset, "help", column.help);
      h5::write_attribute(dataset, h5::kChecksum, RunningChecksum().digest());
    }
  }
  for (std::size_t c = 0; c < columns_.size() && error == 0; ++c)
    h5::append(file, "series/" + columns_[c].name, new_series_[c], sums[c].digest());
  for (std::size_t k = 0; k < new_snapshots_.size() && error == 0; ++k) {
    const h5::Group group = h5::create_group(file, snapshot_group(snapshots_.size() + k));
    write_value(group, "time", new_snapshots_[k].info.time);
    h5::write_attribute(group, "stage", new_snapshots_[k].info.stage);
    write_value(group, "epoch", new_snapshots_[k].info.epoch);
    write_fields(group, new_snapshots_[k].fields, error);
  }
}

/// Throws h5::Error unless what write_lasting wrote is in the file.
void ResultFile::read_back(std::int64_t file, const std::vector<RunningChecksum>& sums) const {
  if (read_value<std::string>(file, h5::kChecksum, kUnlimited) != root_checksum(file, kUnlimited))
    fail_reading_back("attributes");
  for (const StoredField& attribute : new_attributes_)
    if (h5::read_attribute(file, attribute.name, kUnlimited).bytes != attribute.value.bytes)
      fail_reading_back("attribute " + attribute.name);
  for (const Group& group : new_groups_) read_back_fields(file, group.name, group.fields, kUnlimited);
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const std::string name = "series/" + columns_[c].name;
    const std::vector<double>& added = new_series_[c];
    const std::vector<double> tail = h5::read_tail(file, name, added.size());
    if (!std::ranges::equal(std::as_bytes(std::span(tail)), std::as_bytes(std::span(added))))
      fail_reading_back(name);
    const h5::Dataset dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), name);
    if (read_value<std::string>(dataset, h5::kChecksum, kUnlimited) != sums[c].digest())
      fail_reading_back(name);
  }
  const std::size_t former = snapshots_.size();
  for (std::size_t k = 0; k < new_snapshots_.size(); ++k) {
    const std::string name = snapshot_group(former + k);
    const SnapshotInfo info = read_info(file, former + k, kUnlimited);
    const SnapshotInfo& added = new_snapshots_[k].info;
    if (std::memcmp(&info.time, &added.time, sizeof info.time) != 0 || info.stage != added.stage ||
        info.epoch != added.epoch)
      fail_reading_back(name);
    read_back_fields(file, name, new_snapshots_[k].fields, kUnlimited);
  }
  if (h5::names(h5::open_group(file, "snapshots")).size() != former + new_snapshots_.size())
    fail_reading_back("snapshots");
}

void ResultFile::read_attributes(const FieldTable& table) const {
  reading([&](hid_t file, std::uint64_t limit) {
    for (const Field& field : table) decode(h5::read_attribute(file, field.name, limit), field);
  });
}

bool ResultFile::has_group(const std::string& group) const {
  return committed_ && reading([&](hid_t file, std::uint64_t) { return h5::exists(file, group); });
}

void ResultFile::read_group(const std::string& name, const FieldTable& table) const {
  reading([&](hid_t file, std::uint64_t limit) {
    h5::open_group(file, name);  // for the message when all of it is missing
    for (Field field : table) {
      const Array array = h5::read_array(file, name + "/" + field.name, limit);
      field.name = name + "/" + field.name;
      decode(array, field);
    }
    require_equal_rows(table);
  });
}

void ResultFile::read_static(const std::string& group, const FieldTable& table) const {
  read_group(group, table);
}

std::string ResultFile::constants(const std::string& group, std::uint64_t epoch) const {
  const std::string former = fmt::format("{}_{}", group, epoch);
  return has_group(former) ? former : group;
}

void ResultFile::read_checkpoint(const FieldTable& table) const {
  read_group("checkpoint", table);
}

void ResultFile::read_snapshot(std::size_t k, const FieldTable& table) const {
  if (k >= snapshots_.size()) throw InputError("{}: there is no snapshot {}", path_.string(), k);
  read_group(snapshot_group(k), table);
}

std::vector<double> ResultFile::read_series(const std::string& column) const {
  std::vector<double> values;
  read_group("series", {{column, "", "", &values}});
  return values;
}

std::vector<DatasetInfo> ResultFile::list(const std::string& group) const {
  return reading([&](hid_t file, std::uint64_t) { return h5::datasets(h5::open_group(file, group)); });
}

std::vector<DatasetInfo> ResultFile::list_snapshot(std::size_t k) const {
  return list(snapshot_group(k));
}

}  // namespace cairn
