// Everything that a run has recorded, to compare bit by bit.
#pragma once

#include <map>
#include <string>

#include "sim/fields.h"
#include "sim/observe.h"
#include "sim/run.h"
#include "sim/stage_report.h"

namespace cairn {

/// Bytes by name.
using ResultBits = std::map<std::string, std::string>;

inline void add_fields(const FieldTable& table, const std::string& prefix, ResultBits& all) {
  for (const StoredField& field : encode(table)) {
    std::string& bytes = all[prefix + field.name];
    for (const std::uint64_t n : field.value.shape) bytes += std::to_string(n) + ',';
    bytes.append(reinterpret_cast<const char*>(field.value.bytes.data()), field.value.bytes.size());
  }
}

/// The whole checkpoint, the series, and the poses of all snapshots; without `recorded` only what moves.
inline ResultBits result_bits(const std::filesystem::path& path, bool recorded = true) {
  const ResultFile file = ResultFile::open(path);
  ResultBits all;
  State state;
  std::vector<std::string> shapes;
  read_constants(file, state.bodies, shapes);
  ContactColumns contacts;
  WallColumns walls;
  FieldTable table = checkpoint_fields(state, contacts.table(), walls);
  file.read_checkpoint(table);
  add_fields(body_constants(state.bodies), "bodies/", all);
  add_fields(sphere_constants(state.bodies), "spheres/", all);
  if (!recorded)
    std::erase_if(table, [](const Field& field) { return field.name == "ledger/recent_overlap"; });
  add_fields(table, "checkpoint/", all);
  StageColumns stages;
  file.read_static("stages", stages.table());
  if (!recorded) return all;
  add_fields(stages.table(), "stages/", all);
  for (const SeriesColumn& column : file.series_columns()) {
    std::vector<double> values = file.read_series(column.name);
    add_fields({{column.name, "", "", &values}}, "series/", all);
  }
  for (std::size_t k = 0; k < file.snapshots().size(); ++k) {
    Bodies bodies;
    std::vector<std::uint8_t> remnant;
    std::vector<std::uint16_t> touching;
    FieldTable fields = motion_fields(bodies);
    fields.push_back({"remnant", "", "", &remnant, "body"});
    fields.push_back({"sphere_contacts", "", "", &touching, "sphere"});
    file.read_snapshot(k, fields);
    add_fields(fields, std::to_string(k) + "/", all);
  }
  return all;
}

/// Names of what differs; empty: all bits are the same.
inline std::string difference(const ResultBits& a, const ResultBits& b) {
  std::string out;
  for (const auto& [name, bytes] : a) {
    const auto it = b.find(name);
    if (it == b.end() || it->second != bytes) out += " " + name;
  }
  for (const auto& [name, bytes] : b)
    if (!a.contains(name)) out += " " + name;
  return out.substr(0, 1000);
}

}  // namespace cairn
