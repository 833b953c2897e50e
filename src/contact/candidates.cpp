#include "contact/candidates.h"

#include <algorithm>
#include <atomic>

#include "core/parallel.h"

namespace cairn {

bool Candidates::expired(const Bodies& bodies, double time) const {
  const Spheres& spheres = bodies.spheres;
  if (reference_.size() != spheres.size()) return true;
  const double elapsed = time - motion_.time;
  const Vec3 center = motion_.center + elapsed * motion_.velocity;
  const double angle = motion_.spin.norm() * elapsed;
  const Mat3 turn = angle == 0.0 ? Mat3::Identity()
                                 : Eigen::AngleAxisd(angle, motion_.spin.normalized()).toRotationMatrix();
  const double limit2 = 0.25 * skin_ * skin_;
  std::atomic<bool> moved = false;
  parallel_blocks(spheres.size(), 2048, [&](std::size_t begin, std::size_t end) {
    bool far = false;
    for (std::size_t s = begin; s < end; ++s)  // written so that NaN counts as far
      far |= !((spheres.position[s] - center - turn * reference_[s]).squaredNorm() < limit2);
    if (far) moved.store(true, std::memory_order_relaxed);
  });
  return moved;
}

void Candidates::rebuild(const Bodies& bodies, const RigidMotion& motion, const Features& features,
                         ContactList& contacts) {
  const Spheres& spheres = bodies.spheres;
  if (skin_ == 0.0) {
    smallest_ = *std::min_element(spheres.radius.begin(), spheres.radius.end());
    skin_ = 0.1 * smallest_;
  }
  search_.find(spheres.position, spheres.radius, spheres.body, skin_, pairs_);
  // Pairs that touched and have flown apart since stay until the sweep has ended their contacts.
  const std::size_t near = pairs_.size();
  for (std::size_t slot = 0; slot < contacts.slots(); ++slot)
    if (contacts.touching(slot)) pairs_.push_back(contacts.pair(slot));
  const auto before = [](const Pair& a, const Pair& b) { return a.i != b.i ? a.i < b.i : a.j < b.j; };
  std::inplace_merge(pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(near), pairs_.end(),
                     before);
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  contacts.rebuild(pairs_, spheres.size(), features);
  motion_ = motion;
  reference_.resize(spheres.size());
  parallel_for(spheres.size(), [&](std::size_t s) { reference_[s] = spheres.position[s] - motion.center; });
}

void Candidates::adapt_skin(std::uint64_t age) {
  if (age < 30) skin_ = std::min(1.5 * skin_, smallest_);
  if (age > 1000) skin_ = std::max(0.7 * skin_, 0.02 * smallest_);
}

}  // namespace cairn
