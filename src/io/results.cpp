#include "io/results.h"

#include <sys/stat.h>

#include <algorithm>
#include <stdexcept>

#include "core/error.h"
#include "io/hdf5.h"

namespace cairn {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormat = "cairn result";
constexpr std::int64_t kFormatVersion = 1;

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

void write_fields(hid_t group, const std::vector<StoredField>& fields, const int& error) {
  for (const StoredField& field : fields) {
    if (error != 0) return;  // the rest would be dropped anyway
    h5::write_field(group, field);
  }
}

void write_checkpoint(hid_t file, const FieldTable& table, const int& error) {
  const h5::Group group = h5::create_group(file, "checkpoint");
  // One field at a time: a large state is never copied whole.
  for (std::size_t f = 0; f < table.size() && error == 0; ++f) h5::write_field(group, encode(table[f]));
}

}  // namespace

/// work(HDF5 file, largest sensible array in bytes), with errors that name the file.
template <class Work>
auto ResultFile::reading(Work&& work) const {
  if (!committed_) throw std::logic_error("nothing has been committed yet");
  int error = 0;
  try {
    const h5::File file = h5::open_file(file_.get(), h5::Mode::read, error);
    return work(file, size_of(file_));
  } catch (const h5::Error& e) {
    throw InputError("{}: {}", path_.string(), error != 0 ? reason(error) : e.what());
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
    finished_ = read_value<bool>(file, "finished", limit);
    outcome_ = read_value<std::string>(file, "outcome", limit);
    const std::size_t count = h5::names(h5::open_group(file, "snapshots")).size();
    for (std::size_t k = 0; k < count; ++k) {
      const h5::Group group = h5::open_group(file, snapshot_group(k));
      snapshots_.push_back(
          {read_value<double>(group, "time", limit), read_value<std::string>(group, "stage", limit),
           h5::has_attribute(group, "epoch") ? read_value<std::uint64_t>(group, "epoch", limit) : 0});
    }
    series_stored_ = h5::exists(file, "series");
    if (!series_stored_) return;
    const h5::Group series = h5::open_group(file, "series");
    for (const std::string& name : h5::names(series)) {
      const h5::Dataset column(H5Dopen2(series, name.c_str(), H5P_DEFAULT), "series/" + name);
      columns_.push_back({name, read_value<std::string>(column, "unit", limit),
                          read_value<std::string>(column, "help", limit)});
    }
    new_series_.resize(columns_.size());
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
}

void ResultFile::declare_series(const std::vector<SeriesColumn>& columns) {
  require_writable();
  if (columns_.empty()) {
    columns_ = columns;
    new_series_.resize(columns.size());
    return;
  }
  if (!std::ranges::equal(columns_, columns, {}, &SeriesColumn::name, &SeriesColumn::name))
    throw InputError("{}: series: the file has other columns than this program writes", path_.string());
}

void ResultFile::add_series_row(std::span<const double> values) {
  require_writable();
  if (values.size() != columns_.size()) throw std::logic_error("a series row needs one value per column");
  for (std::size_t c = 0; c < values.size(); ++c) new_series_[c].push_back(values[c]);
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
  Replacement next(path_, committed_ ? file_ : nothing);
  int error = 0;
  std::string problem;
  const auto session = [&](h5::Mode mode, auto&& work) {
    if (error != 0) return;
    h5::File file = h5::open_file(next.fd(), mode, error);
    work(file);
    h5::close_file(file);
  };
  try {
    // HDF5 keeps no account of free space between two openings, but cuts it off where it is at the end of the
    // file. So the checkpoint is always written last and by itself, and taken away first and by itself.
    if (committed_ && checkpoint != nullptr)
      session(h5::Mode::append, [](hid_t file) { h5::remove(file, "checkpoint"); });
    session(committed_ ? h5::Mode::append : h5::Mode::create, [&](hid_t file) {
      write_lasting(file, error);
      write_value(file, "finished", finished);
      h5::write_attribute(file, "outcome", outcome);
    });
    if (checkpoint != nullptr)
      session(h5::Mode::append, [&](hid_t file) { write_checkpoint(file, *checkpoint, error); });
  } catch (const h5::Error& e) {
    problem = e.what();
  }
  // What HDF5 says after a failed write is only a consequence.
  if (error != 0) throw InputError("{}: {}", path_.string(), reason(error));
  if (!problem.empty()) throw InputError("{}: {}", path_.string(), problem);
  file_ = next.install(committed_ || overwrite_);

  committed_ = true;
  finished_ = finished;
  outcome_ = outcome;
  series_stored_ = !columns_.empty();
  for (Snapshot& snapshot : new_snapshots_) snapshots_.push_back(std::move(snapshot.info));
  new_attributes_.clear();
  new_groups_.clear();
  new_snapshots_.clear();
  for (auto& column : new_series_) column.clear();
  sync_folder(path_);
}

/// Everything that was added.
void ResultFile::write_lasting(std::int64_t file, const int& error) const {
  if (!committed_) {
    write_value(file, "format", std::string(kFormat));
    write_value(file, "format_version", kFormatVersion);
    h5::create_group(file, "snapshots");
  }
  for (const StoredField& attribute : new_attributes_)
    h5::write_attribute(file, attribute.name, attribute.value);
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
    }
  }
  for (std::size_t c = 0; c < columns_.size() && error == 0; ++c)
    h5::append(file, "series/" + columns_[c].name, new_series_[c]);
  for (std::size_t k = 0; k < new_snapshots_.size() && error == 0; ++k) {
    const h5::Group group = h5::create_group(file, snapshot_group(snapshots_.size() + k));
    write_value(group, "time", new_snapshots_[k].info.time);
    h5::write_attribute(group, "stage", new_snapshots_[k].info.stage);
    write_value(group, "epoch", new_snapshots_[k].info.epoch);
    write_fields(group, new_snapshots_[k].fields, error);
  }
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
