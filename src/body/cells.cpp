#include "body/cells.h"

#include <algorithm>
#include <cmath>

namespace cairn {

namespace {

constexpr double kFrameSpeed = 64.0;  // m/s

/// Empty again when all bodies are in cell 0.
void drop_useless_cells(Bodies& bodies) {
  for (const Vec3& cell : bodies.cell)
    if (cell != Vec3::Zero()) return;
  bodies.cell.clear();
}

/// Component-wise: bodies far from the many do not matter.
template <class VectorOf>
Vec3 median(std::size_t count, VectorOf&& vector_of) {
  Vec3 out;
  std::vector<double> values(count);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t b = 0; b < count; ++b) values[b] = vector_of(b)[axis];
    std::nth_element(values.begin(), middle, values.end());
    out[axis] = *middle;
  }
  return out;
}

}  // namespace

double cell_edge(double smallest_radius) {
  return std::ldexp(1.0, std::ilogb(smallest_radius) + 13);
}

void settle_cells(Bodies& bodies) {
  const double edge = bodies.cell_edge;
  if (edge == 0.0) return;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Vec3& x = bodies.position[b];
    if (!(x.cwiseAbs().maxCoeff() > kCellReach * edge)) continue;
    const Vec3 steps = nearest_multiples(x, edge);
    x -= edge * steps;
    if (bodies.cell.empty()) bodies.cell.assign(bodies.size(), Vec3::Zero());
    bodies.cell[b] += steps;
  }
}

void set_cell_edge(Bodies& bodies, double edge) {
  for (std::size_t b = 0; b < bodies.cell.size(); ++b) {
    const Vec3 corner = bodies.cell_edge * bodies.cell[b];
    const Vec3 cell = nearest_multiples(corner, edge);
    bodies.position[b] += corner - edge * cell;
    bodies.cell[b] = cell;
  }
  bodies.cell_edge = edge;
  drop_useless_cells(bodies);
  settle_cells(bodies);
}

void displace(Bodies& bodies, const Vec3& by, const Vec3& velocity) {
  if (by == Vec3::Zero() && velocity == Vec3::Zero()) return;
  const double edge = bodies.cell_edge;
  const Vec3 cells = nearest_multiples(by, edge);
  if (cells != Vec3::Zero() && bodies.cell.empty()) bodies.cell.assign(bodies.size(), Vec3::Zero());
  for (Vec3& cell : bodies.cell) cell += cells;
  for (Vec3& x : bodies.position) x += by - edge * cells;
  for (Vec3& v : bodies.velocity) v += velocity;
  drop_useless_cells(bodies);
  settle_cells(bodies);
}

Frame take_frame(Bodies& bodies) {
  if (bodies.size() == 0) return {};
  Frame frame;
  if (bodies.cell_edge > 0.0) {
    const double step = kFrameStep * bodies.cell_edge;
    const Vec3 offset =
        bodies.position[0] + median(bodies.size(), [&](std::size_t b) { return separation(bodies, 0, b); });
    frame.position = step * nearest_multiples(offset, step);
    if (!bodies.cell.empty()) frame.position += bodies.cell_edge * bodies.cell[0];
  }
  const Vec3 speed = median(bodies.size(), [&](std::size_t b) { return bodies.velocity[b]; });
  frame.velocity = kFrameSpeed * nearest_multiples(speed, kFrameSpeed);
  displace(bodies, -frame.position, -frame.velocity);
  return frame;
}

}  // namespace cairn
