#include "contact/walls.h"

#include <algorithm>
#include <cmath>

#include "contact/dashpots.h"
#include "contact/law/partial.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/vector.h"

namespace cairn {

namespace {

constexpr double kSameSurface =
    0.99;  // cosine between two steps' normals of one contact that changes feature

/// A touch in space.
struct Meeting {
  WallContact contact{};
  WallTouch touch;         // in the wall frame
  bool remembers = false;  // has a history
};

/// What comes of one block of bodies.
struct Tally {
  WallReport report;
  std::vector<WallLoad> loads;        // of each wall; empty: nothing touches
  std::vector<WallContact> contacts;  // that remain
};

/// The effective masses of a contact whose wall moves under a load, which yields along its axis only.
EffectiveMass yielding(const EffectiveMass& body, const WallDrive& drive, const Vec3& n) {
  const double along = std::pow(drive.axis.dot(n), 2) / drive.mass;
  const double normal = 1.0 / body.normal + along, across = 2.0 / body.tangential + 1.0 / drive.mass - along;
  // A direction in which neither side yields, as that across the axis to a held body, has no mass.
  const double least = 1e-9 / drive.mass;
  return {1.0 / (normal > least ? normal : 1.0 / drive.mass),
          2.0 / (across > least ? across : 2.0 / drive.mass)};
}

bool in_order(const WallContact& a, const WallContact& b) {
  return std::tuple(a.sphere, a.wall, a.feature) < std::tuple(b.sphere, b.wall, b.feature);
}

}  // namespace

WallReport& WallReport::operator+=(const WallReport& other) {
  dissipated += other.dissipated;
  power += other.power;
  kicked += other.kicked;
  if (other.overlap_ratio > overlap_ratio) {
    overlap_ratio = other.overlap_ratio;
    sphere = other.sphere;
    wall = other.wall;
  }
  return *this;
}

/// One block of bodies against all walls.
class Walls::Sweeper {
 public:
  Sweeper(const Walls& walls, const std::vector<SphereMotion>& motions, const SweepSettings& settings,
          const WallFilter& filter, const std::vector<WallPose>& start, const std::vector<WallPose>& end,
          const std::vector<WallPose>& middle, Bodies& bodies)
      : walls_(walls),
        motions_(motions),
        settings_(settings),
        filter_(filter),
        start_(start),
        end_(end),
        middle_(middle),
        bodies_(bodies) {
    for (std::uint32_t w = 0; w < walls.walls.size(); ++w)
      if (!walls.walls[w].mesh() && walls.walls[w].moves()) moving_.push_back(w);
  }

  /// Spheres [begin, end); the contacts that remain are written to the tally.
  template <Features F>
  void run(std::uint32_t begin, std::uint32_t end, const std::vector<WallCandidates::Entry>& entries,
           Tally& tally) const {
    static thread_local std::vector<Meeting> meetings;
    const std::vector<WallContact>& before = walls_.contacts;
    auto old = std::lower_bound(before.begin(), before.end(), begin,
                                [](const WallContact& c, std::uint32_t s) { return c.sphere < s; });
    auto entry = entries.begin();
    for (std::uint32_t s = begin; s < end; ++s) {
      const auto first_entry = entry;
      while (entry != entries.end() && entry->sphere == s) ++entry;
      const auto first_old = old;
      while (old != before.end() && old->sphere == s) ++old;
      find_meetings(s, {first_entry, entry}, meetings);
      if (meetings.empty() && first_old == old) continue;
      tally.loads.resize(walls_.walls.size());
      match<F>({first_old, old}, meetings, tally);
      for (Meeting& m : meetings) {
        act<F>(m, tally);
        tally.contacts.push_back(m.contact);
      }
    }
  }

 private:
  const SphereMotion& motion(std::uint32_t s) const { return motions_[s]; }
  Vec3 position(std::uint32_t s) const { return bodies_.spheres.position[s]; }
  Vec3 middle_position(std::uint32_t s) const {
    return position(s) - 0.5 * settings_.dt * vector(motion(s).velocity_mid);
  }

  /// What sphere s touches, in the order of wall and feature.
  void find_meetings(std::uint32_t s, std::span<const WallCandidates::Entry> entries,
                     std::vector<Meeting>& meetings) const {
    static thread_local std::vector<std::uint32_t> triangles;
    static thread_local std::vector<WallTouch> touches;
    meetings.clear();
    const auto add = [&](std::uint32_t w) {
      for (const WallTouch& t : touches) meetings.push_back({{s, w, t.feature, {}}, t, false});
    };
    const double radius = motion(s).radius;
    const auto smooth = [&](std::uint32_t w) {
      const WallTouch t = walls_.walls[w].nearest(end_[w].to_wall(position(s)));
      touches.clear();
      if (t.arm < radius) touches.push_back(t);
      add(w);
    };
    for (std::size_t k = 0; k < entries.size();) {
      const std::uint32_t w = entries[k].wall;
      const MeshSurface* mesh = walls_.walls[w].mesh();
      if (!mesh) {
        smooth(w);
        ++k;
        continue;
      }
      triangles.clear();
      for (; k < entries.size() && entries[k].wall == w; ++k) triangles.push_back(entries[k].triangle);
      touches.clear();
      mesh->touch(end_[w].to_wall(position(s)), radius, triangles, touches);
      add(w);
    }
    for (const std::uint32_t w : moving_)
      if (filter_.touches(w, bodies_.spheres.body[s])) smooth(w);
    if (!moving_.empty())
      std::sort(meetings.begin(), meetings.end(),
                [](const Meeting& a, const Meeting& b) { return in_order(a.contact, b.contact); });
  }

  /// Gives the meetings the histories of the contacts that they continue; contacts that none continues end.
  template <Features F>
  void match(std::span<const WallContact> before, std::vector<Meeting>& meetings, Tally& tally) const {
    static thread_local std::vector<const WallContact*> left;
    left.clear();
    for (const WallContact& c : before) {
      const auto same = std::find_if(meetings.begin(), meetings.end(), [&](const Meeting& m) {
        return m.contact.wall == c.wall && m.contact.feature == c.feature;
      });
      if (same == meetings.end()) {
        left.push_back(&c);
        continue;
      }
      same->contact.memory = c.memory;
      same->remembers = true;
    }
    for (Meeting& m : meetings) {
      if (m.remembers || left.empty()) continue;
      const Wall& wall = walls_.walls[m.contact.wall];
      const Vec3 y = end_[m.contact.wall].to_wall(position(m.contact.sphere));
      auto best = left.end();
      double cosine = kSameSurface;
      for (auto c = left.begin(); c != left.end(); ++c) {
        if ((*c)->wall != m.contact.wall) continue;
        const double here = wall.extend((*c)->feature, y).n.dot(m.touch.n);
        if (here > cosine) {
          cosine = here;
          best = c;
        }
      }
      if (best == left.end()) continue;
      m.contact.memory = (*best)->memory;
      m.remembers = true;
      left.erase(best);
    }
    for (const WallContact* c : left) part<F>(*c, tally);
  }

  /// An impulse on the body of a sphere at a point of a wall.
  void kick(std::uint32_t s, std::uint32_t wall, const Vec3& c, const ContactAction<double>& due,
            Tally& tally) const {
    const Vec3 impulse = vector(due.force), couple = vector(due.couple);
    const std::uint32_t b = bodies_.spheres.body[s];
    bodies_.velocity[b] += impulse / bodies_.mass[b];
    bodies_.spin[b] += (c - bodies_.position[b]).cross(impulse) + couple;
    tally.report.kicked += impulse.dot(end_[wall].velocity_at(c)) + couple.dot(end_[wall].spin);
    tally.loads[wall].kick -= impulse;
    tally.loads[wall].angular_kick -= (c - end_[wall].pivot()).cross(impulse) + couple;
  }

  /// Ends a contact: its springs' energy is lost.
  template <Features F>
  void part(const WallContact& contact, Tally& tally) const {
    const Wall& wall = walls_.walls[contact.wall];
    const WallPose &start = start_[contact.wall], &end = end_[contact.wall], &middle = middle_[contact.wall];
    const std::uint32_t s = contact.sphere;
    const SphereMotion& sphere = motion(s);
    const Vec3 x = position(s), way = settings_.dt * vector(sphere.velocity_mid);
    const auto touch_at = [&](const WallPose& pose, const Vec3& at) {
      return wall.extend(contact.feature, pose.to_wall(at));
    };
    const WallTouch touch = touch_at(end, x), touch_mid = touch_at(middle, x - 0.5 * way),
                    touch_start = touch_at(start, x - way);
    const LawConstants<double> law(walls_.law(bodies_, settings_, contact.wall, s));
    const double gap = touch.arm - sphere.radius, overlap = sphere.radius - touch_start.arm;
    if (gap < 0.0 || overlap <= 0.0) {  // no parting within the step
      tally.report.dissipated +=
          cairn::stored_energy<F>(law, std::max(0.0, -gap), sphere.radius, contact.memory);
      return;
    }
    const Vec3 n = end.to_space(touch.n), n_start = start.to_space(touch_start.n);
    const Vec3 lever_mid = touch_mid.arm * middle.to_space(touch_mid.n), c = x + touch.arm * n;
    const Vec3 u_mid = middle.velocity_at(x - 0.5 * way + lever_mid) - vector(sphere.velocity_mid),
               u_end = end.velocity_at(c) - vector(sphere.velocity);

    ContactGeometry<double> geometry;
    geometry.n = geometry.n_mid = triple(n);
    geometry.overlap = overlap;
    geometry.radius = sphere.radius;
    geometry.slip_lever = 0.5 / touch.arm;
    ContactMotion<double> motion;
    motion.u = motion.u_mid = triple(u_mid - vector(sphere.spin_mid).cross(lever_mid));
    motion.w = motion.w_mid = triple(middle.spin - vector(sphere.spin_mid));
    motion.turn = {};
    motion.dt = overlap / (overlap + gap) * settings_.dt;
    const PartingSpeeds speeds{(2.0 * u_mid - u_end).dot(n_start), u_mid.dot(n_start), u_mid.dot(n)};
    const double mass = walls_.effective_mass(bodies_, end, touch, contact.wall, s).normal;
    const PartialStep step{law.k_n, contact.memory.c_n, pull<F>(law, sphere.radius), mass, settings_.dt};
    const ContactAction<double> due = parting<F>(law, geometry, motion, speeds, step, contact.memory);
    kick(s, contact.wall, c, due, tally);
    tally.report.dissipated += due.dissipated;
  }

  /// Evaluates the law and adds its wrench.
  template <Features F>
  void act(Meeting& meeting, Tally& tally) const {
    const WallTouch& touch = meeting.touch;
    WallContact& contact = meeting.contact;
    const std::uint32_t s = contact.sphere, b = bodies_.spheres.body[s];
    const Wall& wall = walls_.walls[contact.wall];
    const WallPose &end = end_[contact.wall], &middle = middle_[contact.wall];
    const SphereMotion& sphere = motion(s);
    double mass = 0.0;  // effective, of a contact that begins
    if (!meeting.remembers) mass = walls_.set_damping(bodies_, settings_, end, touch, contact);

    const Vec3 x_mid = middle_position(s);
    const WallTouch touch_mid = wall.extend(touch.feature, middle.to_wall(x_mid));
    const Vec3 n = end.to_space(touch.n), n_mid = middle.to_space(touch_mid.n);
    const Vec3 lever = touch.arm * n, lever_mid = touch_mid.arm * n_mid;  // from the centre to the wall
    const Vec3 c = position(s) + lever, c_mid = x_mid + lever_mid;
    const Vec3 velocity = end.velocity_at(c);

    ContactGeometry<double> geometry;
    geometry.n = triple(n);
    geometry.n_mid = triple(n_mid);
    geometry.overlap = sphere.radius - touch.arm;
    geometry.radius = sphere.radius;
    geometry.slip_lever = 0.5 / touch.arm;
    ContactMotion<double> motion;
    motion.u = triple(velocity - vector(sphere.velocity) - vector(sphere.spin).cross(lever));
    motion.u_mid = triple(middle.velocity_at(c_mid) - vector(sphere.velocity_mid) -
                          vector(sphere.spin_mid).cross(lever_mid));
    motion.w = triple(end.spin - vector(sphere.spin));
    motion.w_mid = triple(middle.spin - vector(sphere.spin_mid));
    motion.turn = triple(0.5 * (vector(sphere.spin_mid) + middle.spin));
    motion.dt = settings_.dt;
    if (!meeting.remembers)
      motion.dt = age(geometry.overlap, dot(motion.u_mid, geometry.n_mid), settings_.dt);
    const LawConstants<double> law(walls_.law(bodies_, settings_, contact.wall, s));
    const ContactAction<double> action = evaluate<F>(law, geometry, motion, contact.memory);

    const Vec3 force = vector(action.force), couple = vector(action.couple);
    bodies_.force[b] += force;
    bodies_.torque[b] += (c - bodies_.position[b]).cross(force) + couple;
    WallLoad& load = tally.loads[contact.wall];
    load.force -= force;
    load.torque -= (c - end.pivot()).cross(force) + couple;
    tally.report += {.dissipated = action.dissipated,
                     .power = force.dot(velocity) + couple.dot(end.spin),
                     .kicked = 0.0,
                     .overlap_ratio = geometry.overlap / sphere.radius,
                     .sphere = s,
                     .wall = contact.wall};
    if (motion.dt < settings_.dt) {  // it has begun within the step
      const PartialStep step{law.k_n, contact.memory.c_n, pull<F>(law, sphere.radius), mass, settings_.dt};
      const double normal =
          first_impulse(step, geometry.overlap, -dot(motion.u, geometry.n), dot(action.force, geometry.n));
      kick(s, contact.wall, c,
           first_touch<F>(law, geometry, motion, contact.memory, action, normal, settings_.dt), tally);
    }
  }

  const Walls& walls_;
  const std::vector<SphereMotion>& motions_;
  const SweepSettings& settings_;
  const WallFilter& filter_;
  const std::vector<WallPose>&start_, &end_, &middle_;  // of the step
  Bodies& bodies_;
  std::vector<std::uint32_t> moving_;  // smooth walls
};

void Walls::set_laws(const std::vector<Material>& materials, const std::vector<Material>& wall_materials,
                     double k_n) {
  laws_.clear();
  materials_ = materials.size();
  for (const Material& wall : wall_materials)
    for (const Material& m : materials) laws_.push_back(make_pair_law(wall, m, k_n));
}

std::vector<WallPose> Walls::poses(double time) const {
  std::vector<WallPose> out;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    out.push_back(walls[w].motion.pose(time));
    drive(w, 0.0, out.back());
  }
  return out;
}

void Walls::drive(std::size_t wall, double ago, WallPose& pose) const {
  if (!walls[wall].drive) return;
  const Vec3& axis = walls[wall].drive->axis;
  const std::uint32_t n = scene_number(wall);
  pose.shift += (driven.place[n] - ago * driven.speed[n]) * axis;
  pose.velocity += driven.speed[n] * axis;
}

std::vector<WallPose> Walls::poses_before(double time, double dt) const {
  std::vector<WallPose> out;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    out.push_back(walls[w].motion.pose(time - dt));
    drive(w, dt, out.back());
  }
  return out;
}

std::vector<WallPose> Walls::mid_step(double time, double dt) const {
  std::vector<WallPose> out;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    out.push_back(walls[w].motion.mid_step(time, dt));
    drive(w, 0.5 * dt, out.back());
  }
  return out;
}

double Walls::kinetic_energy() const {
  double energy = 0.0;
  for (std::size_t w = 0; w < walls.size(); ++w)
    if (const std::optional<WallDrive>& drive = walls[w].drive) {
      const double speed = driven.speed[scene_number(w)];
      energy += 0.5 * drive->mass * (speed * speed);
    }
  return energy;
}

WallFilter Walls::filter(const Bodies& bodies) const {
  std::vector<std::vector<std::uint8_t>> here(sets.size());
  for (std::size_t k = 0; k < sets.size(); ++k)
    for (std::size_t w = 0; w < walls.size(); ++w) here[k].push_back(sets[k][scene_number(w)]);
  return {bodies, walls, std::move(here)};
}

void Walls::begin_step(double dt) {
  for (std::size_t w = 0; w < walls.size(); ++w)
    if (walls[w].drive) {
      const std::uint32_t n = scene_number(w);
      driven.begin_step(n, *walls[w].drive, loads.force[n].dot(walls[w].drive->axis), dt);
    }
}

void Walls::end_step(const std::vector<WallLoad>& now, double dt) {
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const std::uint32_t n = scene_number(w);
    loads.add(n, now[w], dt);
    if (const std::optional<WallDrive>& drive = walls[w].drive)
      driven.end_step(n, *drive, now[w].force.dot(drive->axis), now[w].kick.dot(drive->axis), dt);
  }
}

EffectiveMass Walls::effective_mass(const Bodies& bodies, const WallPose& pose, const WallTouch& touch,
                                    std::uint32_t wall, std::uint32_t sphere) const {
  const std::uint32_t b = bodies.spheres.body[sphere];
  const Vec3 n = pose.to_space(touch.n), c = bodies.spheres.position[sphere] + touch.arm * n;
  const EffectiveMass mass =
      cairn::effective_mass(inertia_of(bodies, b), c - bodies.position[b], {}, Vec3::Zero(), n);
  return walls[wall].drive ? yielding(mass, *walls[wall].drive, n) : mass;
}

double Walls::set_damping(const Bodies& bodies, const SweepSettings& settings, const WallPose& pose,
                          const WallTouch& touch, WallContact& contact) const {
  const std::uint32_t s = contact.sphere;
  const PairLaw& pair = law(bodies, settings, contact.wall, s);
  const EffectiveMass mass = effective_mass(bodies, pose, touch, contact.wall, s);
  EffectiveMass mu = mass;
  if (settings.sphere_damping && !is_held(bodies, bodies.spheres.body[s])) {
    mu.normal = bodies.spheres.mass[s];
    mu.tangential = kTangentialRatio * mu.normal;
  }
  contact.memory.c_n = pair.damping_n * std::sqrt(pair.k_n * mu.normal);
  contact.memory.c_s = pair.damping_s * std::sqrt(pair.k_s * mu.tangential);
  return mass.normal;
}

WallReport Walls::sweep(const std::vector<SphereMotion>& motions, const SweepSettings& settings, double time,
                        WallCandidates& candidates, Bodies& bodies) {
  resize(std::max<std::size_t>(loads.force.size(), scene_number(walls.size() - 1) + 1));
  begin_step(settings.dt);
  const std::vector<WallPose> middle = mid_step(time, settings.dt);
  std::vector<WallPose> end = poses(time);
  for (std::size_t w = 0; w < walls.size(); ++w)  // as predicted for the end, as bodies are
    if (const std::optional<WallDrive>& drive = walls[w].drive) {
      const std::uint32_t n = scene_number(w);
      const double force = drive->load + loads.force[n].dot(drive->axis) - drive->damping * driven.speed[n];
      end[w].velocity += 0.5 * settings.dt / drive->mass * force * drive->axis;
    }
  const std::vector<WallPose> start = poses_before(time, settings.dt);
  const WallFilter touching = filter(bodies);
  const Sweeper sweeper(*this, motions, settings, touching, start, end, middle, bodies);
  constexpr std::size_t size = WallCandidates::kBlock;
  const std::size_t blocks = (bodies.size() + size - 1) / size;
  std::vector<Tally> tallies(blocks);
  candidates.resize(bodies);
  with_features(settings.features, [&]<Features F>() {
    parallel_blocks(blocks, 1, [&](std::size_t k, std::size_t) {
      const std::uint32_t first = bodies.first_sphere[k * size];
      const std::uint32_t last = bodies.first_sphere[std::min((k + 1) * size, bodies.size())];
      sweeper.run<F>(first, last, candidates.list(k, bodies, walls, end, touching), tallies[k]);
    });
  });
  WallReport total;
  std::vector<WallLoad> now(walls.size());
  contacts.clear();
  for (const Tally& tally : tallies) {
    total += tally.report;
    for (std::size_t w = 0; w < tally.loads.size(); ++w) now[w] += tally.loads[w];
    contacts.insert(contacts.end(), tally.contacts.begin(), tally.contacts.end());
  }
  end_step(now, settings.dt);
  return total;
}

void Walls::renew_damping(const Bodies& bodies, const Walls* before, const SweepSettings* settings_before,
                          const SweepSettings& settings, double time) {
  const std::vector<WallPose> now = poses(time);
  const bool known = before && settings_before && same_masses(*settings_before, settings);
  const auto law_before = [&](const WallContact& c) -> const PairLaw* {
    for (std::uint32_t w = 0; known && w < before->walls.size(); ++w)
      if (before->scene_number(w) == scene_number(c.wall))
        return &before->law(bodies, *settings_before, w, c.sphere);
    return nullptr;
  };
  for (WallContact& c : contacts) {
    const PairLaw* former = law_before(c);
    if (former && carry_damping(*former, law(bodies, settings, c.wall, c.sphere), c.memory.c_n, c.memory.c_s))
      continue;
    const Vec3 y = now[c.wall].to_wall(bodies.spheres.position[c.sphere]);
    set_damping(bodies, settings, now[c.wall], walls[c.wall].extend(c.feature, y), c);
  }
}

double Walls::stored_energy(const Bodies& bodies, const SweepSettings& settings, double time) const {
  const std::vector<WallPose> now = poses(time);
  double energy = 0.0;
  with_features(settings.features, [&]<Features F>() {
    for (const WallContact& c : contacts) {
      const double radius = bodies.spheres.radius[c.sphere];
      const Vec3 y = now[c.wall].to_wall(bodies.spheres.position[c.sphere]);
      const double arm = walls[c.wall].extend(c.feature, y).arm;
      energy += cairn::stored_energy<F>(LawConstants<double>(law(bodies, settings, c.wall, c.sphere)),
                                        radius - arm, radius, c.memory);
    }
  });
  return energy;
}

DeepestTouch Walls::deepest(const Bodies& bodies, double time) const {
  const std::vector<WallPose> now = poses(time);
  DeepestTouch out;
  for (const WallContact& c : contacts) {
    const Vec3 y = now[c.wall].to_wall(bodies.spheres.position[c.sphere]);
    const double ratio = 1.0 - walls[c.wall].extend(c.feature, y).arm / bodies.spheres.radius[c.sphere];
    if (ratio > out.ratio) out = {ratio, c.sphere, scene_number(c.wall)};
  }
  return out;
}

std::vector<WallContact> Walls::numbered_contacts() const {
  std::vector<WallContact> out = contacts;
  if (!number.empty())
    for (WallContact& c : out) c.wall = number[c.wall];
  return out;
}

void Walls::check_contacts(std::size_t spheres) const {
  for (const WallContact& c : contacts)
    if (c.sphere >= spheres || c.wall >= walls.size() || c.feature >= walls[c.wall].features())
      throw InputError("contact of sphere {} with part {} of wall {}: no such pair", c.sphere, c.feature,
                       c.wall);
  if (!std::is_sorted(contacts.begin(), contacts.end(), in_order))
    throw InputError("contacts with walls are not in order");
}

}  // namespace cairn
