#include "sim/make_perturbers.h"

#include "core/error.h"

namespace cairn {

namespace {

/// Rows of the track files one after the other; vx, vy, vz are 0 where a file has none.
struct TrackColumns {
  std::vector<std::uint32_t> rows, width;  // of each file
  std::vector<double> time;
  std::vector<Vec3> position, velocity;

  FieldTable table() {
    return {{"rows", "", "number of rows of each track file", &rows, "file"},
            {"width", "", "numbers in a row: 4, or 7 with velocities", &width, "file"},
            {"time", "s", "of the row", &time, "row"},
            {"position", "m", "from the zero of the scene's frame", &position, "row"},
            {"velocity", "m/s", "where the file gives it", &velocity, "row"}};
  }
};

double gm_of(const PerturberSpec& spec) {
  return spec.gm ? *spec.gm : kGravitationalConstant * *spec.mass;
}

gravity::KeplerOrbit kepler_orbit(const OrbitSpec& spec, double gm) {
  gravity::KeplerOrbit orbit{
      .gm = spec.gm.value_or(gm),
      .periapsis = spec.periapsis ? *spec.periapsis : *spec.semi_major_axis * (1.0 - spec.eccentricity),
      .eccentricity = spec.eccentricity,
      .inclination = spec.inclination,
      .node = spec.node,
      .argument = spec.argument,
      .periapsis_time = spec.periapsis_time};
  if (spec.mean_anomaly) orbit.periapsis_time = -*spec.mean_anomaly / mean_motion(orbit);
  return orbit;
}

gravity::Track make_track(const TrackRows& rows) {
  std::vector<double> times;
  std::vector<Vec3> places, velocities;
  for (const std::vector<double>& row : rows) {
    times.push_back(row[0]);
    places.emplace_back(row[1], row[2], row[3]);
    if (row.size() == 7) velocities.emplace_back(row[4], row[5], row[6]);
  }
  if (velocities.empty()) return {std::move(times), std::move(places)};
  return {std::move(times), std::move(places), std::move(velocities)};
}

gravity::Orbit make_orbit(const PerturberSpec& spec, double gm) {
  if (spec.orbit) return kepler_orbit(*spec.orbit, gm);
  if (!spec.track.empty()) return make_track(spec.track);
  return spec.position;
}

}  // namespace

void load_tracks(Scene& scene) {
  for (std::size_t k = 0; k < scene.perturbers.size(); ++k) {
    PerturberSpec& spec = scene.perturbers[k];
    if (spec.track_file.empty()) continue;
    try {
      spec.track = read_track_file(scene.directory / spec.track_file, total_duration(scene));
    } catch (const InputError& error) {
      throw scene.sources.error(fmt::format("perturber[{}].track_file", k), error.what());
    }
  }
}

void write_tracks(ResultFile& file, const Scene& scene) {
  TrackColumns columns;
  for (const PerturberSpec& spec : scene.perturbers) {
    if (spec.track_file.empty()) continue;
    columns.rows.push_back(static_cast<std::uint32_t>(spec.track.size()));
    columns.width.push_back(static_cast<std::uint32_t>(spec.track.front().size()));
    for (const std::vector<double>& row : spec.track) {
      columns.time.push_back(row[0]);
      columns.position.emplace_back(row[1], row[2], row[3]);
      columns.velocity.push_back(row.size() == 7 ? Vec3(row[4], row[5], row[6]) : Vec3(Vec3::Zero()));
    }
  }
  if (!columns.rows.empty()) file.write_static("tracks", columns.table());
}

void read_tracks(const ResultFile& file, Scene& scene) {
  TrackColumns columns;
  std::size_t track = 0, row = 0;
  const auto check = [&](bool good) {
    if (!good) throw InputError("{}: tracks: not those of the scene's perturbers", file.path().string());
  };
  for (PerturberSpec& spec : scene.perturbers) {
    if (spec.track_file.empty()) continue;
    if (track == 0) file.read_static("tracks", columns.table());
    check(track < columns.rows.size() && track < columns.width.size());
    const std::size_t count = columns.rows[track], width = columns.width[track];
    check((width == 4 || width == 7) && row + count <= columns.time.size() &&
          columns.position.size() == columns.time.size() && columns.velocity.size() == columns.time.size());
    for (std::size_t end = row + count; row < end; ++row) {
      const Vec3 &x = columns.position[row], &v = columns.velocity[row];
      spec.track.push_back({columns.time[row], x.x(), x.y(), x.z(), v.x(), v.y(), v.z()});
      spec.track.back().resize(width);
    }
    check_track(spec.track, total_duration(scene), [&](std::size_t, const std::string&) { check(false); });
    ++track;
  }
}

std::vector<gravity::Perturber> make_perturbers(const Scene& scene, double body_mass) {
  std::vector<gravity::Perturber> perturbers;
  for (const PerturberSpec& spec : scene.perturbers) {
    const double gm = gm_of(spec);
    perturbers.push_back({.name = spec.name,
                          .gm = gm,
                          .radius = spec.radius,
                          .tidal = spec.tidal,
                          .orbit = make_orbit(spec, gm + kGravitationalConstant * body_mass)});
  }
  return perturbers;
}

}  // namespace cairn
