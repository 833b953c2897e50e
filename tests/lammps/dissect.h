// A small independent integrator of one collision of two bodies, written from the equations of both codes,
// with one switch for each convention in which they differ. All switches off: LAMMPS (fix rigid/small with
// gran/hooke/history, 29 Sep 2021); all on: cairn. It shares no code with either.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "core/math.h"

namespace cairn::lammps {

struct Conventions {
  /// Off: friction acts on each sphere at its own radius from its centre. On: at one common point.
  bool common_point = false;
  /// Off: dashpots see the velocities of mid-step. On: those predicted for the end of the step.
  bool dashpots_at_end = false;
  /// Off: the tangential spring grows with the slip seen at the end of the drift, then loses its normal part.
  /// On: with that in mid-step, is turned with the bodies, and keeps its length when made tangential.
  bool springs_turn = false;
  /// Off: sliding resets the spring so that spring + dashpot make the limit, mu |F_N|. On: the spring is
  /// shortened to the limit, turning towards the slip meanwhile, then the sum is cut to the limit, which is
  /// mu max(0, F_N).
  bool spring_cut_first = false;
  /// Off: a contact acts from the first to the last evaluation that finds an overlap. On: the two steps that
  /// it shares with its absence are given their part.
  bool partial_steps = false;
  /// Off: attitude by Richardson extrapolation. On: by symmetric splitting of the free top.
  bool splitting = false;
  /// Off: the dashpot constants are those given. On: of each contact, from the effective masses of the bodies
  /// at the contact point; those given are then C / sqrt(k mu).
  bool mass_at_contact = false;

  static Conventions cairn() { return {true, true, true, true, true, true, false}; }
};

struct Ball {
  int body;
  Vec3 offset;  ///< m, from the centre of mass, in the body's principal frame
  double radius;
};

struct Rigid {
  double mass;
  Vec3 inertia;   ///< principal moments
  Vec3 x, v;      ///< centre of mass
  Quat q;         ///< principal frame -> space
  Vec3 momentum;  ///< angular, about the centre of mass
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
};

struct Law {
  double k_n, k_s, c_n, c_s, friction;
};

class Collision {
 public:
  Collision(std::vector<Rigid> bodies, std::vector<Ball> balls, const Law& law, const Conventions& use)
      : bodies_(std::move(bodies)), balls_(std::move(balls)), law_(law), use_(use) {}

  void step(double dt);
  const std::vector<Rigid>& bodies() const { return bodies_; }

 private:
  struct Memory {
    Vec3 slide = Vec3::Zero();
    double c_n = 0.0, c_s = 0.0;
  };
  /// A body within the step.
  struct Motion {
    Vec3 w_mid, v_mid, w_end, v_end;
  };
  struct Pair {
    std::size_t i, j;
    Vec3 arm_i, arm_j;          ///< centres of the balls from those of their bodies
    Vec3 arm_i_mid, arm_j_mid;  ///< the same in mid-step
  };

  Vec3 turn(Rigid& body, double dt) const;
  void meet(const Pair& pair, const std::vector<Motion>& motion, double dt);
  void part(const Pair& pair, const std::vector<Motion>& motion, double dt);
  void impulse(const Pair& pair, const Vec3& on_i, const Vec3& couple_i, const Vec3& couple_j);
  void set_damping(const Pair& pair, const Vec3& point_i, const Vec3& point_j, const Vec3& n,
                   Memory& memory) const;
  /// Velocity (m/s) that a unit force along e gives the contact point of both bodies, along e; points from
  /// their mass centres.
  double mobility(const Pair& pair, const Vec3& point_i, const Vec3& point_j, const Vec3& e) const;
  Vec3 separation(const Pair& pair) const;

  std::vector<Rigid> bodies_;
  std::vector<Ball> balls_;
  Law law_;
  Conventions use_;
  std::map<std::pair<std::size_t, std::size_t>, Memory> touching_;
};

}  // namespace cairn::lammps
