// ukemi bench integrators: every method over a range of steps or tolerances, on the paper's scene, a stiff one and the
// impact rig.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "common/actuator.hpp"
#include "common/median.hpp"
#include "common/stopwatch.hpp"
#include "identify/rollout/rollout.hpp"
#include "landing/body/by_links.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/run/simulate.hpp"
#include "tools/bench/bench.hpp"
#include "tools/bench/reference.hpp"
#include "tools/program/trials.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kTight = 1e-13;

/// The final place of the centre of mass and angles of the links of a landing [m, rad].
Eigen::Vector4d final_pose(const BodyLanding& l) { return {l.base[0], l.base[1], l.theta[0], l.theta[1]}; }

/// Largest errors over the cases of a scene.
struct Errors {
  double peak = 0;       ///< relative
  double touchdown = 0;  ///< [s]; infinite where one is missing or there is one too many
  double state = 0;      ///< of the final positions [m, rad]
  void include(const Errors& o) {
    peak = std::max(peak, o.peak), touchdown = std::max(touchdown, o.touchdown), state = std::max(state, o.state);
  }
};

/// A method at a step [s] (fixed-step methods) or an accuracy.
struct Entry {
  std::string scene;
  Method method;
  double setting;
  Errors errors;
  double seconds = 0, rhs = 0, events = 0;  ///< means per case; seconds: the median over the repetitions
  int failed = 0;
};

const Quantities<Entry> kEntryQuantities = {
    {"scene", "", &Entry::scene},
    {"method", "method", "method", {}, [](auto& e) { return name(e.method); }},
    {"setting", "setting", "step or accuracy", "{:g}", &Entry::setting},
    {"peak_error", "peak_error", "peak", "{:.1e}", [](auto& e) { return e.errors.peak; }},
    {"touchdown_error", "touchdown_error", "touchdown [s]", "{:.1e}", [](auto& e) { return e.errors.touchdown; }},
    {"state_error", "state_error", "state", "{:.1e}", [](auto& e) { return e.errors.state; }},
    {"time_us", "", "time [us]", "{:.1f}", [](auto& e) { return e.seconds * 1e6; }},
    {"", "time_s", &Entry::seconds},
    {"rhs", "rhs", "right-hand sides", "{:.0f}", &Entry::rhs},
    {"events", "", &Entry::events},
    {"failed", "failed", "failed", {}, &Entry::failed},
};

/// One of the errors against time [us], a curve for each method.
std::vector<Series> curves(const std::vector<Entry>& entries, double Errors::*error) {
  std::vector<Series> out;
  for (const Entry& e : entries) {
    if (out.empty() || out.back().name != name(e.method)) out.push_back({name(e.method), {}, {}});
    if (e.failed == 0) out.back().x.push_back(e.seconds * 1e6), out.back().y.push_back(e.errors.*error);
  }
  return out;
}

/// The cases of a scene: `run(i, method, setting, work, errors)` simulates case i, counts its work, and fills `errors`
/// unless null; false where the simulation fails.
struct Bench {
  std::string name, reference;
  int cases = 0;
  std::vector<double> euler, rk4, accuracies;
  std::function<bool(int, Method, double, integrate::Counters&, Errors*)> run;
};

struct LandingCase : ReferenceCase {
  Eigen::Vector4d pose;  ///< at the end
};

SimulateOptions options_for(Method method, double setting) {
  SimulateOptions o{.max_steps = 2'000'000, .method = method, .rest = SimulateOptions::Rest::kIgnore};
  (fixed_step(method) ? o.max_step : o.accuracy) = setting;
  return o;
}

double time_error(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return kInfinite;
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

/// Landings of the reference set after `change`; where that returns true, our own tightest run is their reference.
template <class Change>
Bench landings(const std::string& name, std::size_t count, Change&& change) {
  auto cases = std::make_shared<std::vector<LandingCase>>();
  const std::vector<ReferenceCase> all = read_reference(dataset("reference"));
  double agreement = 0;
  bool changed = false;
  for (std::size_t i = 0; i < all.size() && cases->size() < count; i += 2) {
    LandingCase c{all[i], {}};
    changed = change(c);
    std::vector<double> touchdowns;
    SimulateOptions tight = options_for(Method::kDormandPrince853, kTight);
    tight.touchdowns = &touchdowns;
    const TwoLinkLanding links(c.scene, c.sea, c.motion);
    const BodyLanding reference = peak_acceleration(links.scene, links.motion, tight);
    tight.touchdowns = nullptr, tight.accuracy = kTight / 2;
    const BodyLanding half = peak_acceleration(links.scene, links.motion, tight);
    c.pose = final_pose(reference);
    agreement = std::max(agreement, (final_pose(half) - c.pose).cwiseAbs().maxCoeff());
    if (changed) {
      c.peak = reference.peak, c.touchdowns = touchdowns;
      agreement = std::max(agreement, std::abs(half.peak / reference.peak - 1));
    }
    cases->push_back(c);
  }
  Bench b{.name = name, .cases = int(cases->size())};
  b.reference =
      fmt::format("{} from our own run at {:g}; halving that moves them by {:.1e} at most",
                  changed ? "peaks, touchdown times and final positions"
                          : "peaks and touchdown times in extended precision (datasets/reference), final positions",
                  kTight, agreement);
  b.run = [cases](int i, Method method, double setting, integrate::Counters& work, Errors* errors) {
    const LandingCase& c = (*cases)[std::size_t(i)];
    SimulateOptions o = options_for(method, setting);
    std::vector<double> touchdowns;
    if (errors) o.touchdowns = &touchdowns;
    const TwoLinkLanding links(c.scene, c.sea, c.motion);
    const BodyLanding p = peak_acceleration(links.scene, links.motion, o);
    work = p.work;
    if (errors)
      *errors = {std::abs(p.peak / c.peak - 1), time_error(touchdowns, c.touchdowns),
                 (final_pose(p) - c.pose).cwiseAbs().maxCoeff()};
    return p.end != End::kFailed;
  };
  return b;
}

/// The eight shipped impact trials under Table 2; errors of the largest angle and of the angle at every sample.
Bench rig_trials(Run& run) {
  struct Data {
    identify::Rig rig;
    std::vector<identify::Trial> trials;
    std::vector<identify::PreparedTrial> prepared;
    std::vector<std::vector<double>> phi;
    SeaParameters<double> sea;
  };
  auto d = std::make_shared<Data>();
  d->rig = identify::read_rig(dataset("rigs/paper.toml"));
  std::vector<std::string> files;
  for (int i = 1; i <= 8; ++i) files.push_back(dataset(fmt::format("impact/trial_{}.csv", i)));
  d->trials = read_trials(files, {}, d->rig, {}, run).trials;
  for (const identify::Trial& t : d->trials) d->prepared.emplace_back(t);
  d->sea = read_actuator(dataset("actuators/table2.toml")).sea;
  const auto roll = [](const Data& data, int i, const identify::RolloutOptions& o, std::vector<double>& phi) {
    std::vector<double> phi_m;
    return identify::rollout(data.rig, data.sea, {}, data.prepared[std::size_t(i)], o, phi, phi_m) ==
           identify::RolloutStatus::kDone;
  };
  double agreement = 0;
  for (int i = 0; i < 8; ++i) {
    std::vector<double> phi, half;
    (void)roll(*d, i, {.accuracy = kTight, .max_steps = 1'000'000}, phi);
    (void)roll(*d, i, {.accuracy = kTight / 2, .max_steps = 1'000'000}, half);
    for (std::size_t k = 0; k < phi.size(); ++k) agreement = std::max(agreement, std::abs(phi[k] - half[k]));
    d->phi.push_back(phi);
  }
  Bench b{.name = "impact rig", .cases = 8};
  b.reference =
      fmt::format("angles from our own run at {:g}; halving that moves them by {:.1e} at most", kTight, agreement);
  b.run = [d, roll](int i, Method method, double setting, integrate::Counters& work, Errors* errors) {
    identify::RolloutOptions o{.method = method, .work = &work, .max_steps = 1'000'000};
    (fixed_step(method) ? o.max_step : o.accuracy) = setting;
    std::vector<double> phi;
    if (!roll(*d, i, o, phi)) return false;
    if (errors) {
      const std::vector<double>& truth = d->phi[std::size_t(i)];
      double largest = 0, peak = 0;
      *errors = {};
      for (std::size_t k = 0; k < phi.size(); ++k) {
        errors->state = std::max(errors->state, std::abs(phi[k] - truth[k]));
        largest = std::max(largest, std::abs(phi[k])), peak = std::max(peak, std::abs(truth[k]));
      }
      errors->peak = std::abs(largest / peak - 1);
    }
    return true;
  };
  return b;
}

std::vector<Entry> measure(const Bench& b, int repetitions, Run& run) {
  std::vector<Entry> entries;
  for (const Method m : integrate::kMethods)
    for (const double s : m == Method::kSemiImplicitEuler ? b.euler : m == Method::kRungeKutta4 ? b.rk4 : b.accuracies)
      entries.push_back({b.name, m, s, {}});
  for (Entry& e : entries)
    for (int i = 0; i < b.cases; ++i) {
      integrate::Counters work;
      Errors errors;
      if (b.run(i, e.method, e.setting, work, &errors))
        e.errors.include(errors);
      else
        ++e.failed;
      e.rhs += double(work.derivatives) / b.cases, e.events += double(work.events) / b.cases;
    }
  // Entries are timed in turn in every repetition, so that a slow phase of the machine affects all of them.
  std::vector<std::vector<double>> seconds(entries.size());
  for (int r = 0; r < repetitions; ++r) {
    for (std::size_t k = 0; k < entries.size(); ++k) {
      const Entry& e = entries[k];
      integrate::Counters work;
      const Stopwatch watch(Stopwatch::Time::kProcess);
      for (int i = 0; i < b.cases; ++i) (void)b.run(i, e.method, e.setting, work, nullptr);
      seconds[k].push_back(watch.seconds() / b.cases);
    }
    run.progress(b.name, "repetitions", r + 1, repetitions);
  }
  for (std::size_t k = 0; k < entries.size(); ++k) entries[k].seconds = median(std::move(seconds[k]));
  return entries;
}

/// The fastest method with a peak error up to 1e-6, in the first of the scenes.
FirstScreen first_screen(const std::vector<Entry>& all) {
  constexpr double kRight = 1e-6;
  const Entry* quickest = nullptr;
  long failed = 0;
  for (const Entry& e : all) {
    failed += e.failed;
    if (e.scene == all.front().scene && e.failed == 0 && e.errors.peak <= kRight &&
        (!quickest || e.seconds < quickest->seconds))
      quickest = &e;
  }
  FirstScreen out{.sentence = quickest ? fmt::format("A peak right to {:g} takes {:.0f} us with {} ({}).", kRight,
                                                     1e6 * quickest->seconds, name(quickest->method), quickest->scene)
                                       : fmt::format("No method has a peak right to {:g}.", kRight)};
  out.checks = {check(failed == 0, "followed", fmt::format("{} cases could not be", failed))};
  return out;
}

}  // namespace

int bench_integrators(const BenchArguments& a, const CommonOptions& common) {
  Run run(Outputs{"bench integrators",
                  {"integrators.csv"},
                  {"paper_peak", "paper_state", "stiff_peak", "stiff_state", "rig_peak", "rig_state"}},
          common);
  std::vector<Bench> benches;
  benches.push_back(landings("paper", 12, [](LandingCase&) { return false; }));
  benches.back().euler = {1e-3, 3e-4, 1e-4, 3e-5}, benches.back().rk4 = {4e-3, 2e-3, 1e-3, 5e-4, 2e-4};
  benches.back().accuracies = {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10};
  benches.push_back(landings("stiff", 3, [](LandingCase& c) {
    c.scene.floor = Floor<double>{2e5, 2e3, 1e2};
    c.sea.c_sea = 20, c.sea.k_sea = 1e3, c.sea.i_motor = 1e-3, c.sea.k_d = 0.02, c.sea.k_p = 5;
    return true;
  }));
  benches.back().euler = {1e-4, 3e-5, 1e-5}, benches.back().rk4 = {1e-4, 5e-5, 2e-5};
  benches.back().accuracies = {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9};
  benches.push_back(rig_trials(run));
  benches.back().euler = {1e-3, 3e-4, 1e-4, 3e-5}, benches.back().rk4 = {1e-3, 5e-4, 2.5e-4, 1e-4};
  benches.back().accuracies = {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10};

  std::vector<Entry> all;
  Report report("Integrators: error against run time");
  Json summary;
  for (const Bench& b : benches) {
    const std::vector<Entry> entries = measure(b, a.repetitions, run);
    all.insert(all.end(), entries.begin(), entries.end());
    report.heading(b.name);
    report.paragraph(fmt::format("{} cases, {} timed passes of each entry, in turn, one core. Reference: {}.", b.cases,
                                 a.repetitions, b.reference));
    report.plot(b.name + "_peak", "time a case [us]", "error of the peak", curves(entries, &Errors::peak),
                Axes::kLogarithmic);
    report.plot(b.name + "_state", "time a case [us]", "error of the final state", curves(entries, &Errors::state),
                Axes::kLogarithmic);
    run.say(""), run.say(fmt::format("{} ({})", b.name, b.reference));
    summary[b.name] = add_table(Table(kEntryQuantities, entries), report, run);
  }
  run.add("integrators.csv", Table(kEntryQuantities, all)
                                 .csv(run,
                                      "setting: the step [s] of semi_implicit_euler and rk4, else the accuracy. Errors "
                                      "are the largest over the scene's cases: peak relative, touchdown [s], state [m, "
                                      "rad]; rhs, events and time a case, the time a median."));
  report.answer(first_screen(all), run.warnings());
  report.write(run);
  return run.finish(summary, kDone);
}

}  // namespace ukemi::tools
