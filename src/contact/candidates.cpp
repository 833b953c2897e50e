#include "contact/candidates.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/elementary.h"
#include "core/memory.h"
#include "core/parallel.h"

namespace cairn {

namespace {

constexpr std::uint64_t kLongLife = 1000;  // steps
constexpr std::uint64_t kGoodLife = 240, kShortLife = 30;
constexpr double kLeastSkin = 0.02;       // smallest radii
constexpr double kFew = 0.03;             // so many of all spheres may have skins of their own
constexpr double kRounding = 1.0 - 1e-6;  // less than 1 by more than single precision errs
constexpr float kNotZero = std::numeric_limits<float>::min();  // more than no margin at all

/// The shortest edge of a periodic box (m); infinite in an open one.
double narrowest(const Box& box) {
  return (box.edge.array() > 0.0).select(box.edge, std::numeric_limits<double>::infinity()).minCoeff();
}

/// The shift of every slot: from the cells of its bodies, or to the nearest image.
void find_shifts(const Bodies& bodies, const Box& box, ContactList& contacts) {
  const std::vector<Vec3>& x = bodies.spheres.position;
  const std::vector<std::uint32_t>& body = bodies.spheres.body;
  set_lattice(bodies, box, contacts);
  contacts.set_shifts(box.periodic() || !bodies.cell.empty(), [&](const Pair& p) -> Vec3 {
    return box.periodic() ? box.nearest_image(x[p.j] - x[p.i])
                          : bodies.cell[body[p.j]] - bodies.cell[body[p.i]];
  });
}

}  // namespace

void set_lattice(const Bodies& bodies, const Box& box, ContactList& contacts) {
  contacts.lattice = box.periodic() ? box.edge : Vec3::Constant(bodies.cell_edge);
  contacts.lattice_rate = box.rate;
}

bool Candidates::expired(const Bodies& bodies, double time, ContactList& contacts, const Box& box) const {
  const Spheres& spheres = bodies.spheres;
  if (reference_.size() != spheres.size() || bodies.cell != cells_) return true;
  const double elapsed = time - motion_.time;
  const Vec3 center = motion_.center + elapsed * motion_.velocity;
  const double angle = motion_.spin.norm() * elapsed;
  Mat3 turn = angle == 0.0 ? Mat3::Identity() : rotation(angle, motion_.spin.normalized()).toRotationMatrix();
  double least = 1.0;
  if (box.periodic()) {
    const Vec3 stretch = (box.edge.array() > 0.0).select(box.edge.cwiseQuotient(edge_), 1.0);
    turn = stretch.asDiagonal();
    // Centres that were further apart than the radii and the skin have come nearer by this factor at most.
    least = stretch.minCoeff();
  }
  const auto square_of_limit = [&](double half_skin) {
    const double limit = std::max(least * half_skin - (1.0 - least) * largest_, 0.0);
    return static_cast<float>(kRounding * limit * limit);
  };
  const float limit2 = square_of_limit(0.5 * skin_);
  const bool one_cell = bodies.cell.empty();
  std::atomic<bool> moved = false;
  parallel_blocks(spheres.size(), 2048, [&](std::size_t begin, std::size_t end) {
    bool far = false;
    const auto look = [&](const Vec3& x, std::size_t s) {
      const double moved2 = (x - center - turn * reference_[s]).squaredNorm();
      contacts.moved[s] = static_cast<float>(moved2) + kNotZero;
      far |= !(contacts.moved[s] < limit2);  // so that NaN counts as far
    };
    if (one_cell)
      for (std::size_t s = begin; s < end; ++s) look(spheres.position[s], s);
    else
      for (std::size_t s = begin; s < end; ++s) look(sphere_place(bodies, s), s);
    if (far && !own_.empty()) {
      far = false;
      for (std::size_t s = begin; s < end; ++s) far |= !(contacts.moved[s] < square_of_limit(own_[s]));
    }
    if (far) moved.store(true, std::memory_order_relaxed);
  });
  // Distances in a strained box change though no sphere moves.
  if (box.edge != edge_)
    std::fill(contacts.moved.begin(), contacts.moved.end(), std::numeric_limits<float>::infinity());
  return moved;
}

void Candidates::rebuild(const Bodies& bodies, const RigidMotion& motion, const Features& features,
                         ContactList& contacts, const Box& box) {
  const Spheres& spheres = bodies.spheres;
  if (skin_ == 0.0) {
    const auto [smallest, largest] = std::minmax_element(spheres.radius.begin(), spheres.radius.end());
    smallest_ = *smallest;
    largest_ = *largest;
    skin_ = 0.1 * smallest_;
  }
  if (own_.empty()) {
    search_.find(bodies, box, skin_, pairs_);
  } else {
    const double most = 0.24 * narrowest(box) - largest_;
    for (double& half_skin : own_) half_skin = std::max(std::min(half_skin, most), 0.5 * skin_);
    std::vector<double> reach(own_);
    for (std::size_t s = 0; s < reach.size(); ++s) reach[s] += spheres.radius[s];
    search_.find(bodies, box, reach, pairs_);
  }
  // Pairs that touched and have flown apart since stay until the sweep has ended their contacts.
  const std::size_t near = pairs_.size();
  for (std::size_t slot = 0; slot < contacts.slots(); ++slot)
    if (contacts.touching(slot)) pairs_.push_back(contacts.pair(slot));
  std::inplace_merge(pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(near), pairs_.end());
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  const bool many = spheres.size() > kManySpheres;
  if (many) search_ = NearPairs();
  contacts.rebuild(pairs_, bodies, features);
  if (many) give_back(pairs_);
  find_shifts(bodies, box, contacts);
  contacts.set_margins(spheres);
  std::fill(contacts.moved.begin(), contacts.moved.end(), kNotZero);
  motion_ = motion;
  cells_ = bodies.cell;
  edge_ = box.edge;
  reference_.resize(spheres.size());
  parallel_for(spheres.size(),
               [&](std::size_t s) { reference_[s] = sphere_place(bodies, s) - motion.center; });
}

bool Candidates::too_wide(std::uint64_t age) const {
  return age > kLongLife && skin_ > kLeastSkin * smallest_;
}

void Candidates::adapt_skin(std::uint64_t age, const ContactList& contacts) {
  const bool few = widen_few(age, contacts.moved);
  if (age < kShortLife && !few) skin_ = std::min(1.5 * skin_, smallest_);
  if (age > kLongLife) skin_ = std::max(0.7 * skin_, kLeastSkin * smallest_);
}

bool Candidates::widen_few(std::uint64_t age, const std::vector<float>& moved) {
  own_.clear();
  const double n = static_cast<double>(moved.size());
  for (std::uint64_t life = kGoodLife; life >= kShortLife; life /= 2) {
    const double longer = static_cast<double>(life) / static_cast<double>(age);
    const auto limit2 = static_cast<float>(squared(0.5 * skin_ / longer));
    const auto fast = [&](float moved2) { return moved2 > limit2; };
    const auto count = static_cast<double>(std::count_if(moved.begin(), moved.end(), fast));
    if (count == 0.0) return false;
    if (count > kFew * n) continue;
    const double most = smallest_ * cube_root(n / count);  // together near as many spheres as there are
    own_.assign(moved.size(), 0.5 * skin_);
    for (std::size_t s = 0; s < moved.size(); ++s)
      if (fast(moved[s])) own_[s] = std::clamp(2.0 * longer * std::sqrt(double{moved[s]}), own_[s], most);
    return true;
  }
  return false;
}

}  // namespace cairn
