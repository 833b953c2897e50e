#include "sim/make_perturbers.h"

#include "core/error.h"

namespace cairn {

namespace {

constexpr std::uint64_t kMostBytes = 16'000'000;  // of a track file

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
    spec.track = scene.sources.at(fmt::format("perturber[{}].track_file", k), [&] {
      return parse_track(scene.files.read(spec.track_file, kMostBytes),
                         scene.files.path_of(spec.track_file).string(), total_duration(scene));
    });
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
