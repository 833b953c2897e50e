#include "contact/sweep.h"

#include <array>

#include "contact/law/law.h"
#include "contact/law/partial.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/vector.h"

namespace cairn {

namespace {

/// Spheres per block: a unit of work that does not depend on threads or on the candidate list.
constexpr std::size_t kBlock = 256;

const PairLaw& law_of(const Bodies& bodies, const SweepSettings& settings, const Pair& pair) {
  const std::uint16_t a = settings.material[bodies.spheres.body[pair.i]];
  const std::uint16_t b = settings.material[bodies.spheres.body[pair.j]];
  return settings.laws[a * settings.materials + b];
}

/// Vector from sphere i to j of a slot (m).
Vec3 separation(const Spheres& spheres, const ContactList& contacts, std::size_t slot) {
  const Pair& p = contacts.pair(slot);
  return spheres.position[p.j] - spheres.position[p.i] + contacts.shift_of(slot);
}

/// The motions of eight spheres, transposed.
struct MotionBatch {
  Triple<Batch> position, velocity_mid, spin_mid, velocity, spin;
  Batch radius;
};

CAIRN_INLINE MotionBatch load_motions(const std::vector<SphereMotion>& motions,
                                      const std::uint32_t (&index)[kLanes]) {
  const double *low[kLanes], *high[kLanes];
  for (std::size_t l = 0; l < kLanes; ++l) {
    low[l] = motions[index[l]].position;
    high[l] = low[l] + 8;
  }
  Batch a[kLanes], b[kLanes];
  load_transposed(low, a);
  load_transposed(high, b);
  return {.position = {a[0], a[1], a[2]},
          .velocity_mid = {a[4], a[5], a[6]},
          .spin_mid = {a[7], b[0], b[1]},
          .velocity = {b[2], b[3], b[4]},
          .spin = {b[5], b[6], b[7]},
          .radius = a[3]};
}

/// The slots of eight contacts; in a quiet packing they usually follow each other.
struct Slots {
  std::uint32_t index[kLanes];
  bool consecutive;

  std::uint32_t operator[](std::size_t lane) const { return index[lane]; }
};

CAIRN_INLINE Batch gather(const std::vector<double>& from, const Slots& slot) {
  Batch out;
  if (slot.consecutive)
    __builtin_memcpy(&out, &from[slot[0]], sizeof out);
  else
    for (std::size_t l = 0; l < kLanes; ++l) out.v[l] = from[slot[l]];
  return out;
}

CAIRN_INLINE void scatter(std::vector<double>& to, const Slots& slot, Batch values) {
  if (slot.consecutive)
    __builtin_memcpy(&to[slot[0]], &values, sizeof values);
  else
    for (std::size_t l = 0; l < kLanes; ++l) to[slot[l]] = values[l];
}

template <Features F>
CAIRN_INLINE ContactMemory<Batch> load_memory(const ContactList& contacts, const Slots& slot) {
  ContactMemory<Batch> m;
  m.c_n = gather(contacts.c_n, slot);
  if constexpr (F.tangential) {
    m.c_s = gather(contacts.c_s, slot);
    m.slide = {gather(contacts.slide[0], slot), gather(contacts.slide[1], slot),
               gather(contacts.slide[2], slot)};
  }
  if constexpr (F.rolling)
    m.roll = {gather(contacts.roll[0], slot), gather(contacts.roll[1], slot), gather(contacts.roll[2], slot)};
  if constexpr (F.twisting) m.twist = gather(contacts.twist, slot);
  return m;
}

template <Features F>
CAIRN_INLINE void store_springs(ContactList& contacts, const Slots& slot, const ContactMemory<Batch>& m) {
  if constexpr (F.tangential) {
    scatter(contacts.slide[0], slot, m.slide.x);
    scatter(contacts.slide[1], slot, m.slide.y);
    scatter(contacts.slide[2], slot, m.slide.z);
  }
  if constexpr (F.rolling) {
    scatter(contacts.roll[0], slot, m.roll.x);
    scatter(contacts.roll[1], slot, m.roll.y);
    scatter(contacts.roll[2], slot, m.roll.z);
  }
  if constexpr (F.twisting) scatter(contacts.twist, slot, m.twist);
}

LawConstants<Batch> gather_laws(const Bodies& bodies, const SweepSettings& settings,
                                const ContactList& contacts, const Slots& slot) {
  LawConstants<Batch> out;
  for (std::size_t l = 0; l < kLanes; ++l) {
    const PairLaw& law = law_of(bodies, settings, contacts.pair(slot[l]));
    out.k_n.v[l] = law.k_n;
    out.k_s.v[l] = law.k_s;
    out.friction.v[l] = law.friction;
    out.rolling.v[l] = law.rolling;
    out.twisting.v[l] = law.twisting;
    out.beta.v[l] = law.beta;
    out.cohesion.v[l] = law.cohesion;
  }
  return out;
}

CAIRN_INLINE void store_wrenches(ContactList& contacts, const Slots& slot, const Triple<Batch>& force,
                                 const Triple<Batch>& torque_i, const Triple<Batch>& torque_j) {
  double* rows[kLanes];
  for (std::size_t l = 0; l < kLanes; ++l) rows[l] = contacts.wrench[slot[l]].force;
  store_transposed({force.x, force.y, force.z, torque_i.x, torque_i.y, torque_i.z, torque_j.x, torque_j.y},
                   rows);
  for (std::size_t l = 0; l < kLanes; ++l) rows[l][8] = torque_j.z[l];
}

void add_first_touches(const ContactList& contacts, const Slots& slot, Mask fresh,
                       const ContactGeometry<Batch>& geometry, Batch age, Batch k_n, double dt,
                       std::vector<PartialKick>& kicks) {
  const FirstTouch<Batch> due = first_touch(k_n, geometry.overlap, age, Batch(dt));
  for (std::size_t l = 0; l < kLanes; ++l) {
    const bool spare = l > 0 && slot[l] == slot[l - 1];
    if (!fresh.v[l] || spare) continue;
    PartialKick kick{contacts.pair(slot[l]), contacts.wrench[slot[l]]};
    const double n[3] = {geometry.n.x[l], geometry.n.y[l], geometry.n.z[l]};
    for (int c = 0; c < 3; ++c) {
      kick.impulse.force[c] = due.wrench[l] * kick.impulse.force[c] + due.normal[l] * n[c];
      kick.impulse.torque_i[c] *= due.wrench[l];
      kick.impulse.torque_j[c] *= due.wrench[l];
    }
    kicks.push_back(kick);
  }
}

/// Takes j where i sees it: in another cell, or as an image that moves with the box.
CAIRN_INLINE void see_shifted(const ContactList& contacts, const Slots& slot, Triple<Batch>& d,
                              Triple<Batch>& u, Triple<Batch>& u_mid) {
  const Triple<Batch> steps{gather(contacts.shift[0], slot), gather(contacts.shift[1], slot),
                            gather(contacts.shift[2], slot)};
  const Vec3 &edge = contacts.lattice, &rate = contacts.lattice_rate;
  d = {fma(edge[0], steps.x, d.x), fma(edge[1], steps.y, d.y), fma(edge[2], steps.z, d.z)};
  const Triple<Batch> flow{edge[0] * rate[0] * steps.x, edge[1] * rate[1] * steps.y,
                           edge[2] * rate[2] * steps.z};
  u = u + flow;
  u_mid = u_mid + flow;
}

/// Eight touching pairs at once.
template <Features F>
void evaluate_batch(const std::vector<SphereMotion>& motions, const LawConstants<Batch>& law, double dt,
                    ContactList& contacts, const Slots& slot, Mask fresh, Batch& dissipated,
                    Batch& overlap_ratio, std::vector<PartialKick>& kicks) {
  std::uint32_t index_i[kLanes], index_j[kLanes];
  for (std::size_t l = 0; l < kLanes; ++l) {
    index_i[l] = contacts.pair(slot[l]).i;
    index_j[l] = contacts.pair(slot[l]).j;
  }
  const MotionBatch a = load_motions(motions, index_i), b = load_motions(motions, index_j);
  const Batch half(0.5);

  Triple<Batch> d = b.position - a.position, u = b.velocity - a.velocity,
                u_mid = b.velocity_mid - a.velocity_mid;
  if (contacts.shifted()) see_shifted(contacts, slot, d, u, u_mid);
  const Triple<Batch> d_mid = fma(Batch(-0.5 * dt), u_mid, d);
  const Batch d2 = dot(d, d), d2_mid = dot(d_mid, d_mid);
  const Batch inverse = rsqrt(d2), inverse_mid = rsqrt(d2_mid);
  const Batch rough = d2 * inverse, distance_mid = d2_mid * inverse_mid;
  const Batch distance = fma(fma(-rough, rough, d2), half * inverse, rough);  // the overlap needs its last bit
  const Batch sum = a.radius + b.radius;
  // Contact point on the radical plane: lever arms (d^2 +- (r_i^2 - r_j^2)) / 2d from the two centres.
  const Batch step = (a.radius - b.radius) * sum;
  const Batch arm_i = half * fma(step, inverse, distance), arm_j = distance - arm_i;
  const Batch arm_i_mid = half * fma(step, inverse_mid, distance_mid), arm_j_mid = distance_mid - arm_i_mid;

  ContactGeometry<Batch> geometry;
  geometry.n = inverse * d;
  geometry.n_mid = inverse_mid * d_mid;
  geometry.overlap = sum - distance;
  geometry.radius = a.radius * b.radius / sum;
  if constexpr (F.rolling_slip) geometry.slip_lever = half * (arm_j - arm_i) / (arm_i * arm_j);

  ContactMotion<Batch> motion;
  motion.u = u - cross(fma(arm_i, a.spin, arm_j * b.spin), geometry.n);
  motion.u_mid = u_mid - cross(fma(arm_i_mid, a.spin_mid, arm_j_mid * b.spin_mid), geometry.n_mid);
  motion.w = b.spin - a.spin;
  motion.w_mid = b.spin_mid - a.spin_mid;
  motion.turn = half * (a.spin_mid + b.spin_mid);
  motion.dt = dt;
  const bool any_fresh = any(fresh);
  if (any_fresh)
    motion.dt = select(fresh, age(geometry.overlap, dot(motion.u_mid, geometry.n_mid), Batch(dt)), Batch(dt));

  ContactMemory<Batch> memory = load_memory<F>(contacts, slot);
  const ContactAction<Batch> action = evaluate<F>(law, geometry, motion, memory);
  store_springs<F>(contacts, slot, memory);
  const Triple<Batch> moment = cross(geometry.n, action.force);
  store_wrenches(contacts, slot, action.force, fma(arm_i, moment, action.couple),
                 fma(arm_j, moment, Batch(-1.0) * action.couple));
  dissipated += action.dissipated;
  overlap_ratio = max(overlap_ratio, geometry.overlap / min(a.radius, b.radius));
  if (any_fresh) add_first_touches(contacts, slot, fresh, geometry, motion.dt, law.k_n, dt, kicks);
}

/// The touching pairs of one block of spheres.
class Block {
 public:
  Block(const Bodies& bodies, const std::vector<SphereMotion>& motions, const SweepSettings& settings,
        ContactList& contacts, std::size_t begin, std::size_t end)
      : bodies_(bodies),
        motions_(motions),
        settings_(settings),
        contacts_(contacts),
        begin_(begin),
        end_(end),
        kicks_(contacts.kicks[begin / kBlock]) {
    kicks_.clear();
  }

  template <Features F>
  SweepReport run(std::vector<std::uint32_t>& active) {
    const std::size_t count =
        contacts_.shifted() ? find_touching<F, true>(active) : find_touching<F, false>(active);
    Batch dissipated(0.0), overlap_ratio(0.0);
    const LawConstants<Batch> single(settings_.laws[0]);
    for (std::size_t k = 0; k < count; k += kLanes) {
      Slots slot;
      Mask fresh{}, used{};
      bool any_fresh = false;
      // Spare lanes repeat the last contact: same values, same slot.
      for (std::size_t l = 0; l < kLanes; ++l) {
        const std::size_t at = std::min(k + l, count - 1);
        slot.index[l] = active[at];
        used.v[l] = k + l < count ? -1 : 0;
        if (!contacts_.touching(slot[l])) {
          fresh.v[l] = -1;
          any_fresh = true;
        }
      }
      slot.consecutive = k + kLanes <= count && slot[kLanes - 1] - slot[0] == kLanes - 1;
      if (any_fresh)
        for (std::size_t l = 0; l < kLanes; ++l)
          if (fresh.v[l]) set_damping(bodies_, settings_, contacts_, slot[l]);
      Batch lost(0.0), deepest(0.0);
      const LawConstants<Batch> law =
          settings_.materials == 1 ? single : gather_laws(bodies_, settings_, contacts_, slot);
      evaluate_batch<F>(motions_, law, settings_.dt, contacts_, slot, fresh, lost, deepest, kicks_);
      dissipated += select(used, lost, Batch(0.0));
      overlap_ratio = max(overlap_ratio, deepest);
    }
    SweepReport out{.dissipated = released_};
    for (std::size_t l = 0; l < kLanes; ++l) {
      out.dissipated += dissipated[l];
      out.overlap_ratio = std::max(out.overlap_ratio, overlap_ratio[l]);
    }
    return out;
  }

 private:
  /// Writes the touching slots to `active`, ends contacts that have parted (their springs' energy is lost).
  template <Features F, bool shifted>
  std::size_t find_touching(std::vector<std::uint32_t>& active) {
    const std::uint32_t first = contacts_.begin(begin_), last = contacts_.begin(end_);
    active.resize(last - first);
    std::size_t count = 0;
    for (std::size_t s = begin_; s < end_; ++s) {
      const SphereMotion& a = motions_[s];
      for (std::uint32_t slot = contacts_.begin(s); slot < contacts_.begin(s + 1); ++slot) {
        const SphereMotion& b = motions_[contacts_.pair(slot).j];
        double x = b.position[0] - a.position[0], y = b.position[1] - a.position[1],
               z = b.position[2] - a.position[2];
        if constexpr (shifted) {
          x = fma(contacts_.lattice[0], contacts_.shift[0][slot], x);
          y = fma(contacts_.lattice[1], contacts_.shift[1][slot], y);
          z = fma(contacts_.lattice[2], contacts_.shift[2][slot], z);
        }
        const double sum = a.radius + b.radius;
        const bool touch = fma(x, x, fma(y, y, z * z)) < sum * sum;
        active[count] = slot;
        count += touch;
        if (!touch && contacts_.touching(slot)) part<F>(slot, {x, y, z}, sum);
      }
    }
    return count;
  }

  /// Ends the contact of two spheres whose centres are now `d` apart.
  template <Features F>
  void part(std::uint32_t slot, const Vec3& d, double radii) {
    const Pair& pair = contacts_.pair(slot);
    const SphereMotion &a = motions_[pair.i], &b = motions_[pair.j];
    const LawConstants<double> law(law_of(bodies_, settings_, pair));
    const double distance = d.norm(), radius = a.radius * b.radius / radii;
    const Vec3 n = d / distance;
    const Vec3 flow = contacts_.lattice_rate.cwiseProduct(contacts_.shift_of(slot));
    const double u_n = (vector(b.velocity_mid) - vector(a.velocity_mid) + flow).dot(n);
    const Parting end = parting<F>(law, contacts_.c_n[slot], radius, distance - radii, u_n, settings_.dt);
    PartialKick kick{pair, {}};
    Eigen::Map<Vec3>(kick.impulse.force) = end.normal * n;
    kicks_.push_back(kick);
    released_ += end.dissipated + stored_energy<F>(law, 0.0, radius, contacts_.memory(slot));
    contacts_.release(slot);
  }

  const Bodies& bodies_;
  const std::vector<SphereMotion>& motions_;
  const SweepSettings& settings_;
  ContactList& contacts_;
  std::size_t begin_, end_;
  std::vector<PartialKick>& kicks_;
  double released_ = 0.0;
};

Inertia inertia_of(const Bodies& bodies, std::size_t b) {
  return {1.0 / bodies.mass[b], inverse_inertia(bodies, b)};
}

}  // namespace

void set_damping(const Bodies& bodies, const SweepSettings& settings, ContactList& contacts,
                 std::size_t slot) {
  const Spheres& spheres = bodies.spheres;
  const Pair& pair = contacts.pair(slot);
  const PairLaw& law = law_of(bodies, settings, pair);
  EffectiveMass mu;
  if (settings.sphere_damping) {
    const double mi = spheres.mass[pair.i], mj = spheres.mass[pair.j];
    mu.normal = mi * mj / (mi + mj);
    mu.tangential = kTangentialRatio * mu.normal;
  } else {
    const std::uint32_t bi = spheres.body[pair.i], bj = spheres.body[pair.j];
    const Vec3 d = separation(spheres, contacts, slot);
    const double distance = d.norm();
    const Vec3 n = d / distance;
    const double ri = spheres.radius[pair.i], rj = spheres.radius[pair.j];
    const double lever = 0.5 * (distance + (ri - rj) * (ri + rj) / distance);
    const Vec3 arm_i = spheres.position[pair.i] - bodies.position[bi] + lever * n;
    const Vec3 arm_j = spheres.position[pair.j] - bodies.position[bj] - (distance - lever) * n;
    mu = effective_mass(inertia_of(bodies, bi), arm_i, inertia_of(bodies, bj), arm_j, n);
  }
  contacts.c_n[slot] = law.damping_n * std::sqrt(law.k_n * mu.normal);
  contacts.c_s[slot] = law.damping_s * std::sqrt(law.k_s * mu.tangential);
}

SweepReport sweep(const Bodies& bodies, const std::vector<SphereMotion>& motions,
                  const SweepSettings& settings, ContactList& contacts) {
  const std::size_t spheres = motions.size();
  std::vector<SweepReport> reports((spheres + kBlock - 1) / kBlock);
  contacts.kicks.resize(reports.size());
  with_features(settings.features, [&]<Features F>() {
    parallel_blocks(spheres, kBlock, [&](std::size_t begin, std::size_t end) {
      static thread_local std::vector<std::uint32_t> active;
      reports[begin / kBlock] = Block(bodies, motions, settings, contacts, begin, end).run<F>(active);
    });
  });
  SweepReport total;
  for (const SweepReport& r : reports) {
    total.dissipated += r.dissipated;
    total.overlap_ratio = std::max(total.overlap_ratio, r.overlap_ratio);
  }
  return total;
}

Pair deepest_pair(const Bodies& bodies, const ContactList& contacts) {
  const Spheres& spheres = bodies.spheres;
  Pair deepest{0, 0};
  double ratio = 0.0;
  for (std::size_t slot = 0; slot < contacts.slots(); ++slot) {
    const Pair& p = contacts.pair(slot);
    const double ri = spheres.radius[p.i], rj = spheres.radius[p.j];
    const double overlap = ri + rj - separation(spheres, contacts, slot).norm();
    if (overlap > ratio * std::min(ri, rj)) {
      ratio = overlap / std::min(ri, rj);
      deepest = p;
    }
  }
  return deepest;
}

void gather_wrenches(const ContactList& contacts, Bodies& bodies) {
  const Spheres& spheres = bodies.spheres;
  parallel_for(bodies.size(), [&](std::size_t b) {
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s) {
      Vec3 f = Vec3::Zero(), t = Vec3::Zero();
      for (std::uint32_t k = contacts.second_begin[s]; k < contacts.second_begin[s + 1]; ++k) {
        const ContactWrench& w = contacts.wrench[contacts.second[k]];
        f -= vector(w.force);
        t += vector(w.torque_j);
      }
      for (std::uint32_t slot = contacts.begin(s); slot < contacts.begin(s + 1); ++slot) {
        const ContactWrench& w = contacts.wrench[slot];
        f += vector(w.force);
        t += vector(w.torque_i);
      }
      force += f;
      torque += t + (spheres.position[s] - bodies.position[b]).cross(f);
    }
    bodies.force[b] += force;
    bodies.torque[b] += torque;
  });
}

void apply_partial_kicks(const ContactList& contacts, Bodies& bodies) {
  const Spheres& spheres = bodies.spheres;
  const auto give = [&](std::uint32_t s, const Vec3& impulse, const Vec3& moment) {
    const std::uint32_t b = spheres.body[s];
    bodies.velocity[b] += impulse / bodies.mass[b];
    bodies.spin[b] += moment + (spheres.position[s] - bodies.position[b]).cross(impulse);
  };
  for (const std::vector<PartialKick>& block : contacts.kicks)
    for (const PartialKick& kick : block) {
      const Vec3 impulse = vector(kick.impulse.force);
      give(kick.pair.i, impulse, vector(kick.impulse.torque_i));
      give(kick.pair.j, -impulse, vector(kick.impulse.torque_j));
    }
}

double stored_energy(const Bodies& bodies, const SweepSettings& settings, const ContactList& contacts) {
  const Spheres& spheres = bodies.spheres;
  return with_features(settings.features, [&]<Features F>() {
    return parallel_sum(spheres.size(), 0.0, [&](std::size_t s) {
      double energy = 0.0;
      for (std::uint32_t slot = contacts.begin(s); slot < contacts.begin(s + 1); ++slot) {
        if (!contacts.touching(slot)) continue;
        const Pair& p = contacts.pair(slot);
        const double ri = spheres.radius[p.i], rj = spheres.radius[p.j];
        const double overlap = ri + rj - separation(spheres, contacts, slot).norm();
        energy += stored_energy<F>(LawConstants<double>(law_of(bodies, settings, p)), overlap,
                                   ri * rj / (ri + rj), contacts.memory(slot));
      }
      return energy;
    });
  });
}

}  // namespace cairn
