// Gravity by a fast multipole method: dual walk, Cartesian expansions, pair sums among near leaves.
#pragma once

#include "gravity/tree.h"

namespace cairn::gravity {

struct FmmSettings {
  double theta = 0.7;  ///< cells meet by expansion when the sum of their radii < theta x distance; 0..1
  int order = 5;       ///< highest degree of the expansions of the potential, 4..7
  std::size_t leaf_size = 20;  ///< points of a leaf
};

class Fmm {
 public:
  /// Throws InputError when a setting is out of bounds.
  explicit Fmm(const FmmSettings& settings = {});

  /// From now on cells meet by expansion only where what the first neglected terms do to either of them is
  /// below this (m/s^2); 0: theta alone decides.
  void set_tolerance(double tolerance) { tolerance_ = tolerance; }

  /// Acceleration (m/s^2) of every point by the points of other groups and, when `potential` is not empty,
  /// its potential (J/kg). Points of one group never act on each other, near or far. Net force vanishes to
  /// round-off, the net torque only to the error of the method. Same bits for any number of threads.
  /// Throws as `check` does.
  void evaluate(const Points& points, std::span<Vec3> acceleration, std::span<double> potential = {});

 private:
  FmmSettings settings_;
  double tolerance_ = 0.0;
  Tree tree_;
  std::vector<double> reduced_;  // independent components of the multipoles, cell by cell, and a row of zeros
};

}  // namespace cairn::gravity
