#include "pile/match_walls.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "sim/make_walls.h"
#include "sim/springs.h"

namespace cairn {

namespace {

/// Parts of the smallest radius that a place may be off, as one typed from a table is.
constexpr double kSamePlace = 1e-6;
constexpr double kSameDirection = 1e-9;

bool same_direction(const Vec3& a, const Vec3& b) {
  return (a - b).norm() <= kSameDirection;
}

/// A surface of a wall in space, moved on by `shift`.
WallSurface in_space(const Wall& wall, double time, const Vec3& shift) {
  const WallPose pose = wall.motion.pose(time);
  const auto at = [&](const Vec3& y) -> Vec3 { return pose.to_space_point(y) + shift; };
  if (const auto* plane = std::get_if<PlaneSurface>(&wall.surface))
    return PlaneSurface{at(plane->point), pose.to_space(plane->normal)};
  if (const auto* sphere = std::get_if<SphereSurface>(&wall.surface))
    return SphereSurface{at(sphere->center), sphere->radius, sphere->inside};
  const auto& cylinder = std::get<CylinderSurface>(wall.surface);
  return CylinderSurface{at(cylinder.point), pose.to_space(cylinder.axis), cylinder.radius, cylinder.inside};
}

bool same_mesh(const Wall& a, double time_a, const Vec3& shift, const Wall& b, double time_b, double near) {
  const TriangleMesh &m = a.mesh()->mesh(), &n = b.mesh()->mesh();
  if (m.triangles != n.triangles || m.vertices.size() != n.vertices.size()) return false;
  const WallPose at = a.motion.pose(time_a), bt = b.motion.pose(time_b);
  for (std::size_t v = 0; v < m.vertices.size(); ++v)
    if ((at.to_space_point(m.vertices[v]) + shift - bt.to_space_point(n.vertices[v])).norm() > near)
      return false;
  return true;
}

/// Whether wall a at time_a, moved on by `shift`, is where wall b is at time_b and of its shape, to `near`
/// (m).
bool same_place(const Wall& a, double time_a, const Vec3& shift, const Wall& b, double time_b, double near) {
  if (a.surface.index() != b.surface.index()) return false;
  if (a.mesh()) return same_mesh(a, time_a, shift, b, time_b, near);
  const WallSurface s = in_space(a, time_a, shift), t = in_space(b, time_b, Vec3::Zero());
  if (const auto* p = std::get_if<PlaneSurface>(&s)) {
    const auto& q = std::get<PlaneSurface>(t);
    return same_direction(p->normal, q.normal) && std::abs(p->normal.dot(p->point - q.point)) <= near;
  }
  if (const auto* p = std::get_if<SphereSurface>(&s)) {
    const auto& q = std::get<SphereSurface>(t);
    return p->inside == q.inside && std::abs(p->radius - q.radius) <= near &&
           (p->center - q.center).norm() <= near;
  }
  const auto &p = std::get<CylinderSurface>(s), &q = std::get<CylinderSurface>(t);
  return p.inside == q.inside && std::abs(p.radius - q.radius) <= near &&
         (same_direction(p.axis, q.axis) || same_direction(p.axis, -q.axis)) &&
         p.axis.cross(p.point - q.point).norm() <= near;
}

/// Whether b moves as a does in a frame that moves by `velocity` (m/s) in b's.
bool same_motion(const WallMotion& a, const WallMotion& b, const Vec3& velocity) {
  return a.velocity + velocity == b.velocity && a.amplitude == b.amplitude && a.frequency == b.frequency &&
         a.phase == b.phase && a.spin == b.spin;
}

const Material& material_of(const Scene& scene, std::size_t wall) {
  return *std::find_if(scene.materials.begin(), scene.materials.end(),
                       [&](const Material& m) { return m.name == scene.walls[wall].material; });
}

/// The first stage that takes time; none: the number of stages.
std::size_t first_stage(const Scene& scene) {
  std::size_t k = 0;
  while (k < scene.stages.size() && scene.stages[k].operates()) ++k;
  return k;
}

/// Energy (J) that contacts, as leave_stiffness leaves them, hold with these walls, by the laws of the stage.
double energy_of(const Physics& physics, const State& state, Walls walls, std::vector<WallContact> contacts) {
  walls.contacts = std::move(contacts);
  std::vector<ContactRecord> none;
  enter_stiffness(physics, state.bodies, state.k_n, none, walls.contacts);
  walls.set_laws(physics.materials, physics.wall_materials, physics.k_n);
  return walls.stored_energy(state.bodies, physics.contacts, state.clock.time());
}

}  // namespace

bool same_values(const Material& a, const Material& b) {
  Material renamed = a;
  renamed.name = b.name;
  return renamed == b;
}

WallHeritage match_walls(const FormerRun& former, const Scene& scene, const std::vector<Wall>& walls,
                         const Frame& shift) {
  WallHeritage out;
  out.lead.assign(scene.walls.size(), 0.0);
  out.driven.resize(scene.walls.size());
  if (former.scene.walls.empty()) return out;
  const State& state = former.state;
  const std::size_t last = former.last.number;
  const Physics& laws = former.last.physics;
  if (state.stage_starts.size() <= last) throw InputError("the starts of its stages are not in the file");
  const double time = state.clock.time();
  const std::vector<double>& radii = state.bodies.spheres.radius;
  const double near = kSamePlace * *std::min_element(radii.begin(), radii.end());
  Walls ending;
  ending.walls = make_walls(former.scene);
  lead_walls(state.wall_lead, ending.walls);
  ending.contacts = former.contacts;
  ending.driven = state.walls.driven;
  ending.check_contacts(state.bodies.spheres.size());
  set_walls(former.scene, last, std::vector<Wall>(ending.walls), state.stage_starts, ending);
  std::vector<ContactRecord> none;
  if (state.clock.steps > 0) leave_stiffness(laws, state.bodies, none, ending.contacts);

  // For each wall at the end of that run, the one that it is in the scene.
  std::vector<std::optional<std::uint32_t>> same(ending.walls.size());
  const auto find = [&](std::uint32_t n) {
    const Wall& wall = walls[n];
    const bool moves = wall.motion.moves() && !scene.walls[n].motion_time;
    for (std::uint32_t w = 0; w < same.size(); ++w) {
      const Wall& old = ending.walls[w];
      const Material &was = material_of(former.scene, ending.number[w]), &is = material_of(scene, n);
      if (same[w] || (was.name != is.name && !same_values(was, is))) continue;
      const double lead = time - old.motion.since;
      const auto meets = [&](const Vec3& driven) {
        if (moves && same_motion(old.motion, wall.motion, shift.velocity) &&
            same_place(old, time, shift.position + driven, wall, lead, near)) {
          out.lead[n] = lead;
          out.notes.push_back(fmt::format("{} goes on moving as at the end of {}, {:.6g} s after it began",
                                          describe_wall(scene, n), former.name, lead));
          return true;
        }
        return same_place(old, time, shift.position + driven, wall, 0.0, near);
      };
      const std::uint32_t number = ending.number[w];
      const bool under_load = old.drive && wall.drive && same_direction(old.drive->axis, wall.drive->axis);
      const bool as_before = under_load && meets(Vec3::Zero());  // and moved by its load since
      if (!as_before &&
          !meets(old.drive ? Vec3(ending.driven.place[number] * old.drive->axis) : Vec3::Zero()))
        continue;
      if (as_before) out.driven.place[n] = ending.driven.place[number];
      if (under_load) {
        out.driven.speed[n] = ending.driven.speed[number];
        out.notes.push_back(fmt::format("{} goes on under its load from {:.6g} m at {:.6g} m/s",
                                        describe_wall(scene, n), out.driven.place[n], out.driven.speed[n]));
      }
      same[w] = n;
      return;
    }
  };
  const std::size_t first = first_stage(scene);
  for (std::uint32_t n = 0; n < walls.size(); ++n)
    if (first < scene.stages.size() && has_wall(scene, first, n)) find(n);

  std::vector<std::vector<WallContact>> lost(same.size());
  for (const WallContact& c : ending.contacts)
    if (same[c.wall])
      out.contacts.push_back({c.sphere, *same[c.wall], c.feature, c.memory});
    else
      lost[c.wall].push_back(c);
  std::sort(out.contacts.begin(), out.contacts.end(), in_order);
  for (std::size_t w = 0; w < lost.size(); ++w)
    if (!lost[w].empty())
      out.warnings.push_back(fmt::format(
          "{} is not here at its place, of its kind and of its material: its {} contacts are dropped with "
          "the {:.3g} J in their springs",
          describe_wall(former.scene, ending.number[w]), lost[w].size(),
          energy_of(laws, state, ending, lost[w])));
  out.ending.walls = std::move(ending.walls);
  for (const std::optional<std::uint32_t>& number : same)
    out.ending.number.push_back(number.value_or(kNoWall));
  return out;
}

}  // namespace cairn
