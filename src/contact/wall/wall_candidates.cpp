#include "contact/wall/wall_candidates.h"

#include <algorithm>
#include <limits>

namespace cairn {

namespace {

constexpr double kSkin = 0.1;  // of the sphere's radius

}  // namespace

void WallCandidates::resize(const Bodies& bodies) {
  const std::size_t blocks = (bodies.size() + kBlock - 1) / kBlock;
  if (reference_.size() == bodies.spheres.size() && blocks_.size() == blocks) return;
  blocks_.assign(blocks, {});
  reference_.resize(bodies.spheres.size());
  reach_.resize(bodies.spheres.size());
}

const std::vector<WallCandidates::Entry>& WallCandidates::list(std::size_t index, const Bodies& bodies,
                                                               const std::vector<Wall>& walls,
                                                               const std::vector<WallPose>& poses,
                                                               const WallFilter& filter) {
  Block& block = blocks_[index];
  const std::size_t begin = bodies.first_sphere[index * kBlock];
  const std::size_t end = bodies.first_sphere[std::min((index + 1) * kBlock, bodies.size())];
  if (expired(block, begin, end, bodies, walls, poses))
    renew(block, begin, end, bodies, walls, poses, filter);
  return block.entries;
}

std::size_t WallCandidates::renewals() const {
  std::size_t sum = 0;
  for (const Block& block : blocks_) sum += block.renewals;
  return sum;
}

bool WallCandidates::expired(const Block& block, std::size_t begin, std::size_t end, const Bodies& bodies,
                             const std::vector<Wall>& walls, const std::vector<WallPose>& poses) const {
  if (block.poses.size() != walls.size()) return true;
  const std::vector<Vec3>& x = bodies.spheres.position;
  bool far = false;
  for (std::size_t s = begin; s < end; ++s)  // written so that NaN counts as far
    far |= !((x[s] - reference_[s]).squaredNorm() < reach_[s] * reach_[s]);
  for (std::size_t w = 0; w < walls.size() && !far; ++w) {
    if (!walls[w].mesh() || !walls[w].moves()) continue;
    for (std::size_t s = begin; s < end; ++s)
      far |= !((poses[w].to_wall(x[s]) - block.poses[w].to_wall(reference_[s])).squaredNorm() <
               reach_[s] * reach_[s]);
  }
  return far;
}

void WallCandidates::renew(Block& block, std::size_t begin, std::size_t end, const Bodies& bodies,
                           const std::vector<Wall>& walls, const std::vector<WallPose>& poses,
                           const WallFilter& filter) {
  static thread_local std::vector<std::uint32_t> triangles;
  block.entries.clear();
  block.poses = poses;
  ++block.renewals;
  for (auto s = static_cast<std::uint32_t>(begin); s < end; ++s) {
    const double radius = bodies.spheres.radius[s], skin = kSkin * radius;
    double clear = std::numeric_limits<double>::max();
    for (std::uint32_t w = 0; w < walls.size(); ++w) {
      const MeshSurface* mesh = walls[w].mesh();
      if ((!mesh && walls[w].moves()) || !filter.touches(w, bodies.spheres.body[s])) continue;
      const Vec3 y = poses[w].to_wall(bodies.spheres.position[s]);
      const double gap = (mesh ? mesh->tree().distance(y) : walls[w].nearest(y).arm) - radius;
      clear = std::min(clear, gap);
      if (gap >= skin) continue;
      if (!mesh) {
        block.entries.push_back({s, w, 0});
        continue;
      }
      triangles.clear();
      mesh->tree().find(y, radius + skin, triangles);
      for (const std::uint32_t t : triangles) block.entries.push_back({s, w, t});
    }
    reference_[s] = bodies.spheres.position[s];
    reach_[s] = std::max(skin, clear);
  }
}

}  // namespace cairn
