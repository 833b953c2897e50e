// The same collisions in LAMMPS and in cairn, and their differences term by term; run by tests/lammps.sh in a
// folder with in.collision, where it leaves the tables and figures of tests/LAMMPS.md.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "lammps/codes.h"
#include "physics/svg.h"

namespace cairn::lammps {
namespace {

constexpr int kFine = 8;  // divides the default time step

std::vector<Case> cases() {
  const auto turned = [](double w, double x, double y, double z) { return Quat(w, x, y, z).normalized(); };
  return {
      {"two dumbbells, off-centre",
       "dumbbells",
       {.shape = "dumbbell", .velocity = {0.5, 0.1, 0.0}, .orientation = turned(1, 0, 0, 0.4)},
       {.shape = "dumbbell",
        .position = {0.0, 0.9, 0.3},
        .velocity = {-0.5, 0.0, 0.2},
        .orientation = turned(1, 0.3, 0.8, 0.2)},
       {1, 0, 0}},
      {"tetrahedron on cube, oblique",
       "tetrahedron-cube",
       {.shape = "cube", .velocity = {0.3, 0.0, 0.1}, .orientation = turned(1, 0.2, 0.1, 0.3)},
       {.shape = "tetrahedron",
        .position = {0.4, 0.5, 0.0},
        .velocity = {-0.2, 0.5, -0.8},
        .orientation = turned(1, -0.3, 0.5, 0.1)},
       {0, 0, 1}},
      {"small rod on L, both spinning",
       "rod-l",
       {.shape = "l_shape",
        .velocity = {0.4, 0.0, 0.0},
        .spin = {0.2, -0.3, 0.5},
        .orientation = turned(1, 0.4, -0.2, 0.3)},
       {.shape = "rod4",
        .size = 0.6,
        .position = {0.0, 0.7, 0.4},
        .velocity = {-0.4, 0.1, 0.1},
        .spin = {1.0, 0.5, -0.8},
        .orientation = turned(1, 0.1, 0.2, 0.6)},
       {1, 0, 0}},
      {"two cubes, four contacts",
       "cubes",
       {.shape = "cube", .velocity = {0.0, 0.1, 0.4}},
       {.shape = "cube",
        .position = {0.2, 0.3, 0.0},
        .velocity = {0.3, 0.0, -0.4},
        .orientation = turned(1, 1e-4, 2e-4, 1e-4)},
       {0, 0, 1}},
  };
}

const std::vector<Surfaces> kSurfaces = {{"A", "spring", false, false},
                                         {"B", "spring, dashpot", true, false},
                                         {"C", "springs, friction", false, true},
                                         {"D", "springs, dashpots, friction", true, true}};
constexpr std::size_t kElastic = 0, kSmooth = 1, kWhole = 3;

/// Largest difference of any component of velocity (m/s) or spin (rad/s).
double difference(const Moment& a, const Moment& b) {
  double worst = 0.0;
  for (std::size_t k = 0; k < 2; ++k)
    worst =
        std::max({worst, (a[k].v - b[k].v).cwiseAbs().maxCoeff(), (a[k].w - b[k].w).cwiseAbs().maxCoeff()});
  return worst;
}
double difference(const Track& a, const Track& b) {
  double worst = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, difference(a[k], b[k]));
  return worst;
}

enum class Shrinks { with_step, with_overlap, not_at_all };
struct Term {
  std::string name;
  bool Conventions::*use;
  Shrinks shrinks;
};
const std::vector<Term> kTerms = {
    {"1 common point", &Conventions::common_point, Shrinks::with_overlap},
    {"2 dashpot velocity", &Conventions::dashpots_at_end, Shrinks::with_step},
    {"3 carried spring", &Conventions::springs_turn, Shrinks::with_overlap},
    {"4 slider", &Conventions::spring_cut_first, Shrinks::not_at_all},
    {"5 partial steps", &Conventions::partial_steps, Shrinks::with_step},
    {"6 attitude", &Conventions::splitting, Shrinks::with_step},
};

bool g_failed = false;
void require(bool holds, const std::string& what) {
  if (holds) return;
  g_failed = true;
  fmt::print(stderr, "FAILED: {}\n", what);
}

constexpr double kRoundOff = 1e-9;  // m/s and rad/s, after thousands of steps

std::string number(double x) {
  return x < 1e-10 ? "<1e-10" : fmt::format("{:.1e}", x);
}

/// All that is measured of one setting.
struct Result {
  Track cairn, lammps;
  double total = 0.0;                      ///< cairn - LAMMPS after the collision
  double as_lammps = 0.0, as_cairn = 0.0;  ///< the dissected code against each, at any step
  std::vector<double> terms;               ///< what each switch changes after the collision, in turn
  double overlap = 0.0;                    ///< largest, over the smaller radius
  double gain_lammps = 0.0, gain_common = 0.0, gain_cairn = 0.0;  ///< of angular momentum, kg m^2/s
};

double gain(const Start& start, const Track& track) {
  const auto& mass = start.run.state.bodies.mass;
  const auto total = [&](const Moment& m) -> Vec3 {
    return mass[0] * m[0].x.cross(m[0].v) + m[0].momentum + mass[1] * m[1].x.cross(m[1].v) + m[1].momentum;
  };
  return (total(track.back()) - total(track.front())).norm();
}

Result examine(const Setting& s) {
  Start start(s);
  Result r;
  Conventions use;
  Track before = run_dissected(start, use);
  r.lammps = run_lammps(start, start.law.c_n, start.law.c_s);
  r.as_lammps = difference(before, r.lammps);
  r.gain_lammps = gain(start, r.lammps);
  for (const Term& term : kTerms) {
    use.*term.use = true;
    Track after = run_dissected(start, use);
    if (term.use == &Conventions::common_point) r.gain_common = gain(start, after);
    r.terms.push_back(difference(after.back(), before.back()));
    before = std::move(after);
  }
  r.cairn = run_cairn(start);
  r.as_cairn = difference(before, r.cairn);
  r.gain_cairn = gain(start, r.cairn);
  r.total = difference(r.cairn.back(), r.lammps.back());
  r.overlap = start.run.state.ledger.largest_overlap;
  const std::string name = fmt::format("{}, {}, step / {}, stiffness x {}", s.what.name, s.surfaces.letter,
                                       s.refine, s.stiffening);
  require(r.as_lammps < kRoundOff, name + ": the dissected code is not LAMMPS");
  require(r.as_cairn < kRoundOff, name + ": the dissected code is not cairn");
  require(start.run.touching() == false, name + ": the bodies still touch");
  fmt::print("{}: {:.2e} ({:.0e} {:.0e})\n", name, r.total, r.as_lammps, r.as_cairn);
  return r;
}

struct Three {
  Result coarse, fine, stiff;
};

std::string overview(const std::vector<std::vector<Three>>& all, const std::vector<Case>& what) {
  std::string out = fmt::format(
      "| contact | bodies | largest overlap / r | cairn - LAMMPS, default step | step / {0} | step / {0}, "
      "stiffness x 4 | switches off - LAMMPS | switches on - cairn |\n|---|---|---|---|---|---|---|---|\n",
      kFine);
  for (std::size_t l = 0; l < all.size(); ++l)
    for (std::size_t c = 0; c < what.size(); ++c) {
      const Three& t = all[l][c];
      out += fmt::format("| {} {} | {} | {:.1e} | {} | {} | {} | {:.0e} | {:.0e} |\n", kSurfaces[l].letter,
                         kSurfaces[l].name, what[c].name, t.coarse.overlap, number(t.coarse.total),
                         number(t.fine.total), number(t.stiff.total),
                         std::max({t.coarse.as_lammps, t.fine.as_lammps, t.stiff.as_lammps}),
                         std::max({t.coarse.as_cairn, t.fine.as_cairn, t.stiff.as_cairn}));
    }
  return out;
}

/// Each term goes as claimed, summed over the cases (one case depends on the phase of the step at first
/// touch).
void check_term(const Term& term, const std::string& law, double coarse, double fine, double stiff) {
  if (coarse < 1e-7) return;
  if (term.shrinks == Shrinks::with_step)
    require(fine < coarse / 3.0, fmt::format("{}: {} shrinks with the step", law, term.name));
  if (term.shrinks == Shrinks::with_overlap)
    require(std::abs(fine / stiff - 2.0) < 0.3, fmt::format("{}: {} shrinks with overlap", law, term.name));
}

std::string by_term(const std::vector<std::vector<Three>>& all, const std::vector<Case>& what) {
  std::string out = fmt::format(
      "| contact | switch | bodies | default step | step / {0} | step / {0}, stiffness x 4 |\n"
      "|---|---|---|---|---|---|\n",
      kFine);
  for (std::size_t l = 0; l < all.size(); ++l)
    for (std::size_t t = 0; t < kTerms.size(); ++t) {
      double coarse = 0.0, fine = 0.0, stiff = 0.0;
      for (const Three& c : all[l]) {
        coarse += c.coarse.terms[t];
        fine += c.fine.terms[t];
        stiff += c.stiff.terms[t];
      }
      if (coarse + fine + stiff < 1e-8) continue;  // this law has no such part
      check_term(kTerms[t], kSurfaces[l].letter, coarse, fine, stiff);
      for (std::size_t c = 0; c < what.size(); ++c)
        out += fmt::format("| {} | {} | {} | {} | {} | {} |\n", kSurfaces[l].letter, kTerms[t].name,
                           what[c].name, number(all[l][c].coarse.terms[t]), number(all[l][c].fine.terms[t]),
                           number(all[l][c].stiff.terms[t]));
    }
  return out;
}

std::string angular_momentum(const std::vector<Three>& law, const std::vector<Case>& what) {
  std::string out =
      "| bodies | LAMMPS | LAMMPS, stiffness x 4 | only switch 1 on | cairn |\n|---|---|---|---|---|\n";
  for (std::size_t c = 0; c < what.size(); ++c) {
    const Three& t = law[c];
    out += fmt::format("| {} | {:.3g} | {:.3g} | {:.0e} | {:.0e} |\n", what[c].name, t.fine.gain_lammps,
                       t.stiff.gain_lammps, t.fine.gain_common, t.fine.gain_cairn);
    require(std::abs(t.fine.gain_lammps / t.stiff.gain_lammps - 2.0) < 0.2 &&
                std::max(t.fine.gain_common, t.fine.gain_cairn) < 1e-6 * t.fine.gain_lammps,
            what[c].name + ": angular momentum");
  }
  return out;
}

/// The two spheres of different bodies that are nearest to each other.
std::pair<std::size_t, std::size_t> nearest(const Spheres& spheres) {
  std::pair<std::size_t, std::size_t> out;
  double least = 1e300;
  for (std::size_t i = 0; i < spheres.size(); ++i)
    for (std::size_t j = i + 1; j < spheres.size(); ++j)
      if (const double d = (spheres.position[j] - spheres.position[i]).norm();
          spheres.body[i] != spheres.body[j] && d < least) {
        least = d;
        out = {i, j};
      }
  return out;
}

/// One contact as it is at the start of a run: the bodies turn by little while it lasts.
struct Blow {
  Vec3 n, arm[2];        ///< normal, centres of the spheres from those of their bodies
  double closing, mass;  ///< m/s; kg, effective mass of the bodies along n

  explicit Blow(const Bodies& bodies) {
    const Spheres& spheres = bodies.spheres;
    const auto [i, j] = nearest(spheres);
    n = (spheres.position[j] - spheres.position[i]).normalized();
    arm[0] = spheres.position[i] - bodies.position[0];
    arm[1] = spheres.position[j] - bodies.position[1];
    double mobility = 0.0;
    for (std::size_t b = 0; b < 2; ++b) {
      const Vec3 moment = bodies.orientation[b].conjugate() * arm[b].cross(n);
      mobility += 1.0 / bodies.mass[b] + moment.dot(moment.cwiseQuotient(bodies.inertia[b]));
    }
    mass = 1.0 / mobility;
    closing = opening({bodies.velocity[0], bodies.velocity[1]},
                      {angular_velocity(bodies, 0), angular_velocity(bodies, 1)});
  }

  double opening(const std::array<Vec3, 2>& v, const std::array<Vec3, 2>& w) const {
    return (v[1] + w[1].cross(arm[1]) - v[0] - w[0].cross(arm[0])).dot(n);
  }
  double restitution(const Track& track) const {
    const Moment& m = track.back();
    return -opening({m[0].v, m[1].v}, {m[0].w, m[1].w}) / closing;
  }
};

/// cairn as it is by default, with dashpots from the mass at the contact: the largest difference at any step
/// from the dissected code with that switch on too.
double difference_by_default(const Setting& s) {
  Start start({s.what, s.surfaces, s.refine, s.stiffening, "bodies"});
  Conventions use = Conventions::cairn();
  use.mass_at_contact = true;
  const Track dissected = run_dissected(start, use);
  return difference(dissected, run_cairn(start));
}

/// Normal spring and dashpot, with the dashpot from different masses: restitution at the contact.
std::string damping_mass(const Case& what) {
  struct Row {
    const char *code, *of;
    double mass, expected;
    std::vector<double> found;
  };
  std::vector<Row> rows;
  double ratio = 0.0;
  for (const double stiffening : {1.0, 4.0}) {
    Start spheres({what, kSurfaces[kSmooth], kFine, stiffening}),
        contact({what, kSurfaces[kSmooth], kFine, stiffening, "bodies"});
    const Blow blow(spheres.run.state.bodies);
    const auto& mass = spheres.run.state.bodies.mass;
    const double of_bodies = mass[0] * mass[1] / (mass[0] + mass[1]);
    const double of_spheres = 0.5 * kDensity * 4.0 / 3.0 * kPi;  // both of radius 1 m
    ratio = contact.law.c_n;

    const Track lammps = run_lammps(spheres, ratio * std::sqrt(spheres.law.k_n * of_bodies), 0.0),
                lammps_spheres = run_lammps(spheres, spheres.law.c_n, spheres.law.c_s);
    const Track cairn_contact = run_cairn(contact), cairn_spheres = run_cairn(spheres);
    const auto add = [&](std::size_t at, const char* code, const char* of, double m, const Track& track) {
      // That of a damped oscillator of mass `blow.mass`.
      const double damping = 0.5 * ratio * std::sqrt(m / blow.mass);
      const double expected = std::exp(-kPi * damping / std::sqrt(1.0 - damping * damping));
      if (rows.size() == at) rows.push_back({code, of, m, expected, {}});
      rows[at].found.push_back(blow.restitution(track));
    };
    add(0, "LAMMPS", "the bodies", of_bodies, lammps);
    add(1, "LAMMPS, gamma_n smaller", "the spheres", of_spheres, lammps_spheres);
    add(2, "cairn, `damping_mass = \"spheres\"`", "the spheres", of_spheres, cairn_spheres);
    add(3, "cairn", "the bodies at the contact", blow.mass, cairn_contact);
  }
  std::string out = fmt::format(
      "| code | m of | m, kg | restitution expected | found | stiffness x 4 |\n|---|---|---|---|---|---|\n");
  for (const Row& r : rows) {
    out += fmt::format("| {} | {} | {:.0f} | {:.4f} | {:.4f} | {:.4f} |\n", r.code, r.of, r.mass, r.expected,
                       r.found[0], r.found[1]);
    require(std::abs(r.found[1] - r.expected) < 2e-3,
            fmt::format("{}: restitution with m of {}", r.code, r.of));
  }
  return out;
}

void write_plot(const std::string& name, const report::Axes& axes, const std::vector<report::Curve>& curves) {
  std::ofstream("lammps-" + name + ".svg") << report::svg(axes, curves);
}

/// An axis that begins early, so that the legend hides nothing.
report::Curve room_for_legend(double duration) {
  return {.label = "", .x = {-0.3 * duration}, .y = {std::nan("")}};
}

/// Spin of the second body, cairn as lines and LAMMPS as dots.
void plot_spin(const Case& what, const Result& r, double dt) {
  std::vector<report::Curve> curves;
  for (const bool lammps : {false, true})
    for (int c = 0; c < 3; ++c) {
      report::Curve curve{.label = fmt::format("{} {}", lammps ? "LAMMPS" : "cairn", "xyz"[c]),
                          .x = {},
                          .y = {},
                          .line = !lammps};
      const Track& track = lammps ? r.lammps : r.cairn;
      for (std::size_t k = 0; k < track.size(); k += lammps ? 2 : 1) {
        curve.x.push_back(1e3 * dt * static_cast<double>(k + 1));
        curve.y.push_back(track[k][1].w[c]);
      }
      curves.push_back(curve);
    }
  curves.push_back(room_for_legend(curves[0].x.back()));
  write_plot(what.file, {"time, ms", "spin of the second body, rad/s"}, curves);
}

void plot_force(const std::vector<std::vector<Three>>& all, double dt) {
  std::vector<report::Curve> curves;
  for (const bool lammps : {false, true})
    for (const std::size_t l : {kElastic, kSmooth, kWhole}) {
      const Track& track = lammps ? all[l][0].coarse.lammps : all[l][0].coarse.cairn;
      report::Curve curve{.label = fmt::format("{}: {}", lammps ? "LAMMPS" : "cairn", kSurfaces[l].letter),
                          .x = {},
                          .y = {},
                          .line = !lammps};
      for (std::size_t k = 0; k < track.size(); k += lammps ? 2 : 1) {
        curve.x.push_back(1e3 * dt * static_cast<double>(k + 1));
        curve.y.push_back(1e-6 * track[k][0].force.norm());
      }
      curves.push_back(curve);
    }
  curves.push_back(room_for_legend(curves[0].x.back()));
  write_plot("force", {"time, ms", "force between the dumbbells, MN"}, curves);
}

void plot_terms(const Case& what) {
  std::vector<report::Curve> curves(kTerms.size());
  curves.back().label = "cairn - LAMMPS";
  for (std::size_t t = 0; t + 1 < kTerms.size(); ++t) curves[t].label = kTerms[t].name;
  for (const int refine : {1, 2, 4, 8, 16}) {
    const Result r = examine({what, kSurfaces[kWhole], refine});
    for (std::size_t t = 0; t < kTerms.size(); ++t) {
      curves[t].x.push_back(1.0 / refine);
      curves[t].y.push_back(t + 1 < kTerms.size() ? r.terms[t] : r.total);
    }
  }
  write_plot(
      "terms",
      {"time step over the default", "change of velocity or spin after the blow, m/s, rad/s", true, true},
      curves);
}

int compare() {
  const std::vector<Case> what = cases();
  std::vector<std::vector<Three>> all;
  for (const Surfaces& surfaces : kSurfaces) {
    std::vector<Three>& row = all.emplace_back();
    for (const Case& c : what)
      row.push_back(
          {examine({c, surfaces}), examine({c, surfaces, kFine}), examine({c, surfaces, kFine, 4.0})});
  }
  for (const Surfaces& surfaces : {kSurfaces[kSmooth], kSurfaces[kWhole]})
    for (const Case& c : what)
      require(difference_by_default({c, surfaces}) < kRoundOff,
              fmt::format("{}, {}: the dissected code is not cairn's default", c.name, surfaces.letter));
  std::ofstream("results.md") << overview(all, what);
  std::ofstream("terms.md") << by_term(all, what);
  std::ofstream("momentum.md") << angular_momentum(all[kWhole], what);
  std::ofstream("mass.md") << damping_mass(what[0]);
  for (std::size_t c = 0; c < what.size(); ++c)
    plot_spin(what[c], all[kWhole][c].coarse, Start({what[c], kSurfaces[kWhole]}).dt);
  plot_force(all, Start({what[0], kSurfaces[0]}).dt);
  plot_terms(what[0]);
  return g_failed ? 1 : 0;
}

}  // namespace
}  // namespace cairn::lammps

int main() {
  try {
    return cairn::lammps::compare();
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
