// The contact list: candidate pairs in order of their sphere ids, with what each touching pair remembers.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "body/bodies.h"
#include "contact/law/features.h"
#include "contact/law/memory.h"
#include "contact/search.h"
#include "core/math.h"

namespace cairn {

/// One touching pair as a checkpoint stores it.
struct ContactRecord {
  std::uint32_t i, j;
  ContactMemory<double> memory;
};

/// Force and torques of one contact; torques about the sphere centres, rolling and twisting included.
struct ContactWrench {
  double force[3];     ///< N, on i; j gets the opposite
  double torque_i[3];  ///< N m
  double torque_j[3];  ///< N m
};

/// What some contacts together exert on a sphere, in one cache line: force (N) and torque about the sphere's
/// centre (N m), three numbers each and one that is not used.
struct alignas(64) WrenchShare {
  double v[8] = {};
};

/// The spring and dashpot of one contact against sliding.
struct alignas(32) SlideSpring {
  double length[3] = {};  ///< m
  double c_s = 0.0;       ///< kg/s
};

/// The springs of one contact against rolling and twisting.
struct alignas(32) TurnSpring {
  double roll[3] = {};  ///< rad
  double twist = 0.0;   ///< rad
};

/// What a contact that began or ended within the step gives beyond the half kicks: its wrench times a time.
struct PartialKick {
  Pair pair;
  ContactWrench impulse;  ///< N s, N m s
};

/// Bodies that a sweep works on together, and where what belongs to them begins; it ends where that of the
/// next block begins.
struct ContactBlock {
  std::uint32_t body, sphere;
  std::uint32_t slot;    ///< the pairs whose i is in the block
  std::uint32_t share;   ///< in `shares`: of spheres of later blocks
  std::uint32_t source;  ///< in `sources`: earlier blocks that have shares for spheres of this one
  bool balls;            ///< no sphere has an arm
};

/// Candidate pairs ("slots") sorted by (i, j), their histories and wrenches.
class ContactList {
 public:
  /// Replaces the candidates; histories of touching pairs are carried over. Every touching pair must be among
  /// the new candidates. `features` says which springs exist.
  void rebuild(std::vector<Pair>& pairs, const Bodies& bodies, const Features& features);

  std::size_t slots() const { return pairs_.size(); }
  const Pair& pair(std::size_t slot) const { return pairs_[slot]; }
  bool touching(std::size_t slot) const { return c_n[slot] >= 0.0; }
  /// Finds out how far the spheres of each pair that does not touch must move to do so.
  void set_margins(const Spheres& spheres);
  /// How many pairs touch.
  std::size_t contacts() const;

  ContactMemory<double> memory(std::size_t slot) const;
  ContactRecord record(std::size_t slot) const { return {pairs_[slot].i, pairs_[slot].j, memory(slot)}; }
  void set_memory(std::size_t slot, const ContactMemory<double>& memory);
  /// Forgets a contact that has ended.
  void release(std::size_t slot);

  /// The touching pairs in order.
  std::vector<ContactRecord> records() const;
  /// Makes exactly these pairs touching (sorted; all must be candidates).
  void restore(const std::vector<ContactRecord>& records);

  /// Asks for every pair's shift in whole lattice edges; none is stored when all are zero or `any` is false.
  void set_shifts(bool any, const std::function<Vec3(const Pair&)>& shift_of);
  bool shifted() const { return !shift.empty(); }
  /// What is to be added to the place of j to bring it where i sees it (m).
  Vec3 shift_of(std::size_t slot) const {
    if (!shifted()) return Vec3::Zero();
    return lattice.cwiseProduct(Vec3(shift[slot][0], shift[slot][1], shift[slot][2]));
  }
  /// Vector from sphere i to j of a slot (m).
  Vec3 separation(const Spheres& spheres, std::size_t slot) const {
    return spheres.position[pairs_[slot].j] - spheres.position[pairs_[slot].i] + shift_of(slot);
  }

  /// Spheres of a block, nearly: independent of threads and of the candidates. Where both spheres of a pair
  /// are in one block, their wrenches are summed there. Large blocks, because what leaves them goes through
  /// memory; small ones, so that there is work for all threads.
  static std::size_t block_size(std::size_t spheres);
  /// The blocks, and one that only says where they end.
  std::vector<ContactBlock> blocks{1};
  std::size_t block_count() const { return blocks.size() - 1; }
  std::vector<std::uint32_t> sources;  ///< of blocks
  /// Shares of sphere s from earlier blocks: shares[earlier[k]] from k = earlier_begin[s] on, in order.
  std::vector<std::uint32_t> earlier_begin, earlier;

  /// kg/s; negative: the pair does not touch, and cannot while the sum of `moved` over both spheres is less
  /// than -c_n (m^2).
  std::vector<double> c_n;
  std::vector<float> moved;         ///< m^2, square of each sphere's displacement since the list was made
  std::vector<SlideSpring> slide;   ///< empty when there is no tangential force
  std::vector<TurnSpring> turn;     ///< empty when nothing resists rolling and twisting
  std::vector<WrenchShare> shares;  ///< by block: of the spheres that its pairs reach in later ones
  /// Where the wrench on j of a slot is added: the spheres of the block come first, then those in `shares`.
  std::vector<std::uint32_t> share_of_j;
  std::vector<std::uint8_t> swept;  ///< whether the block's pairs are evaluated
  /// Sums over a block's own pairs that wait for those of other threads; empty: none.
  std::vector<std::vector<WrenchShare>> waiting;
  std::vector<ContactWrench> wrench;            ///< of each slot in the last sweep, while `keep_wrenches`
  bool keep_wrenches = false;                   ///< for those who look into the pile; the motion needs none
  std::vector<std::array<double, 3>> shift;     ///< whole edges of the lattice; empty: none is shifted
  std::vector<std::uint8_t> is_shifted;         ///< whether a slot's shift is not zero; empty as `shift`
  Vec3 lattice = Vec3::Zero();                  ///< m, edges of the cells, or of the periodic box as it is
  Vec3 lattice_rate = Vec3::Zero();             ///< 1/s, their growth: images move with it
  std::vector<std::vector<PartialKick>> kicks;  ///< of the last sweep, by block

 private:
  void set_blocks(const Bodies& bodies);
  void set_shares();
  /// The slot of a pair, looked for from `slot` on. @throws InputError when it is not there.
  std::size_t find_from(std::size_t slot, const Pair& pair) const;

  std::vector<Pair> pairs_;
  Features features_;
};

}  // namespace cairn
