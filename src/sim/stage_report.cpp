#include "sim/stage_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "analysis/axes.h"
#include "analysis/coordination.h"
#include "analysis/fragments.h"
#include "analysis/packing.h"
#include "analysis/spin_state.h"
#include "sim/agitation.h"

namespace cairn {

namespace {

struct Column {
  double StageReport::*value;
  const char *name, *unit, *help;
};

using R = StageReport;
constexpr Column kColumns[] = {
    {&R::time, "time", "s", "at the end of the stage"},
    {&R::bodies, "bodies", "", "number"},
    {&R::spheres, "spheres", "", "number"},
    {&R::mass, "mass", "kg", "of all bodies, held ones included"},
    {&R::bulk_density, "bulk_density", "kg/m^3", "mass over the volume of the region last carved"},
    {&R::eta_bulk, "eta_bulk", "", "volume of the bodies over that volume"},
    {&R::interior, "interior", "m", "radius within which packing is measured"},
    {&R::interior_bodies, "interior_bodies", "", "bodies of the largest group within it"},
    {&R::eta_inter, "eta_inter", "", "volume of bodies within it over that of their plain Voronoi cells"},
    {&R::eta_radical, "eta_radical", "", "the same with radical cells"},
    {&R::eta_mean, "eta_mean", "", "mean of volume over plain cells of these bodies"},
    {&R::coordination, "coordination", "", "mean contacts of a sphere, those with walls included"},
    {&R::body_contacts, "body_contacts", "", "mean contacts of a body, those with walls included"},
    {&R::body_neighbours, "body_neighbours", "", "2 x touching pairs of bodies / bodies"},
    {&R::free_bodies, "free_bodies", "", "bodies without contact"},
    {&R::hanging_bodies, "hanging_bodies", "", "bodies with one contact"},
    {&R::overlap, "overlap", "", "largest, over the smaller radius of its pair, or on a wall"},
    {&R::groups, "groups", "", "of connected bodies"},
    {&R::outside, "outside", "", "bodies that are not part of the largest group"},
    {&R::speed, "speed", "m/s", "rms; without walls, less that of the rigid motion"},
    {&R::period, "period", "s", "of the spin of the largest group about z"},
};

constexpr std::size_t kFewest = 30;  // bodies of which a packing can be told

}  // namespace

StageReport measure(const State& state, double link_gap, double interior) {
  const Bodies& bodies = state.bodies;
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  StageReport r;
  r.time = state.clock.time();
  r.bodies = static_cast<double>(bodies.size());
  r.spheres = static_cast<double>(bodies.spheres.size());
  const Budget total = budget(bodies);
  r.held_bodies = static_cast<double>(state.held.body.size());
  r.held_mass = held_mass(bodies);
  r.mass = total.mass + r.held_mass;
  const double volume = state.region_volume > 0.0 ? state.region_volume : none;
  r.bulk_density = r.mass / volume;
  r.eta_bulk = std::accumulate(bodies.volume.begin(), bodies.volume.end(), 0.0) / volume;

  const Fragments groups = find_fragments(bodies, link_gap, state.box);
  const std::vector<std::uint32_t> largest = groups.members(0);
  r.groups = static_cast<double>(groups.size());
  r.outside = r.bodies - static_cast<double>(state.held.body.size() + largest.size());
  const SpinState spin = spin_state(bodies, largest);
  r.period = spin_period(spin, Vec3::UnitZ());
  r.speed = std::sqrt(2.0 * std::max(agitation(state, total), 0.0) / total.mass);

  r.interior = interior > 0.0 ? interior : 0.375 * axis_lengths(bodies, largest).c;
  const bool told = largest.size() >= kFewest && !state.box.periodic();
  const Packing packing =
      told ? interior_packing(bodies, largest, r.interior) : Packing{0, none, none, none, none};
  r.interior_bodies = static_cast<double>(packing.bodies);
  r.eta_inter = packing.total;
  r.eta_radical = packing.total_radical;
  r.eta_mean = packing.mean;

  const Coordination touching = coordination(bodies, state.box, state.walls.contacts);
  r.coordination = touching.per_sphere;
  r.body_contacts = touching.per_body;
  r.body_neighbours = touching.neighbours;
  r.free_bodies = static_cast<double>(touching.free_bodies);
  r.hanging_bodies = static_cast<double>(touching.hanging_bodies);
  r.overlap = touching.largest_overlap;
  if (state.clock.steps > 0)  // an operation has no walls of its own
    r.overlap = std::max(r.overlap, state.walls.deepest(bodies, r.time).ratio);
  return r;
}

StageColumns::StageColumns() : values(std::size(kColumns)) {}

void StageColumns::push_back(const StageReport& report) {
  name.push_back(report.name);
  what.push_back(report.what);
  for (std::size_t c = 0; c < values.size(); ++c) values[c].push_back(report.*kColumns[c].value);
}

void StageColumns::pop_back() {
  name.pop_back();
  what.pop_back();
  for (std::vector<double>& column : values) column.pop_back();
}

FieldTable StageColumns::table() {
  FieldTable out{{"name", "", "of the stage", &name, "stage"},
                 {"what", "", "an operation has done, or why the stage ended", &what, "stage"}};
  for (std::size_t c = 0; c < values.size(); ++c)
    out.push_back({kColumns[c].name, kColumns[c].unit, kColumns[c].help, &values[c], "stage"});
  return out;
}

std::string describe(const StageReport& r) {
  std::string text = fmt::format("stage '{}': {}; {:.1f} s\n", r.name, r.what, r.seconds);
  text += fmt::format("  bodies     {:.0f} of {:.0f} spheres, {:.5g} kg", r.bodies, r.spheres, r.mass);
  if (r.held_bodies > 0.0)
    text += fmt::format(", {:.0f} of them held, {:.5g} kg", r.held_bodies, r.held_mass);
  if (std::isfinite(r.bulk_density))
    text += fmt::format("; {:.1f} kg/m^3, packing {:.4f} of the region", r.bulk_density, r.eta_bulk);
  if (std::isfinite(r.eta_inter))
    text += fmt::format(
        "\n  interior   packing {:.4f} of {:.0f} bodies within {:.4g} m (radical cells {:.4f}, mean of "
        "bodies {:.4f})",
        r.eta_inter, r.interior_bodies, r.interior, r.eta_radical, r.eta_mean);
  text += fmt::format(
      "\n  contacts   {:.3f} per sphere, {:.3f} per body with {:.3f} neighbours; {:.0f} bodies without, "
      "{:.0f} "
      "with one",
      r.coordination, r.body_contacts, r.body_neighbours, r.free_bodies, r.hanging_bodies);
  text += fmt::format(
      "\n  state      overlap {:.3g}, rms speed {:.3g} m/s, {:.0f} bodies outside the largest group\n",
      r.overlap, r.speed, r.outside);
  return text;
}

std::vector<std::string> defects(const StageReport& r, double overlap_limit) {
  std::vector<std::string> out;
  if (r.overlap > overlap_limit)
    out.push_back(
        fmt::format("spheres overlap by up to {:.3g} of the smaller radius; contact.overlap_limit is {:g}",
                    r.overlap, overlap_limit));
  if (r.outside > 0.0)
    out.push_back(
        fmt::format("{:.0f} of {:.0f} bodies are apart from the largest group", r.outside, r.bodies));
  return out;
}

}  // namespace cairn
