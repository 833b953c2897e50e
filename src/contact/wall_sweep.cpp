// Walls::sweep: contacts of bodies with walls are found, matched with those before, and act.
#include <algorithm>
#include <cmath>

#include "contact/law/partial-inl.h"
#include "contact/walls.h"
#include "core/parallel.h"
#include "core/vector.h"

namespace cairn {

using namespace HWY_NAMESPACE;  // the law of one contact

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
          HWY_NAMESPACE::stored_energy<F>(law, std::max(0.0, -gap), sphere.radius, contact.memory);
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

}  // namespace cairn
