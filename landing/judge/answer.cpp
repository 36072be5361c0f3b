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

/// The time at which each part must end for the answer by the deadline; without a deadline never, until a stop.
class Timetable {
 public:
  Timetable(const Scene& scene, const Actuator& actuator, const AnswerOptions& options)
      : scene_(scene), sea_(actuator.sea), options_(options) {}

  /// With a deadline: plays a held reference, for a tenth of it at most, to measure the time of a landing.
  void begin(Answer& a) {
    if (!deadline()) return;
    constexpr double kTwoLandings = 4;  // time of the two final landings relative to the first, at most
    const double start = now();
    end_ = start + 0.1 * (*deadline() - start);
    a.held = play(kHeld);
    end_ = kNever;
    landing_time_ = kTwoLandings * (now() - start);
    measured_ = true;
  }
  /// The time left for the search [s]; at least 1 ms, for a message.
  double search_time() const { return std::max(1e-3, *deadline() - landing_time_ - options_.kept_back - now()); }

  /// A landing for the report, until the deadline; after a stop for kMoment.
  Landing play(const Motion& motion) {
    constexpr double kMoment = 0.1;  // [s]
    const bool stopping = options_.search.monitor.stopped();
    if (stopping)
      end_ = std::min(end_, now() + kMoment);
    else if (measured_)
      end_ = *deadline() - options_.kept_back;
    const std::function<bool()> over = [&] {
      return now() >= end_ || (!stopping && options_.search.monitor.stopped());
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
  double end_ = kNever, landing_time_ = 0;  // [s]
  bool measured_ = false;
};

/// Every solver with the same budget, until a stop; the progress is that of all.
std::vector<Optimum> search(const Scene& scene, const SeaParameters<double>& sea, OptimizeOptions options,
                            std::vector<std::string> solvers) {
  if (solvers.empty()) solvers = {options.solver};
  const Monitor total_monitor = options.monitor;
  const std::optional<double> deadline = options.deadline;
  const Stopwatch watch(Stopwatch::Time::kWall);
  std::vector<Optimum> out;
  for (const std::string& solver : solvers) {
    if (!out.empty() && total_monitor.stopped()) break;
    options.solver = solver;
    if (deadline) options.deadline = std::max(1e-3, *deadline - watch.seconds()) / double(solvers.size() - out.size());
    options.monitor.on_progress = [&](long done, long total) {
      total_monitor.progress(long(out.size()) * total + done, long(solvers.size()) * total);
    };
    out.push_back(optimize(scene, sea, options));
  }
  return out;
}

/// The model of the drops that are planned for, or over which a plan is evaluated.
DropModel drop_model_of(Answer& a) {
  const RobustOptions& o = a.options.robust;
  if (!o.drops.empty()) return DropModel::measured(a.scene, o.drops);
  a.scatter_assumed = !o.scatter && !a.scene.scatter;
  a.scatter = scatter_for(o.scatter, a.scene);
  return {a.scene,
          *a.scatter,
          a.actuator,
          {.inflate = o.inflate, .inexact = o.measure && a.options.search.goal == Goal::kTolerant}};
}

UnderScatter evaluate_under_scatter(const DropModel& model, const Answer& a, const OptimizeOptions& search) {
  constexpr long kDrops = 10'000;
  UnderScatterOptions options{.limits = search.limits,
                              .penalty = a.options.robust.penalty,
                              .seed = search.seed,
                              .threads = search.threads,
                              .monitor = a.options.evidence_monitor};
  constexpr double kShownRate = 200;  // [Hz]
  if (a.scattered) options.samples = kDrops, options.measure = *a.options.robust.measure;
  if (a.scattered && a.options.rate > 0) options.rate = kShownRate;
  if (a.nominal) options.nominal = a.nominal->motion;
  return under_scatter(model, ReferenceSpace(a.scene, a.best.sea), {a.best.motion, a.best.sea}, options);
}

/// The best motion for the scene's own drop, for comparison with a plan for scatter; with no more motions than
/// requested.
std::optional<Optimum> nominal_plan(const Answer& a, const Monitor& monitor) {
  OptimizeOptions search = a.options.search;
  const long maximum = default_evaluations(search.goal, ReferenceSpace(a.scene, a.actuator.sea).dimension());
  search.deadline.reset();
  search.evaluations = std::min(search.evaluations.value_or(maximum), maximum);
  search.tolerance_samples = 0;
  search.monitor = {.on_progress = {}, .stop = monitor.stop};
  Optimum found = optimize(a.scene, a.actuator.sea, search);
  return found.found ? std::optional(std::move(found)) : std::nullopt;
}

/// best.value with its error.
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
  if (searched.deadline) searched.deadline = timetable.search_time();
  const DropModel drops = drop_model_of(a);
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
      if (drops.scatters() && !searched.monitor.stopped()) a.under_scatter = evaluate_under_scatter(drops, a, searched);
      if (a.under_scatter && !a.under_scatter->complete) a.under_scatter.reset(), a.nominal.reset();
      if (a.scattered) a.promised = promised(a, searched);
      if (a.scattered && a.under_scatter && !scene.release) {  // under_scatter searches postures more finely
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
