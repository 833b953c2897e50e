// Places in two parts: a whole cell of a cubic lattice and an offset from the cell's centre. The lattice's
// edge is a power of two, so that cells are added and taken off without rounding; two bodies are told apart
// to the resolution of their offsets, however far from the scene's zero they are.
#pragma once

#include "body/bodies.h"

namespace cairn {

/// Edge (m) of cells for spheres down to `smallest_radius` (m): 2^12 radii, rounded up to a power of two, so
/// that a pile has room in one cell and a step rounds offsets by less than 1e-12 of that radius.
double cell_edge(double smallest_radius);

/// The whole multiples of `unit` nearest to each component; none of unit 0.
inline Vec3 nearest_multiples(const Vec3& x, double unit) {
  if (unit == 0.0) return Vec3::Zero();
  return (x / unit).array().round();
}

/// Where body b is, from `origin` in the scene's frame (m); what both have in common is not rounded.
inline Vec3 place(const Bodies& bodies, std::size_t b, const Vec3& origin = Vec3::Zero()) {
  if (bodies.cell.empty()) return bodies.position[b] - origin;
  return bodies.position[b] + (bodies.cell_edge * bodies.cell[b] - origin);
}

/// Vector from body a to body b (m).
inline Vec3 separation(const Bodies& bodies, std::size_t a, std::size_t b) {
  const Vec3 d = bodies.position[b] - bodies.position[a];
  if (bodies.cell.empty()) return d;
  return d + bodies.cell_edge * (bodies.cell[b] - bodies.cell[a]);
}

/// A coordinate further than this part of the edge from the cell's centre takes its body to another cell. The
/// rest is hysteresis: a body that jostles on a border stays where it is.
inline constexpr double kCellReach = 0.75;

/// Gives bodies that have left their cells new ones.
void settle_cells(Bodies& bodies);

/// Changes the lattice; 0: none, places become plain coordinates.
void set_cell_edge(Bodies& bodies, double edge);

/// Moves all bodies by `by` (m), and their velocities by `velocity` (m/s).
void displace(Bodies& bodies, const Vec3& by, const Vec3& velocity);

/// An inertial frame: where its zero is at the start (m) and how it moves (m/s).
struct Frame {
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
};

/// Places far apart are told in steps of this part of a cell: coarse enough that bodies near the zero see
/// none.
inline constexpr double kFrameStep = 0.25;

/// Makes the bodies' own frame, in which most of them are near the zero and slow: takes the whole quarters of
/// a cell and the whole multiples of 64 m/s nearest to their median place and velocity off all of them, and
/// returns them. Rounds nothing of bodies near the median. Zero for bodies near the zero and slow already.
Frame take_frame(Bodies& bodies);

}  // namespace cairn
