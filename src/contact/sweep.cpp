#include "contact/sweep.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/sweep.cpp"
#include <hwy/foreach_target.h>

#include <array>
#include <atomic>

#include "contact/batch-inl.h"
#include "contact/dashpots.h"
#include "contact/law/partial-inl.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "core/vector.h"

HWY_BEFORE_NAMESPACE();
namespace cairn {
namespace HWY_NAMESPACE {
namespace {

LawConstants<Batch> gather_laws(const Bodies& bodies, const SweepSettings& settings,
                                const ContactList& contacts, const Slots& slot) {
  const PairLaw* law[kLanes];
  for (std::size_t l = 0; l < kLanes; ++l) law[l] = &settings.law(bodies, contacts.pair(slot[l]));
  const auto column = [&](double PairLaw::*member) HWY_ATTR {
    Lanes out;
    for (std::size_t l = 0; l < kLanes; ++l) out[l] = law[l]->*member;
    return out.batch();
  };
  LawConstants<Batch> out;
  out.k_n = column(&PairLaw::k_n);
  out.k_s = column(&PairLaw::k_s);
  out.friction = column(&PairLaw::friction);
  out.rolling = column(&PairLaw::rolling);
  out.twisting = column(&PairLaw::twisting);
  out.beta = column(&PairLaw::beta);
  out.cohesion = column(&PairLaw::cohesion);
  return out;
}

CAIRN_INLINE WrenchBatch wrench_of(const ContactAction<Batch>& action, const Triple<Batch>& n, Batch arm_i,
                                   Batch arm_j) {
  const Triple<Batch> moment = cross(n, action.force);
  return {action.force, fma(arm_i, moment, action.couple), fma(-arm_j, moment, action.couple)};
}

/// Takes j where i sees it: in another cell, or as an image that moves with the box.
CAIRN_INLINE void see_shifted(const ContactList& contacts, const Slots& slot, Triple<Batch>& d,
                              Triple<Batch>& u, Triple<Batch>& u_mid) {
  Lanes x, y, z;
  for (std::size_t l = 0; l < kLanes; ++l) {
    const std::array<double, 3>& s = contacts.shift[slot[l]];
    x[l] = s[0];
    y[l] = s[1];
    z[l] = s[2];
  }
  const Triple<Batch> steps{x.batch(), y.batch(), z.batch()};
  const Vec3 &edge = contacts.lattice, &rate = contacts.lattice_rate;
  d = {fma(edge[0], steps.x, d.x), fma(edge[1], steps.y, d.y), fma(edge[2], steps.z, d.z)};
  const Triple<Batch> flow{edge[0] * rate[0] * steps.x, edge[1] * rate[1] * steps.y,
                           edge[2] * rate[2] * steps.z};
  u = u + flow;
  u_mid = u_mid + flow;
}

/// Room for the work on one block.
struct Room {
  std::vector<std::uint32_t> active, fresh;  ///< slots
  std::vector<WrenchShare> shares;           ///< of the block's spheres, then of those in later blocks
};

/// The pairs of one block.
template <Features F>
class Block {
 public:
  Block(const Bodies& bodies, const std::vector<SphereMotion>& motions, const SweepSettings& settings,
        ContactList& contacts, std::size_t k, Room& room)
      : bodies_(bodies),
        motions_(motions),
        settings_(settings),
        contacts_(contacts),
        block_(contacts.blocks[k]),
        next_(contacts.blocks[k + 1]),
        single_(settings.laws[0]),
        room_(room),
        kicks_(contacts.kicks[k]) {
    const std::size_t own = next_.sphere - block_.sphere;
    kicks_.clear();
    if (kicks_.capacity() > own / 8) give_back(kicks_);  // rare, as in the first step of a pile
    room_.shares.assign(own + next_.share - block_.share, WrenchShare{});
  }

  SweepReport run() {
    std::vector<std::uint32_t>& active = room_.active;
    const std::size_t count = contacts_.shifted() ? find_pairs<true>() : find_pairs<false>();
    Slots slot;
    std::size_t k = 0;
    for (; k + kLanes <= count; k += kLanes) {
      for (std::size_t l = 0; l < kLanes; ++l) slot.index[l] = active[k + l];
      slot.consecutive = slot[kLanes - 1] - slot[0] == kLanes - 1;
      if (k + (kAhead + 1) * kLanes <= count)
        for (std::size_t l = 0; l < kLanes; ++l) fetch_partner(active[k + kAhead * kLanes + l]);
      for (std::size_t l = 0; l < kLanes; l += 2) fetch_springs(slot[l]);  // two in a line
      part_ = k / kLanes % kParts;
      evaluate_batch<false>(slot, kLanes);
    }
    if (k < count) {  // spare lanes repeat the last contact: same values, same slot
      for (std::size_t l = 0; l < kLanes; ++l) slot.index[l] = active[std::min(k + l, count - 1)];
      slot.consecutive = false;
      part_ = k / kLanes % kParts;
      evaluate_batch<true>(slot, count - k);
    }
    std::copy(room_.shares.end() - (next_.share - block_.share), room_.shares.end(),
              contacts_.shares.begin() + block_.share);
    SweepReport out{.dissipated = released_};
    for (std::size_t part = 0; part < kParts; ++part) {
      const Lanes dissipated(dissipated_[part]), ratio(overlap_ratio_[part]);
      for (std::size_t l = 0; l < kLanes; ++l) {
        out.dissipated += dissipated[l];
        out.overlap_ratio = std::max(out.overlap_ratio, ratio[l]);
      }
    }
    return out;
  }

 private:
  /// Writes the slots of pairs that touch or did so a step ago to `active`, in order.
  template <bool shifted>
  std::size_t find_pairs() const {
    std::vector<std::uint32_t>&active = room_.active, &fresh = room_.fresh;
    const std::uint32_t last = next_.slot;
    active.resize(last - block_.slot + kLanes);
    fresh.resize(last - block_.slot + kLanes);
    std::size_t count = 0, apart = 0;
    std::uint32_t slot = block_.slot;
    for (; slot + kLanes <= last; slot += kLanes) {
      const Mask not_touching = Batch::load(&contacts_.c_n[slot]) < Batch(0.0);
      count += write_lanes(!not_touching, slot, &active[count]);
      apart += write_lanes(not_touching, slot, &fresh[apart]);
    }
    for (; slot < last; ++slot) {
      const bool touching = contacts_.touching(slot);
      active[count] = fresh[apart] = slot;
      count += touching;
      apart += !touching;
    }
    std::size_t near = 0;  // of those apart: may have come to touch
    for (std::size_t k = 0; k < apart; ++k) {
      slot = fresh[k];
      const Pair pair = contacts_.pair(slot);
      fresh[near] = slot;
      const bool close = !(contacts_.moved[pair.i] + contacts_.moved[pair.j] < -contacts_.c_n[slot]);
      near += close;
      if (close) {
        __builtin_prefetch(motions_[pair.i].position);
        __builtin_prefetch(motions_[pair.j].position);
      }
    }
    std::size_t begun = 0;
    for (std::size_t k = 0; k < near; ++k) {
      slot = fresh[k];
      const Pair pair = contacts_.pair(slot);
      const SphereMotion &a = motions_[pair.i], &b = motions_[pair.j];
      double x = b.position[0] - a.position[0], y = b.position[1] - a.position[1],
             z = b.position[2] - a.position[2];
      if constexpr (shifted) {
        const std::array<double, 3>& steps = contacts_.shift[slot];
        x = fma(contacts_.lattice[0], steps[0], x);
        y = fma(contacts_.lattice[1], steps[1], y);
        z = fma(contacts_.lattice[2], steps[2], z);
      }
      const double sum = a.radius + b.radius;
      fresh[begun] = slot;
      begun += fma(x, x, fma(y, y, z * z)) < sum * sum;
    }
    // Merges from behind.
    const std::size_t total = count + begun;
    for (std::size_t at = total; begun > 0; --at) {
      const bool old = count > 0 && active[count - 1] > fresh[begun - 1];
      active[at - 1] = old ? active[--count] : fresh[--begun];
    }
    return total;
  }

  static constexpr std::size_t kAhead = 3;             // batches; enough for a cache that is not the nearest
  static constexpr std::uint32_t kSpringsAhead = 128;  // slots

  /// The partner's motion is somewhere else in memory.
  void fetch_partner(std::uint32_t slot) const {
    const SphereMotion& j = motions_[contacts_.pair(slot).j];
    __builtin_prefetch(j.position);
    __builtin_prefetch(j.position + 8);
  }

  /// Springs follow each other, but in too many columns for the hardware to foresee all.
  void fetch_springs(std::uint32_t slot) const {
    const std::size_t ahead = std::min<std::size_t>(slot + kSpringsAhead, contacts_.slots() - 1);
    if constexpr (F.tangential) __builtin_prefetch(&contacts_.slide[ahead], 1, 2);
    if constexpr (F.rolling || F.twisting) __builtin_prefetch(&contacts_.turn[ahead], 1, 2);
  }

  /// kLanes pairs at once, of which the first `used` count. A batch in which no contact begins or ends needs
  /// no call, and so can keep its values in registers; any other one starts again with `changes`.
  template <bool changes>
  [[gnu::noinline]] void evaluate_batch(const Slots& slot, std::size_t used) {
    std::uint32_t index_i[kLanes], index_j[kLanes];
    for (std::size_t l = 0; l < kLanes; ++l) {
      index_i[l] = contacts_.pair(slot[l]).i;
      index_j[l] = contacts_.pair(slot[l]).j;
    }
    const MotionBatch a = load_motions(motions_, index_i), b = load_motions(motions_, index_j);
    const Batch half(0.5), dt(settings_.dt);

    Triple<Batch> d = b.position - a.position, u = b.velocity - a.velocity,
                  u_mid = b.velocity_mid - a.velocity_mid;
    if (any_shifted(slot)) see_shifted(contacts_, slot, d, u, u_mid);
    const Triple<Batch> d_mid = fma(Batch(-0.5) * dt, u_mid, d);
    const Batch sum = a.radius + b.radius;
    const Batch square = dot(d, d);
    const Mask parted = !(square < sum * sum);
    ContactMemory<Batch> memory;
    memory.c_n = gather(contacts_.c_n, slot);
    const Mask fresh = (memory.c_n < Batch(0.0)) & !parted;
    Lanes mass(0.0);  // effective, of those that begin
    unsigned parted_bits = 0, fresh_bits = 0;
    if constexpr (changes) {
      parted_bits = bits(parted);
      fresh_bits = bits(fresh);
      const Lanes x(d.x), y(d.y), z(d.z), radii(sum);
      for (std::size_t l = 0; l < used; ++l) {
        if (parted_bits >> l & 1u) part(slot[l], {x[l], y[l], z[l]}, radii[l]);
        if (fresh_bits >> l & 1u) mass[l] = set_damping(bodies_, settings_, contacts_, slot[l]);
      }
      memory.c_n = gather(contacts_.c_n, slot);
    } else if (any(parted | fresh)) {
      return evaluate_batch<true>(slot, used);
    }

    const Batch least(1e-300);  // for centres that coincide
    const Batch d2 = max(square, least), d2_mid = max(dot(d_mid, d_mid), least);
    const Batch inverse = rsqrt(d2), inverse_mid = rsqrt(d2_mid);
    const Batch rough = d2 * inverse, distance_mid = d2_mid * inverse_mid;
    const Batch distance = fma(fma(-rough, rough, d2), half * inverse, rough);  // overlaps need its last bit
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
    if constexpr (changes)
      motion.dt = select(fresh, age(geometry.overlap, dot(motion.u_mid, geometry.n_mid), dt), dt);
    load_springs<F>(contacts_, slot, memory);

    const LawConstants<Batch> law =
        settings_.materials == 1 ? single_ : gather_laws(bodies_, settings_, contacts_, slot);
    const ContactAction<Batch> action = evaluate<F>(law, geometry, motion, memory);
    store_springs<F>(contacts_, slot, memory);
    const WrenchBatch wrench = wrench_of(action, geometry.n, arm_i, arm_j);
    const Batch smaller = min(a.radius, b.radius);
    Batch& ratio = overlap_ratio_[part_];
    if (any(geometry.overlap > ratio * smaller)) ratio = max(ratio, geometry.overlap / smaller);
    add_wrenches(slot, index_i, wrench, parted_bits, used);
    if constexpr (!changes) {
      dissipated_[part_] += action.dissipated;
      return;
    }
    if (fresh_bits != 0) begin(slot, used, fresh, mass, law, geometry, motion, memory, action, arm_i, arm_j);
    Lanes lost(action.dissipated);
    for (std::size_t l = 0; l < kLanes; ++l) {
      const bool has_parted = parted_bits >> l & 1u;
      if (has_parted && l < used) contacts_.release(slot[l]);
      if (has_parted || l >= used) lost[l] = 0.0;
    }
    dissipated_[part_] += lost.batch();
  }

  /// Adds the wrenches of the first `used` contacts to their spheres' shares, without those that have parted.
  CAIRN_INLINE void add_wrenches(const Slots& slot, const std::uint32_t (&index_i)[kLanes],
                                 const WrenchBatch& w, unsigned parted, std::size_t used) {
    Octet on_i[kLanes], less_on_j[kLanes];
    to_rows(w.force, w.torque_i, on_i);
    to_rows(w.force, w.less_torque_j, less_on_j);
    double *of_i[kLanes], *of_j[kLanes];
    for (std::size_t l = 0; l < kLanes; ++l) {
      of_i[l] = room_.shares[index_i[l] - block_.sphere].v;
      of_j[l] = room_.shares[contacts_.share_of_j[slot[l]]].v;
    }
    for (std::size_t l = 0; l < used; ++l) {
      if (parted >> l & 1u) continue;
      (Octet::load(of_i[l]) + on_i[l]).store(of_i[l]);
      (Octet::load(of_j[l]) - less_on_j[l]).store(of_j[l]);
    }
    if (contacts_.keep_wrenches) keep(slot, w, parted, used);
  }

  [[gnu::noinline]] void keep(const Slots& slot, const WrenchBatch& w, unsigned parted, std::size_t used) {
    ContactWrench wrench[kLanes];
    w.write(wrench);
    for (std::size_t l = 0; l < used; ++l)
      if (!(parted >> l & 1u)) contacts_.wrench[slot[l]] = wrench[l];
  }

  bool any_shifted(const Slots& slot) const {
    if (!contacts_.shifted()) return false;
    std::uint8_t found = 0;
    for (std::size_t l = 0; l < kLanes; ++l) found |= contacts_.is_shifted[slot[l]];
    return found != 0;
  }

  /// What contacts that have begun within the step give beyond the closing half kick of `end`.
  [[gnu::noinline]] void begin(const Slots& slot, std::size_t used, Mask fresh, const Lanes& mass,
                               const LawConstants<Batch>& law, const ContactGeometry<Batch>& geometry,
                               const ContactMotion<Batch>& motion, const ContactMemory<Batch>& memory,
                               const ContactAction<Batch>& end, Batch arm_i, Batch arm_j) {
    const Batch dt(settings_.dt);
    const unsigned within = bits(fresh & (motion.dt < dt));
    const Lanes speed(-dot(motion.u, geometry.n)), force(dot(end.force, geometry.n)),
        pull(HWY_NAMESPACE::pull<F>(law, geometry.radius)), k_n(law.k_n), c_n(memory.c_n),
        overlap(geometry.overlap);
    Lanes normal(0.0);
    for (std::size_t l = 0; l < used; ++l)
      if (within >> l & 1u) {
        const PartialStep step{k_n[l], c_n[l], pull[l], mass[l], settings_.dt};
        normal[l] = first_impulse(step, overlap[l], speed[l], force[l]);
      }
    const ContactAction<Batch> due = first_touch<F>(law, geometry, motion, memory, end, normal.batch(), dt);
    ContactWrench impulse[kLanes];
    wrench_of(due, geometry.n, arm_i, arm_j).write(impulse);
    for (std::size_t l = 0; l < used; ++l)
      if (within >> l & 1u) kicks_.push_back({contacts_.pair(slot[l]), impulse[l]});
  }

  /// Ends the contact of two spheres whose centres are now `d` apart: what its springs hold is lost.
  [[gnu::noinline]] void part(std::uint32_t slot, const Vec3& d, double radii) {
    const Pair& pair = contacts_.pair(slot);
    const SphereMotion &a = motions_[pair.i], &b = motions_[pair.j];
    const Vec3 flow = contacts_.lattice_rate.cwiseProduct(contacts_.shift_of(slot));
    const Vec3 u_mid = vector(b.velocity_mid) - vector(a.velocity_mid) + flow,
               u_end = vector(b.velocity) - vector(a.velocity) + flow;
    const LawConstants<double> law(settings_.law(bodies_, pair));
    const ContactMemory<double> memory = contacts_.memory(slot);
    contacts_.release(slot);
    const Vec3 d_start = d - settings_.dt * u_mid, n_start = d_start.normalized(), n = d.normalized();
    const double distance = d.norm(), overlap = radii - d_start.norm(), gap = distance - radii;
    const double radius = a.radius * b.radius / radii;
    if (!(overlap > 0.0)) {  // no parting within the step
      released_ += stored_energy<F>(law, 0.0, radius, memory);
      return;
    }
    const double arm_i = 0.5 * (distance + (a.radius - b.radius) * radii / distance),
                 arm_j = distance - arm_i;

    ContactGeometry<double> start;
    start.n = start.n_mid = triple(n);
    start.overlap = overlap;
    start.radius = radius;
    start.slip_lever = 0.5 * (arm_j - arm_i) / (arm_i * arm_j);
    ContactMotion<double> motion;
    motion.u = motion.u_mid =
        triple(u_mid - (arm_i * vector(a.spin_mid) + arm_j * vector(b.spin_mid)).cross(n));
    motion.w = motion.w_mid = triple(vector(b.spin_mid) - vector(a.spin_mid));
    motion.turn = {};
    motion.dt = overlap / (overlap + gap) * settings_.dt;
    const double mass = effective_mass(bodies_, contacts_, slot).normal;
    const PartialStep step{law.k_n, memory.c_n, pull<F>(law, radius), mass, settings_.dt};
    const PartingSpeeds speeds{(2.0 * u_mid - u_end).dot(n_start), u_mid.dot(n_start), u_mid.dot(n)};
    const ContactAction<double> due = parting<F>(law, start, motion, speeds, step, memory);
    const Vec3 force = vector(due.force), couple = vector(due.couple), moment = n.cross(force);
    PartialKick kick{pair, {}};
    Eigen::Map<Vec3>(kick.impulse.force) = force;
    Eigen::Map<Vec3>(kick.impulse.torque_i) = arm_i * moment + couple;
    Eigen::Map<Vec3>(kick.impulse.torque_j) = arm_j * moment - couple;
    kicks_.push_back(kick);
    released_ += due.dissipated;
  }

  const Bodies& bodies_;
  const std::vector<SphereMotion>& motions_;
  const SweepSettings& settings_;
  ContactList& contacts_;
  const ContactBlock &block_, &next_;
  const LawConstants<Batch> single_;
  Room& room_;
  std::vector<PartialKick>& kicks_;
  static constexpr std::size_t kParts = 8 / kLanes;  // of eight logical lanes, whatever a register has
  Batch dissipated_[kParts] = {}, overlap_ratio_[kParts] = {};
  std::size_t part_ = 0;
  double released_ = 0.0;
};

}  // namespace

SweepReport sweep(const std::vector<SphereMotion>& motions, const SweepSettings& settings,
                  ContactList& contacts, Bodies& bodies, const BodyWork& work) {
  const std::size_t count = contacts.block_count();
  contacts.kicks.resize(count);
  if (contacts.keep_wrenches) contacts.wrench.assign(contacts.slots(), ContactWrench{});
  contacts.swept.assign(count, 0);
  contacts.waiting.resize(count);
  const auto is_swept = [&](std::uint32_t k) {
    return std::atomic_ref(contacts.swept[k]).load(std::memory_order_acquire) != 0;
  };
  SweepReport total;
  with_features(settings.features, [&]<Features F>() HWY_ATTR {
    total = parallel_block_sum(count, 1, SweepReport{}, [&](std::size_t k, std::size_t) HWY_ATTR {
      static thread_local Room room;
      const SweepReport report = Block<F>(bodies, motions, settings, contacts, k, room).run();
      std::atomic_ref(contacts.swept[k]).store(1, std::memory_order_release);
      const std::uint32_t* sources = contacts.sources.data();
      if (std::all_of(sources + contacts.blocks[k].source, sources + contacts.blocks[k + 1].source,
                      is_swept)) {
        contacts.waiting[k].clear();
        gather_block(contacts, k, room.shares, work, bodies);
      } else {  // on another thread
        room.shares.swap(contacts.waiting[k]);
      }
      return report;
    });
  });
  parallel_blocks(count, 1, [&](std::size_t k, std::size_t) {
    if (!contacts.waiting[k].empty()) gather_block(contacts, k, contacts.waiting[k], work, bodies);
  });
  return total;
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cairn {

HWY_EXPORT(sweep);

SweepReport sweep(const std::vector<SphereMotion>& motions, const SweepSettings& settings,
                  ContactList& contacts, Bodies& bodies, const BodyWork& work) {
  return HWY_DYNAMIC_DISPATCH(sweep)(motions, settings, contacts, bodies, work);
}

}  // namespace cairn
#endif
