#include "sim/fields.h"

#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/vector.h"

namespace cairn {

void MemoryColumns::reserve(std::size_t count) {
  c_n.reserve(count);
  c_s.reserve(count);
  slide.reserve(count);
  roll.reserve(count);
  twist.reserve(count);
}

void MemoryColumns::push_back(const ContactMemory<double>& m) {
  c_n.push_back(m.c_n);
  c_s.push_back(m.c_s);
  slide.push_back(vector(m.slide));
  roll.push_back(vector(m.roll));
  twist.push_back(m.twist);
}

ContactMemory<double> MemoryColumns::operator[](std::size_t k) const {
  return {
      .c_n = c_n[k], .c_s = c_s[k], .slide = triple(slide[k]), .roll = triple(roll[k]), .twist = twist[k]};
}

FieldTable MemoryColumns::table(const std::string& prefix) {
  return {{prefix + "damping_normal", "kg/s", "C_N, from the effective mass at first touch", &c_n, prefix},
          {prefix + "damping_tangential", "kg/s", "C_S", &c_s, prefix},
          {prefix + "slide", "m", "tangential spring", &slide, prefix},
          {prefix + "roll", "rad", "rolling spring", &roll, prefix},
          {prefix + "twist", "rad", "twisting spring", &twist, prefix}};
}

void ContactColumns::assign(const std::vector<ContactRecord>& records) {
  *this = ContactColumns{};
  i.reserve(records.size());
  j.reserve(records.size());
  memory.reserve(records.size());
  for (const ContactRecord& r : records) {
    i.push_back(r.i);
    j.push_back(r.j);
    memory.push_back(r.memory);
  }
}

std::vector<ContactRecord> ContactColumns::records() const {
  std::vector<ContactRecord> out;
  out.reserve(i.size());
  for (std::size_t k = 0; k < i.size(); ++k) out.push_back({i[k], j[k], memory[k]});
  return out;
}

FieldTable ContactColumns::table() {
  const std::string prefix = "contacts/";
  FieldTable fields = memory.table(prefix);
  fields.insert(fields.begin(),
                {{prefix + "i", "", "sphere", &i, prefix}, {prefix + "j", "", "sphere", &j, prefix}});
  return fields;
}

FieldTable contact_fields(const ContactList& contacts) {
  const auto column = [&]<class T>(T (*of)(const ContactRecord&)) -> std::function<Array()> {
    return [&contacts, of] {
      return make_rows<T>(contacts.contacts(), [&](T* row) {
        for (std::size_t slot = 0; slot < contacts.slots(); ++slot)
          if (contacts.touching(slot)) *row++ = of(contacts.record(slot));
      });
    };
  };
  const std::function<Array()> columns[] = {
      column(+[](const ContactRecord& r) { return r.i; }),
      column(+[](const ContactRecord& r) { return r.j; }),
      column(+[](const ContactRecord& r) { return r.memory.c_n; }),
      column(+[](const ContactRecord& r) { return r.memory.c_s; }),
      column(+[](const ContactRecord& r) -> Vec3 { return vector(r.memory.slide); }),
      column(+[](const ContactRecord& r) -> Vec3 { return vector(r.memory.roll); }),
      column(+[](const ContactRecord& r) { return r.memory.twist; })};
  FieldTable fields = ContactColumns().table();
  for (std::size_t k = 0; k < fields.size(); ++k) fields[k].data = columns[k];
  return fields;
}

void WallColumns::assign(const std::vector<WallContact>& contacts) {
  *this = WallColumns{};
  for (const WallContact& c : contacts) {
    sphere.push_back(c.sphere);
    wall.push_back(c.wall);
    feature.push_back(c.feature);
    memory.push_back(c.memory);
  }
}

std::vector<WallContact> WallColumns::contacts() const {
  std::vector<WallContact> out;
  for (std::size_t k = 0; k < sphere.size(); ++k) out.push_back({sphere[k], wall[k], feature[k], memory[k]});
  return out;
}

FieldTable WallColumns::table(const std::string& prefix) {
  FieldTable fields = memory.table(prefix);
  fields.insert(fields.begin(), {{prefix + "sphere", "", "sphere", &sphere, prefix},
                                 {prefix + "wall", "", "wall, in the order of the scene", &wall, prefix},
                                 {prefix + "feature", "", "of a mesh: its faces, then edges, then vertices",
                                  &feature, prefix}});
  return fields;
}

namespace {

/// Constants that not all scenes have.
FieldTable rare_constants(Bodies& b) {
  return {
      {"held", "", "0: free; k: moves as row k - 1 of /held_motions says", &b.held, "body"},
      {"wall_set", "", "0: all walls touch it; k: those of row k - 1 of /wall_sets", &b.wall_set, "body"}};
}

}  // namespace

FieldTable body_constants(Bodies& b) {
  FieldTable table{
      {"mass", "kg", "mass", &b.mass, "body"},
      {"volume", "m^3", "mass over density", &b.volume, "body"},
      {"inertia", "kg m^2", "principal moments of inertia", &b.inertia, "body"},
      {"shape", "", "index into /shapes", &b.shape, "body"},
      {"size", "m", "reference radius that scales the shape", &b.length, "body"},
      {"material", "", "index into /materials", &b.material, "body"},
      {"first_sphere", "", "spheres of body b: first_sphere[b] to first_sphere[b+1]", &b.first_sphere, ""}};
  const FieldTable rare = rare_constants(b);
  if (!b.held.empty()) table.push_back(rare[0]);
  if (!b.wall_set.empty()) table.push_back(rare[1]);
  return table;
}

FieldTable sphere_constants(Bodies& b) {
  Spheres& s = b.spheres;
  return {{"radius", "m", "radius", &s.radius, "sphere"},
          {"mass", "kg", "mass that gravity pulls", &s.mass, "sphere"},
          {"offset", "m", "centre in the principal frame of its body", &s.offset, "sphere"},
          {"body", "", "body it belongs to", &s.body, "sphere"}};
}

FieldTable motion_fields(Bodies& b) {
  return {{"position", "m", "centre of mass, from the centre of its cell", &b.position, "body"},
          {"velocity", "m/s", "of the centre of mass", &b.velocity, "body"},
          {"orientation", "", "quaternion w, x, y, z: principal frame to space", &b.orientation, "body"},
          {"angular_momentum", "kg m^2/s", "about the centre of mass", &b.spin, "body"}};
}

FieldTable checkpoint_fields(State& s, const FieldTable& contacts, WallColumns& walls) {
  FieldTable table = motion_fields(s.bodies);
  const auto add = [&](const FieldTable& more) { table.insert(table.end(), more.begin(), more.end()); };
  add({{"position_remainder", "m", "what rounding has kept from position", &s.bodies.remainder, "body"},
       {"cell", "", "whole numbers: a body is at cell_edge * cell + position; empty: all are 0",
        &s.bodies.cell},
       {"cell_edge", "m", "of the lattice of cells; 0: none", &s.bodies.cell_edge},
       {"frame/position", "m", "zero of all positions, at time 0", &s.frame.position},
       {"frame/velocity", "m/s", "of the zero", &s.frame.velocity},
       {"frame/shift", "m", "its position from the zero of the scene", &s.shift.position},
       {"frame/shift_velocity", "m/s", "its velocity from the zero of the scene", &s.shift.velocity},
       {"box/edge", "m", "of the periodic box; 0: open in that direction", &s.box.edge},
       {"box/rate", "1/s", "d ln(edge)/dt", &s.box.rate},
       {"strain/start", "m", "edges at the start of the stage", &s.strain.start},
       {"strain/rate", "1/s", "of the stage", &s.strain.rate},
       {"strain/until", "s", "since the start of the stage: when the strain ends", &s.strain.until, "",
        Domain::any},
       {"held/position", "m", "of held bodies, in their order, where their motion has not displaced them",
        &s.held.position, "held"},
       {"held/orientation", "", "quaternion w, x, y, z, the same", &s.held.orientation, "held"},
       {"force", "N", "of the last evaluation", &s.bodies.force, "body"},
       {"torque", "N m", "of the last evaluation, about the centre of mass", &s.bodies.torque, "body"},
       {"remnant", "", "1: part of the pile that is spun", &s.remnant, "body"},
       {"gravity/from/force", "N", "self-gravity at gravity/time, in the pile's frame",
        &s.gravity.from.force},
       {"gravity/from/torque", "N m", "the same", &s.gravity.from.torque},
       {"gravity/to/force", "N", "forecast for the next evaluation", &s.gravity.to.force},
       {"gravity/to/torque", "N m", "the same", &s.gravity.to.torque},
       {"gravity/evaluated/force", "N", "last evaluation", &s.gravity.evaluated.force},
       {"gravity/evaluated/torque", "N m", "the same", &s.gravity.evaluated.torque},
       {"gravity/evaluated/places", "m", "of the spheres then, in the pile's frame", &s.gravity.places},
       {"gravity/evaluated/time", "s", "of that evaluation", &s.gravity.evaluated_time},
       {"gravity/time", "s", "of the last evaluation or rest", &s.gravity.time},
       {"gravity/interval", "s", "from then to the next look", &s.gravity.interval},
       {"gravity/steps", "", "the same in steps", &s.gravity.steps},
       {"gravity/due", "", "step of the stage of the next look", &s.gravity.due},
       {"gravity/attitude", "", "quaternion w, x, y, z: the pile's frame to space", &s.gravity.attitude},
       {"gravity/miss", "", "of the last forecast, relative", &s.gravity.miss},
       {"gravity/omega", "rad/s", "angular velocity of the pile then", &s.gravity.omega},
       {"gravity/scale", "m/s^2", "rms acceleration of the spheres then", &s.gravity.scale},
       {"gravity/factor", "", "tolerance of the tree's interactions over scale; 0: none", &s.gravity.factor},
       {"gravity/error", "", "of the field, measured at the start of the stage", &s.gravity.error},
       {"clock/stage", "", "number of the stage", &s.clock.stage},
       {"clock/step", "", "steps done in the stage", &s.clock.step},
       {"clock/steps", "", "steps of the stage", &s.clock.steps},
       {"clock/total_steps", "", "steps done in all", &s.clock.total_steps},
       {"clock/stage_start", "s", "time at the start of the stage", &s.clock.stage_start},
       {"clock/dt", "s", "time step", &s.clock.dt},
       {"clock/stage_starts", "s", "times at which the stages so far began", &s.stage_starts},
       {"wall_lead", "s", "time that each wall of the scene had moved before this run", &s.wall_lead},
       {"region_volume", "m^3", "of the region last carved; 0: none", &s.region_volume},
       {"ledger/field_momentum", "kg m/s", "given by uniform fields in the stages before this one",
        &s.ledger.field_momentum},
       {"ledger/rebase", "", "momenta are to be counted anew from the next stage on", &s.ledger.rebase},
       {"control/active", "", "spin control is on", &s.control.active},
       {"control/settled", "", "the pile has been at rest under control", &s.control.settled},
       {"control/failed", "", "the pile has failed: a fall of c/a has lasted", &s.control.failed},
       {"control/limit_ratio", "", "c/a below which it has fallen", &s.control.limit_ratio},
       {"control/hold", "s", "that a fall must last", &s.control.hold},
       {"control/failure_time", "s", "when that fall began", &s.control.failure_time},
       {"control/failure_period", "s", "spin period asked for then", &s.control.failure_period},
       {"control/failure_ratio", "", "c/a then", &s.control.failure_ratio},
       {"control/shortest_period", "s", "shortest period held; 0: none", &s.control.shortest_period},
       {"control/start_ratio", "", "c/a against which falls are judged; 0: control has not begun",
        &s.control.start_ratio},
       {"control/start_time", "s", "time of that c/a", &s.control.start_time},
       {"control/start_rate", "rad/s", "spin of the pile when control began", &s.control.start_rate},
       {"control/fall_time", "s", "since when c/a has been too small; negative: it is not",
        &s.control.fall_time},
       {"control/fall_period", "s", "spin period asked for then", &s.control.fall_period},
       {"control/fall_ratio", "", "c/a then", &s.control.fall_ratio},
       {"control/next_check", "", "step of the stage at which the pile is looked at next",
        &s.control.next_check},
       {"ledger/dissipated", "J", "work lost in contacts", &s.ledger.dissipated},
       {"ledger/wall_work", "J", "work done by moving walls and held bodies", &s.ledger.wall_work},
       {"ledger/wall_power", "W", "of these at the last evaluation", &s.ledger.wall_power},
       {"ledger/control_work", "J", "work done by spin control", &s.ledger.control_work},
       {"ledger/relaxed", "J", "energy taken out by stages that relax", &s.ledger.relaxed},
       {"ledger/stage_work", "J", "given to springs by changes from stage to stage", &s.ledger.stage_work},
       {"relaxation/pile", "", "number of each body's pile while it relaxes; empty: the stage does not",
        &s.relaxation.pile},
       {"relaxation/scale", "J", "what the energy inside the piles is compared with", &s.relaxation.scale},
       {"relaxation/look", "", "steps between looks at it", &s.relaxation.look},
       {"ledger/control_momentum", "kg m^2/s", "angular momentum given by spin control",
        &s.ledger.control_momentum},
       {"ledger/perturbers/work", "J", "done by perturbers", &s.ledger.perturbers.work},
       {"ledger/perturbers/momentum", "kg m/s", "given by perturbers", &s.ledger.perturbers.momentum},
       {"ledger/perturbers/angular_momentum", "kg m^2/s", "given by perturbers, about the mass centre",
        &s.ledger.perturbers.angular_momentum},
       {"ledger/perturbers/power", "W", "of perturbers at the last evaluation",
        &s.ledger.perturbers.rates.power},
       {"ledger/perturbers/force", "N", "of perturbers at the last evaluation",
        &s.ledger.perturbers.rates.force},
       {"ledger/perturbers/torque", "N m", "of perturbers at the last evaluation, about the mass centre",
        &s.ledger.perturbers.rates.torque},
       {"ledger/largest_overlap", "", "over the smaller radius of its pair", &s.ledger.largest_overlap},
       {"ledger/recent_overlap", "", "the same since the last row of the series", &s.ledger.recent_overlap},
       {"ledger/start_momentum", "kg m/s", "total at the start", &s.ledger.start_momentum},
       {"ledger/start_angular_momentum", "kg m^2/s", "total at the start, about the mass centre",
        &s.ledger.start_angular_momentum},
       {"wall_loads/force", "N", "on each wall of the scene at the last evaluation", &s.walls.loads.force},
       {"wall_loads/torque", "N m", "the same, about the rotation point", &s.walls.loads.torque},
       {"wall_loads/impulse", "N s", "on each wall since wall_loads/since", &s.walls.loads.impulse},
       {"wall_loads/angular_impulse", "N m s", "the same, about the rotation point",
        &s.walls.loads.angular_impulse},
       {"driven/place", "m", "of each wall of the scene, along the axis of its load", &s.walls.driven.place},
       {"driven/speed", "m/s", "the same", &s.walls.driven.speed},
       {"wall_loads/since", "s", "the last row of the series", &s.walls.loads.since},
       {"stiffness", "N/m", "normal stiffness of the stage, of materials without their own", &s.k_n}});
  add(contacts);
  add(walls.table("walls/"));
  return table;
}

void write_break(ResultFile& file, Clock clock) {
  double time = clock.time();
  file.write_static("broken_off", {{"steps", "", "done in all", &clock.total_steps},
                                   {"stage", "", "number of the stage", &clock.stage},
                                   {"time", "s", "since the start of the run", &time}});
}

Reached reached(const ResultFile& file, const Clock& checkpoint) {
  Reached out{checkpoint.total_steps, checkpoint.time()};
  if (file.has_group("broken_off"))
    file.read_static("broken_off", {{"steps", "", "", &out.steps}, {"time", "", "", &out.time}});
  return out;
}

void write_bodies(ResultFile& file, Bodies& bodies, const std::string& suffix) {
  file.write_static("bodies" + suffix, body_constants(bodies));
  file.write_static("spheres" + suffix, sphere_constants(bodies));
}

void write_constants(ResultFile& file, State& state, std::vector<std::string>& shapes,
                     std::vector<std::string>& materials) {
  write_bodies(file, state.bodies);
  file.write_static("shapes", {{"name", "", "library name or path", &shapes}});
  file.write_static("materials", {{"name", "", "as in the scene", &materials}});
  file.write_static("frame",
                    {{"position", "m", "zero of all positions, at time 0", &state.frame.position},
                     {"velocity", "m/s", "of the zero: add it to velocities", &state.frame.velocity}});
}

void read_constants(const ResultFile& file, Bodies& b, std::vector<std::string>& shapes) {
  read_constants(file, b, shapes, std::numeric_limits<std::uint64_t>::max());
}

void read_constants(const ResultFile& file, Bodies& b, std::vector<std::string>& shapes,
                    std::uint64_t epoch) {
  const std::string group = file.constants("bodies", epoch);
  FieldTable table = body_constants(b);
  for (const DatasetInfo& there : file.list(group))
    for (const Field& rare : rare_constants(b))
      if (rare.name == there.name) table.push_back(rare);
  file.read_static(group, table);
  file.read_static(file.constants("spheres", epoch), sphere_constants(b));
  file.read_static("shapes", {{"name", "", "", &shapes}});
  const auto fail = [&]<class... Args>(fmt::format_string<Args...> what, Args&&... args) {
    throw InputError("{}: {}", file.path().string(), fmt::format(what, std::forward<Args>(args)...));
  };
  const std::size_t n = b.mass.size(), spheres = b.spheres.radius.size();
  if (n == 0 || b.first_sphere.size() != n + 1 || b.first_sphere.front() != 0 ||
      b.first_sphere.back() != spheres)
    fail("bodies/first_sphere: expected {} increasing entries from 0 to the number of spheres", n + 1);
  for (const auto* column : {&b.held, &b.wall_set})
    if (!column->empty() && column->size() != n) fail("bodies/held, bodies/wall_set: expected {} entries", n);
  for (std::size_t k = 0; k < n; ++k) {
    if (b.first_sphere[k] >= b.first_sphere[k + 1])
      fail("bodies/first_sphere: expected increasing entries, found a fall after body {}", k);
    const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
    const bool good = positive(b.mass[k]) && positive(b.volume[k]) && positive(b.length[k]) &&
                      b.inertia[k].allFinite() && b.inertia[k].minCoeff() > 0.0;
    if (!good) fail("bodies/mass, volume, size, inertia: expected positive values, body {} has others", k);
    if (b.shape[k] >= shapes.size())
      fail("bodies/shape: body {} has number {}, there are {} shapes", k, b.shape[k], shapes.size());
    for (std::uint32_t s = b.first_sphere[k]; s < b.first_sphere[k + 1]; ++s)
      if (b.spheres.body[s] != k || !positive(b.spheres.radius[s]) || !(b.spheres.mass[s] >= 0.0) ||
          !std::isfinite(b.spheres.mass[s]) || !b.spheres.offset[s].allFinite())
        fail("spheres/body, radius, mass, offset: sphere {} does not fit body {}", s, k);
  }
  b.force.resize(n, Vec3::Zero());
  b.torque.resize(n, Vec3::Zero());
  b.spheres.position.resize(spheres);
}

}  // namespace cairn
