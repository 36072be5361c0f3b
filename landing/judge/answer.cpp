#include "landing/judge/answer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/checks.hpp"
#include "common/error.hpp"
#include "common/stopwatch.hpp"

namespace ukemi::landing {

void respect_ratings(const Actuator& actuator, OptimizeOptions& o) {
  if (const std::string unknown = actuator.unknown_ratings(); !unknown.empty()) {
    std::string spring;
    if (!actuator.motor_torque_max && std::isfinite(actuator.sea.tau_max))
      spring = fmt::format("; its tau_max = {0:g} limits the spring: motor_torque_max = {0:g}, if that is the motor's",
                           actuator.sea.tau_max);
    throw InputError(fmt::format("respect-ratings: {} gives no {}: both speed_max and motor_torque_max are needed{}",
                                 quoted(actuator.name), unknown, spring));
  }
  o.limits.motor_speed = o.limits.reference_rate = *actuator.speed_max;
  o.limits.motor_torque = *actuator.motor_torque_max;
}

double Answer::held_peak() const {
  return held.end == End::kStopped ? std::numeric_limits<double>::quiet_NaN() : held.peak;
}

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// When each part has to end for the answer to be there by the deadline; without one, and until it is stopped, never.
class Timetable {
 public:
  Timetable(const Scene& scene, const Actuator& actuator, const AnswerOptions& options)
      : scene_(scene), sea_(actuator.sea), options_(options) {}

  /// With a deadline: plays a held reference, a tenth of it at most: so the time of a landing is measured.
  void begin(Answer& a) {
    if (!deadline()) return;
    constexpr double kTwoLandings = 4;  // what two take in the end, at most, of the first
    const double start = now();
    until_ = start + 0.1 * (*deadline() - start);
    a.held = play(kHeld);
    until_ = kNever;
    landing_ = kTwoLandings * (now() - start);
    begun_ = true;
  }
  /// What is left for the search [s]; at least a little, for a refusal with its reason.
  double search() const { return std::max(1e-3, *deadline() - landing_ - options_.kept_back - now()); }

  /// A landing for the report, as far as the time goes; once it is stopped, a moment.
  Landing play(const Motion& motion) {
    constexpr double kMoment = 0.1;  // [s]
    const bool leaving = options_.search.monitor.stopped();
    if (leaving)
      until_ = std::min(until_, now() + kMoment);
    else if (begun_)
      until_ = *deadline() - options_.kept_back;
    const std::function<bool()> over = [&] {
      return now() >= until_ || (!leaving && options_.search.monitor.stopped());
    };
    return simulate(scene_, sea_, motion, {.accuracy = options_.search.accuracy, .over = &over}, options_.rate);
  }

 private:
  double now() const { return options_.used + watch_.seconds(); }
  const std::optional<double>& deadline() const { return options_.search.deadline; }

  const Stopwatch watch_{Stopwatch::Time::kWall};
  const Scene& scene_;
  const SeaParameters<double>& sea_;
  const AnswerOptions& options_;
  double until_ = kNever, landing_ = 0;  // [s]
  bool begun_ = false;
};

/// Every solver with the same budget, until it is stopped; progress counts all of them together.
std::vector<Optimum> search(const Scene& scene, const SeaParameters<double>& sea, OptimizeOptions options,
                            std::vector<std::string> solvers) {
  if (solvers.empty()) solvers = {options.solver};
  const Monitor whole = options.monitor;
  const std::optional<double> deadline = options.deadline;
  const Stopwatch watch(Stopwatch::Time::kWall);
  std::vector<Optimum> out;
  for (const std::string& solver : solvers) {
    if (!out.empty() && whole.stopped()) break;
    options.solver = solver;
    if (deadline) options.deadline = std::max(1e-3, *deadline - watch.seconds()) / double(solvers.size() - out.size());
    options.monitor.on_progress = [&](long done, long total) {
      whole.progress(long(out.size()) * total + done, long(solvers.size()) * total);
    };
    out.push_back(optimize(scene, sea, options));
  }
  return out;
}

/// How the drops scatter that are planned for, or that a plan is judged by.
DropModel drops_of(Answer& a) {
  const RobustOptions& o = a.options.robust;
  if (!o.drops.empty()) return DropModel::measured(a.scene, o.drops);
  a.scatter_assumed = !o.scatter && !a.scene.scatter;
  a.scatter = scatter_for(o.scatter, a.scene);
  return {a.scene,
          *a.scatter,
          a.actuator,
          {.inflate = o.inflate, .inexact = o.measure && a.options.search.goal == Goal::kTolerant}};
}

UnderScatter judged_under_scatter(const DropModel& model, const Answer& a, const OptimizeOptions& search) {
  constexpr long kPlanned = 10'000;
  UnderScatterOptions options{.limits = search.limits,
                              .penalty = a.options.robust.penalty,
                              .seed = search.seed,
                              .threads = search.threads,
                              .monitor = a.options.evidence_monitor};
  constexpr double kShownRate = 200;  // [Hz]
  if (a.scattered) options.samples = kPlanned, options.measure = *a.options.robust.measure;
  if (a.scattered && a.options.rate > 0) options.rate = kShownRate;
  if (a.nominal) options.nominal = a.nominal->motion;
  return under_scatter(model, ReferenceSpace(a.scene, a.best.sea), {a.best.motion, a.best.sea}, options);
}

/// The best motion for the scene's own drop, which a plan for scatter is compared with; with no more motions than were
/// asked for.
std::optional<Optimum> nominal_plan(const Answer& a, const Monitor& monitor) {
  OptimizeOptions own = a.options.search;
  const long most = default_evaluations(own.goal, ReferenceSpace(a.scene, a.actuator.sea).dimension());
  own.deadline.reset();
  own.evaluations = std::min(own.evaluations.value_or(most), most);
  own.tolerance_samples = 0;
  own.monitor = {.on_progress = {}, .stop = monitor.stop};
  Optimum found = optimize(a.scene, a.actuator.sea, own);
  return found.found ? std::optional(std::move(found)) : std::nullopt;
}

/// best.value again, with its error.
Estimated promised(const Answer& a, const OptimizeOptions& search) {
  const Robust& robust = *search.robust;
  const DrivenMotion plan{a.best.motion, a.best.sea};
  ScatteredLandings landings;
  std::vector<double> peaks;
  for (const LandingPeak& l :
       landings.play({&plan, 1}, robust.judging,
                     {.accuracy = Robust::kAccuracy, .limits = search.limits, .threads = search.threads}))
    peaks.push_back(counted(l, robust.penalty));
  return estimated(robust.measure, peaks);
}

}  // namespace

Answer answer(const Scene& scene, const Actuator& actuator, const AnswerOptions& options) {
  OptimizeOptions searched = options.search;
  searched.validate(), options.robust.validate(), scene.validate(), validate(actuator);
  Answer a{.scene = scene, .actuator = actuator, .options = options};
  a.landing.end = a.held.end = End::kStopped;
  Timetable timetable(scene, actuator, options);
  timetable.begin(a);
  if (searched.deadline) searched.deadline = timetable.search();
  const DropModel drops = drops_of(a);
  a.scattered = options.robust.measure && drops.scatters();
  if (a.scattered) {
    searched.goal = Goal::kRobust, searched.search_accuracy = Robust::kAccuracy;
    searched.robust = robust_goal(drops, options.robust, searched.seed);
  }
  a.tried = search(scene, actuator.sea, searched, options.solvers);
  Optimum& best = a.best;
  best = *std::min_element(a.tried.begin(), a.tried.end(),
                           [](const Optimum& x, const Optimum& y) { return x.value < y.value; });
  if (!best.found) {
    if (searched.limits.rated() && !searched.deadline && !searched.monitor.stopped())
      a.least_breaking = least_breaking(scene, ReferenceSpace(scene, actuator.sea), searched);
    return a;
  }
  a.landing = timetable.play(best.motion);
  a.held = timetable.play(best.held->motion);
  const bool always = options.evidence == AnswerOptions::Extras::kAlways;
  if ((always || !searched.deadline) && !searched.monitor.stopped()) {
    const Stopwatch watch(Stopwatch::Time::kWall);
    a.evidence = evidence(scene, actuator.sea, best.motion,
                          {.accuracy = searched.accuracy,
                           .tolerance_samples = searched.deadline ? searched.tolerance_samples : 0,
                           .seed = searched.seed,
                           .threads = searched.threads,
                           .work = always ? kUnbounded : kCheckWork,
                           .monitor = options.evidence_monitor});
    if (a.evidence->complete) {
      a.limit = touchdown_limit(scene, actuator.sea, searched.threads);
      if (a.scattered) a.nominal = nominal_plan(a, options.evidence_monitor);
      if (drops.scatters() && !searched.monitor.stopped()) a.under_scatter = judged_under_scatter(drops, a, searched);
      if (a.under_scatter && !a.under_scatter->complete) a.under_scatter.reset(), a.nominal.reset();
      if (a.scattered) a.promised = promised(a, searched);
      if (a.scattered && a.under_scatter && !scene.release) {  // the check looks for a posture longer than the search
        const double phi = a.under_scatter->posture_phi;
        best.held = Held{{phi, phi, kHeld.duration}, a.under_scatter->posture_value};
        a.held = timetable.play(best.held->motion);
      }
      if (std::isnan(best.held->tolerant))
        best.held->tolerant = tolerant_peak(scene, actuator.sea, best.held->motion, {.accuracy = searched.accuracy}, 0,
                                            searched.seed, searched.threads)
                                  .value;
    }
    a.evidence_seconds = watch.seconds();
    if (searched.deadline && a.evidence->tolerant.complete) best.tolerant = a.evidence->tolerant;
  }
  a.tolerant_known = best.tolerant.complete || options.search.goal == Goal::kTolerant;
  if (a.played()) a.ratings = ratings(scene, actuator, best.motion, a.landing);
  a.instability = instability(scene, actuator.sea, best.motion);
  return a;
}

}  // namespace ukemi::landing
