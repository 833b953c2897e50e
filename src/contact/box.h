// A periodic box, and its prescribed strain.
#pragma once

#include <limits>

#include "body/bodies.h"

namespace cairn {

inline constexpr double kWidestBox = 1e12;  ///< m, of an edge

/// The box at one time. Bodies have images one edge apart; they are followed through the images, not wrapped.
struct Box {
  Vec3 edge = Vec3::Zero();  ///< m; 0: open in that direction
  Vec3 rate = Vec3::Zero();  ///< 1/s, d ln(edge) / dt

  bool periodic() const { return edge.maxCoeff() > 0.0; }
  bool closed() const { return edge.minCoeff() > 0.0; }
  /// Volume (m^3) of a closed box.
  double volume() const { return edge.prod(); }
  /// Whole multiples of the edges which, added to the vector d (m), make it shortest.
  Vec3 nearest_image(const Vec3& d) const;
};

/// Edges as an exact function of time: start * exp(rate * min(t, until)).
struct Strain {
  Vec3 start = Vec3::Zero();                               ///< m
  Vec3 rate = Vec3::Zero();                                ///< 1/s
  double until = std::numeric_limits<double>::infinity();  ///< s

  bool acts(double t) const { return rate != Vec3::Zero() && t < until; }
  Vec3 edge(double t) const;
};

/// Every edge of a box must be longer than this (m): a sphere then sees no other in two images, and no body
/// sees itself.
double least_edge(const Bodies& bodies);

}  // namespace cairn
