// The persistent state of a run: all that a checkpoint holds, and nothing that can be rebuilt from it.
#pragma once

#include <string>
#include <vector>

#include "body/cells.h"
#include "contact/box.h"
#include "contact/held.h"
#include "contact/history.h"
#include "contact/walls.h"
#include "gravity/renewal.h"

namespace cairn {

/// Outcome of a run that came to its end.
inline constexpr const char* kFinished = "finished";

/// Where the run is. Time is counted in whole steps from the start of the stage, so it does not drift.
struct Clock {
  std::uint64_t stage = 0;
  std::uint64_t step = 0;         ///< steps done in this stage
  std::uint64_t steps = 0;        ///< steps of this stage; 0 before it has begun
  std::uint64_t total_steps = 0;  ///< steps done in all stages
  double stage_start = 0.0;       ///< s
  double dt = 0.0;                ///< s

  double time() const { return stage_start + static_cast<double>(step) * dt; }
  double stage_time() const { return static_cast<double>(step) * dt; }
};

/// Spin control of the last stage that had it, and its verdict; see sim/spin_control.h.
struct Control {
  bool active = false;
  bool settled = false;          ///< the pile has been at rest under control: start_ratio stays
  bool failed = false;           ///< a fall of c/a has lasted
  double limit_ratio = 0.0;      ///< c/a below which it has fallen
  double hold = 0.0;             ///< s, that a fall must last
  double failure_time = 0.0;     ///< s, when that fall began
  double failure_period = 0.0;   ///< s, asked for then
  double failure_ratio = 0.0;    ///< c/a then
  double shortest_period = 0.0;  ///< s, held under control so far in the run; 0: none
  double start_ratio = 0.0;      ///< c/a against which falls are judged; 0: control has not begun
  double start_time = 0.0;       ///< s, of that c/a
  double start_rate = 0.0;       ///< rad/s, at which the pile turned when control began
  double fall_time = -1.0;       ///< s, since when c/a has been too small; negative: it is not
  double fall_period = 0.0;      ///< s, asked for then
  double fall_ratio = 0.0;       ///< c/a then
  std::uint64_t next_check = 0;  ///< step of the stage

  bool operator==(const Control&) const = default;
};

/// A stage that relaxes (see relax.h).
struct Relaxation {
  std::vector<std::uint32_t> pile;  ///< number of each body's pile; empty: the stage does not relax
  double scale = 0.0;               ///< J, with which the energy of the motion inside the piles is compared
  std::uint64_t look = 1;           ///< steps from one look at that energy to the next
};

/// What perturbers do to all bodies together at one moment.
struct PerturberRates {
  Vec3 force = Vec3::Zero();   ///< N
  Vec3 torque = Vec3::Zero();  ///< N m, about the mass centre
  double power = 0.0;          ///< W

  PerturberRates& operator+=(const PerturberRates& other) {
    force += other.force;
    torque += other.torque;
    power += other.power;
    return *this;
  }
};

/// What perturbers have given since the start, and their rates at the last evaluation.
struct PerturberLedger {
  double work = 0.0;                     ///< J
  Vec3 momentum = Vec3::Zero();          ///< kg m/s
  Vec3 angular_momentum = Vec3::Zero();  ///< kg m^2/s, about the mass centre
  PerturberRates rates;
};

/// Running totals.
struct Ledger {
  double dissipated = 0.0;               ///< J, lost in contacts
  double wall_work = 0.0;                ///< J, done by moving walls and held bodies
  double wall_power = 0.0;               ///< W, of these at the last evaluation
  double control_work = 0.0;             ///< J, done by spin control
  double relaxed = 0.0;                  ///< J, taken out by stages that relax
  double stage_work = 0.0;               ///< J, given to springs by changes from stage to stage
  Vec3 control_momentum = Vec3::Zero();  ///< kg m^2/s, angular momentum given by spin control
  PerturberLedger perturbers;
  Vec3 field_momentum = Vec3::Zero();  ///< kg m/s, given by uniform fields in former stages
  bool rebase = false;                 ///< something other than these has changed the momenta: count anew
  double largest_overlap = 0.0;        ///< over the smaller radius of its pair, of the whole run
  double recent_overlap = 0.0;         ///< the same since the last row of the series
  Vec3 start_momentum = Vec3::Zero();  ///< kg m/s, total at the start
  Vec3 start_angular_momentum = Vec3::Zero();  ///< kg m^2/s, total about the mass centre at the start
};

struct State {
  Bodies bodies;
  Frame frame;    ///< of the bodies, at the start of the run
  Frame shift;    ///< the same from the zero of the scene
  Box box;        ///< now
  Strain strain;  ///< of the box, in the stage
  ContactList contacts;
  Walls walls;
  HeldBodies held;
  gravity::HeldGravity gravity;
  Clock clock;
  Control control;
  Relaxation relaxation;
  Ledger ledger;
  double k_n = 0.0;                  ///< N/m, normal stiffness of the stage, of materials without their own
  double region_volume = 0.0;        ///< m^3, of the region last carved; 0: none, or the pile has failed
  std::vector<double> stage_starts;  ///< s, of the stages that have begun
  std::vector<double> wall_lead;     ///< s, that each wall had moved before it began to in this run; empty: 0
  std::vector<std::uint8_t> remnant;  ///< of each body: 1 when part of the pile that is spun
  bool finished = false;

  /// Whether momentum can go to what does not move freely.
  bool anchored() const { return !walls.empty() || !held.empty(); }
};

}  // namespace cairn
