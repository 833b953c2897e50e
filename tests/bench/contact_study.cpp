// What the time step, the stiffness and the number of spheres per body buy: restitution, critical spin period
// and drift against cost. Writes a section of BENCHMARKS.md to the standard output; progress goes to the
// standard error.
//   contact_study FOLDER [PILES]     FOLDER has boulder-N.toml; result files stay in it, so that a study that
//                                    was stopped goes on
#include <cstring>
#include "bench/study.h"

#include "shape/library.h"
#include "stage.h"

namespace cairn {
namespace {

/// Greatest relative error of the restitution 0.55 over the phases of the step at first touch.
double restitution_error(double steps_per_contact) {
  constexpr double speed = 0.1, asked = 0.55;
  constexpr int phases = 20;
  double worst = 0.0;
  for (int k = 0; k < phases; ++k) {
    Stage stage(fmt::format(R"(
[[body]]
shape = "sphere"
density = 2500
[[material]]
name = "stone"
restitution_normal = {}
[gravity]
method = "none"
[contact]
stiffness = 1e7
steps_per_contact = {}
[[stage]]
name = "blow"
duration = 10
)",
                            asked, steps_per_contact));
    const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
    Bodies& bodies = stage.state.bodies;
    add_body(bodies, ball, 0, 1.0, 2500.0, 0, {.position = {0, 0, 2.1}, .velocity = {0, 0, -speed}});
    add_body(bodies, ball, 0, 1.0, 2500.0, 0, {});
    stage.begin();
    bodies.position[0].z() = 2.0 + speed * stage.physics.contacts.dt * (1.0 + (k + 0.5) / phases);
    stage.begin();
    while (!stage.touching()) stage.advance(1);
    while (stage.touching()) stage.advance(1);
    const double e = (bodies.velocity[0].z() - bodies.velocity[1].z()) / speed;
    worst = std::max(worst, std::abs(e / asked - 1.0));
  }
  return worst;
}

/// Critical periods of the piles for each setting, as rows of a table whose first columns `start` writes;
/// differences are to the setting `reference`. `pile_of` makes the pile of a seed for a setting.
template <class PileOf, class Start>
void spin_up(Study& study, const char* kind, const std::vector<Setting>& settings, std::size_t reference,
             int piles, const PileOf& pile_of, const Start& start) {
  const auto run = [&](std::size_t k, int seed) {
    const std::string pile = pile_of(k, seed);
    return study.run(fmt::format("{}-{}-{}", kind, seed, k), spin_scene(pile + ".h5", settings[k].tables));
  };
  for (std::size_t k = 0; k < settings.size(); ++k) {
    start(k);
    Differences differences;
    Outcome sum;
    for (int seed = 1; seed <= piles; ++seed) {
      const Outcome o = run(k, seed);
      differences.add((o.period - run(reference, seed).period) / 3600.0);
      sum.overlap = std::max(sum.overlap, o.overlap);
      sum.angular = std::max(sum.angular, o.angular);
      sum.energy = std::max(sum.energy, o.energy);
      sum.steps += o.steps / piles;
      sum.cost += o.cost / piles;
      fmt::print(" {:.3f} |", o.period / 3600.0);
    }
    fmt::print(" {:+.3f} | {:.3f} | {:.2f} | {:.1e} | {:.1e} | {:.0f} | {:.0f} |\n", differences.mean(),
               differences.scatter(), 100.0 * sum.overlap, sum.energy, sum.angular, 1e-3 * sum.steps,
               sum.cost);
    std::fflush(stdout);
  }
}

void head(const char* first, int piles) {
  fmt::print("\n| {} |", first);
  for (int seed = 1; seed <= piles; ++seed) fmt::print(" pile {} |", seed);
  fmt::print(
      " difference | scatter | largest overlap, % | energy astray | drift of L | 1000 steps | cost, s |\n|");
  const auto columns = 8 + std::count(first, first + std::strlen(first), '|') + piles;
  for (int k = 0; k < columns; ++k) fmt::print("---|");
  fmt::print("\n");
}

/// Boulders of N spheres each: their pile, and when it fails.
void aggregates(Study& study) {
  fmt::print(
      "\n400 copies of a boulder of 12 m, fitted with N spheres, fall together, settle and are spun up in "
      "the "
      "same way. RMS distance of the surfaces: see FITS.md.\n\n"
      "| spheres per boulder | contacts per boulder | neighbours per boulder | critical period, h | "
      "microseconds per boulder and step | 1000 steps | cost, s |\n|---|---|---|---|---|---|---|\n");
  for (const int n : {1, 2, 4, 8, 16, 32}) {
    const std::string soft = "[contact]\nmax_overlap = 0.03\noverlap_limit = 0.5";
    const Outcome made = study.run(
        fmt::format("boulders-{}", n),
        collapse_scene(
            1, soft,
            {.count = 400, .size = 12.0, .size_max = 12.001, .shape = fmt::format("boulder-{}.toml", n)}));
    const Outcome o =
        study.run(fmt::format("boulders-spin-{}", n), spin_scene(fmt::format("boulders-{}.h5", n), soft));
    fmt::print("| {} | {:.2f} | {:.2f} | {:.3f} | {:.2f} | {:.0f} | {:.0f} |\n", n, made.contacts / 400.0,
               made.neighbours / 400.0, o.period / 3600.0, 1e6 * o.cost / o.steps / 400.0, 1e-3 * o.steps,
               o.cost);
    std::fflush(stdout);
  }
}

void report(const std::filesystem::path& folder, int piles) {
  Study study(std::filesystem::absolute(folder));
  for (int seed = 1; seed <= piles; ++seed)
    study.run(fmt::format("collapse-{}", seed), collapse_scene(seed, ""));
  fmt::print(
      "Piles of 1500 spheres of 8 to 12 m, spun up from 5 h to 3.5 h in 1500 s and by 0.6 s/s from there "
      "until "
      "c/a has fallen by 1 %. Critical period in hours of each pile; mean and scatter of its difference to "
      "the "
      "finest setting; energy astray over |W|; cost of one thread. First the time step "
      "(`contact.steps_per_contact`), "
      "beside the greatest error of a single blow's restitution (0.55) over the phases of the step:\n");
  const std::vector<double> steps{10, 15, 20, 30, 50, 100, 200};
  std::vector<Setting> settings;
  for (const double n : steps)
    settings.push_back({fmt::format("{:g}", n), fmt::format("[contact]\nsteps_per_contact = {}", n)});
  head("steps per contact | restitution astray", piles);
  spin_up(
      study, "step", settings, settings.size() - 1, piles,
      [](std::size_t, int seed) { return fmt::format("collapse-{}", seed); },
      [&](std::size_t k) {
        fmt::print("| {} | {:.2g} % |", settings[k].name, 100.0 * restitution_error(steps[k]));
      });
  fmt::print(
      "\nThen the stiffness, by the overlap that it aims at (`contact.max_overlap`), of piles that fell "
      "together with it:\n");
  settings.clear();
  for (const double x : {0.03, 0.02, 0.01, 0.005, 0.002, 0.001})
    settings.push_back({fmt::format("{:g} %", 100.0 * x), fmt::format("[contact]\nmax_overlap = {}", x)});
  head("overlap", piles);
  spin_up(
      study, "overlap", settings, settings.size() - 1, piles,
      [&](std::size_t k, int seed) {
        const std::string pile = fmt::format("collapse-{}-overlap-{}", seed, k);
        study.run(pile, collapse_scene(seed, settings[k].tables));
        return pile;
      },
      [&](std::size_t k) { fmt::print("| {} |", settings[k].name); });
  aggregates(study);
}

}  // namespace
}  // namespace cairn

int main(int count, char** arguments) {
  if (count < 2) {
    fmt::print(stderr, "usage: contact_study FOLDER [PILES]\n");
    return 2;
  }
  cairn::report(arguments[1], count > 2 ? std::atoi(arguments[2]) : 3);
}
