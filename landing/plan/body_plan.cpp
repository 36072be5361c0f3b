#include "landing/plan/body_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "common/checks.hpp"
#include "common/parallel.hpp"
#include "common/stopwatch.hpp"
#include "landing/body/load.hpp"
#include "landing/plan/body_drops.hpp"
#include "landing/plan/body_objective.hpp"
#include "landing/scatter/sampler.hpp"
#include "landing/search/solvers.hpp"

namespace ukemi::landing {

long BodyPlanOptions::default_evaluations(const BodyScene& scene) const {
  const long own = measure ? 100'000 : goal == Goal::kTolerant ? 5'000 : 40'000;
  const auto driven =
      std::count_if(scene.robot.joints.begin(), scene.robot.joints.end(), [](auto& j) { return j.driven(); });
  return own + own / 2 * std::max(0L, BodySpace(scene).dimension() - 2 * driven - 1);
}

void BodyPlanOptions::validate() const {
  check_solver(solver);
  if (evaluations) check_count("evaluations", *evaluations, 1, 1'000'000'000);
  if (goal == Goal::kRobust) throw InputError("goal: kPeak or kTolerant is needed: a measure makes it robust");
  if (measure) measure->validate();
  if (share && !(measure && *share > 0 && *share <= 1))
    throw InputError(fmt::format("share: {}: above 0 to 1, beside a measure of drops that scatter, is needed", *share));
  if (scatter) scatter->validate();
  check_not_negative("inflate", inflate);
  check_count("samples", samples, 1, 4096), check_count("judging", judging, 1, 4096);
  check_count("fresh", fresh, 0, 1'000'000);
  if (deadline) check_positive("deadline", *deadline);
  SimulateOptions{.accuracy = accuracy}.validate();
}

namespace {

constexpr double kMaxReserve = 0.4;         // share of the deadline, for judging
constexpr std::size_t kFinalists = 5;       // of the best, that are judged on many drops in time
constexpr std::size_t kMaxProgress = 4096;  // improvements that are kept

/// Duration of a landing at the accuracy of a search, relative to the deadline and for all threads.
double relative_landing_time(const BodyScene& scene, const BodyMotion& motion, const BodyPlanOptions& options) {
  const Stopwatch watch(Stopwatch::Time::kWall);
  (void)peak_acceleration(scene, motion, {.accuracy = kSearchAccuracy});
  return watch.seconds() / thread_count(options.threads) / *options.deadline;
}

/// The goals of search and judging; with a deadline over as many drops as there is time for.
BodyGoals goals_in_time(const BodyScene& scene, const BodyMotion& hold, const BodyPlanOptions& options) {
  long searched = options.samples, judging = judging_drops(options);
  if (options.measure && options.deadline) {
    constexpr double kSearched = 0.5, kMotions = 150, kJudging = 0.2;  // shares of the deadline; motions in kSearched
    const double per_landing = relative_landing_time(scene, hold, options);
    const auto fit = [](long maximum, double landings) {
      const double fewest = double(std::min(8L, maximum));
      return long(std::bit_floor(std::uint64_t(std::clamp(landings, fewest, double(maximum)))));
    };
    searched = fit(searched, kSearched / (kMotions * per_landing));
    judging = fit(judging, kJudging / (double(kFinalists + 1) * per_landing));
  }
  return plan_goals(scene, options, searched, judging);
}

/// A plan under way.
class BodyPlanning {
 public:
  BodyPlanning(const BodyScene& scene, const BodyPlanOptions& options, BodyPlan& out)
      : scene_(scene), options_(options), space_(scene), out_(out) {}

  void run() {
    out_.variables = space_.variables();
    out_.hold = held_posture(scene_);
    const double before = watch_.seconds();
    out_.held = simulate(scene_, out_.hold, {.accuracy = options_.accuracy}, options_.rate);
    const double simulated = watch_.seconds() - before;
    goals_ = goals_in_time(scene_, out_.hold, options_);
    const double judged_in = judge_held();
    const auto deadline = options_.deadline.value_or(std::numeric_limits<double>::infinity());
    const double left = deadline - watch_.seconds();
    const std::size_t finalists = goal() == Goal::kRobust ? kFinalists : 1;
    const double reserve = std::min(kReserve * simulated + double(finalists) * judged_in, kMaxReserve * left);
    search(left, reserve, std::max(2 * simulated, kLeast * left));
    out_.seconds = watch_.seconds();
  }

 private:
  static constexpr double kReserve = 4;   // accurate landings for which a deadline reserves time
  static constexpr double kLeast = 0.05;  // share of the remaining time for the report on the answer

  /// What the search minimises: drops that do not scatter are one.
  Goal goal() const { return goals_.search.single() ? Goal::kPeak : options_.measure ? Goal::kRobust : options_.goal; }
  /// Judges the held posture, which is the answer where nothing is better; returns the time that it took [s].
  double judge_held() {
    const double before = watch_.seconds();
    if (no_landing(out_.held.end)) return 0;
    out_.held_value = worth(scene_, out_.held);
    if (!goals_.judge.single()) {
      const Judged held = judged(goals_.judge, out_.hold, options_);
      out_.held_value = held.value, out_.held_keeps_limits = held.keeps_limits;
    }
    if (out_.held_value < kNoMotion && out_.held_keeps_limits)
      out_.motion = out_.hold, out_.landing = out_.held, out_.value = out_.held_value, out_.found = true;
    return goals_.judge.single() ? 0 : watch_.seconds() - before;
  }

  /// Evaluations of the held posture.
  long held_cost() const { return goal() == Goal::kRobust ? 1 + long(goals_.judge.drops.size()) : 1; }

  /// Searches, and judges until `last` [s] before the end.
  void search(double left, double reserve, double last) {
    BodyObjective objective(scene_, space_, goals_,
                            {.goal = goal(),
                             .accuracy = kSearchAccuracy,
                             .threads = options_.threads,
                             .deadline = left,
                             .stop = options_.monitor.stop},
                            out_.found && goal() != Goal::kRobust ? out_.held_value : kNoMotion);
    Budget budget;
    budget.seconds = left - objective.watch.seconds() - reserve;
    const long evaluations =
        options_.evaluations.value_or(options_.deadline ? 1'000'000'000 : options_.default_evaluations(scene_));
    budget.motions = std::max(0L, evaluations - held_cost());
    std::vector<Progress> progress;
    progress.reserve(kMaxProgress);
    landing::Search search(objective, budget, options_.seed, &progress);
    search.on_progress = options_.monitor.on_progress;
    std::vector<Coordinates> starts;
    for (const BodyMotion& m : options_.starts) starts.push_back(space_.unit(m));
    search.warm_starts = starts;
    if (!starts.empty()) {  // the answer is no worse than the first
      Candidate first{starts[0]};
      search.evaluate({&first, 1});
    }
    run_solver(options_.solver, search);
    // A descent by derivatives counts as many at once.
    out_.evaluations = std::min(evaluations, held_cost() + std::min(search.spent(), budget.motions));
    const Candidate best = search.judge(options_.accuracy, left - last);
    for (const Progress& p : progress)
      out_.progress.push_back({held_cost() + (goal() == Goal::kRobust ? p.landings : p.motions), p.seconds, p.value});
    if (best.value < kNoMotion) accept_if_better(best);
    say_why();
  }
  void accept_if_better(const Candidate& p) {
    if (out_.found && !(p.value < out_.value)) return;
    const BodyMotion motion = space_.motion(p.u);
    const BodyLanding l = simulate(scene_, motion, {.accuracy = options_.accuracy}, options_.rate);
    double value = p.value;
    if (goals_.judge.single())
      value = worth(scene_, l);
    else if (goal() != Goal::kRobust && !options_.deadline)  // at the accuracy of the answer alone
      value = judged(goals_.judge, motion, options_).value;
    if (no_landing(l.end) || (out_.found && !(value < out_.value))) return;
    out_.motion = motion, out_.landing = l, out_.value = value, out_.found = true;
    out_.edges = p.u == space_.held(p.u) ? Edges{} : space_.edges(p.u);  // a posture lies on no edge of the duration
  }
  /// Why nothing was found, or why the search ended early.
  void say_why() {
    if (out_.found) {
      if (options_.monitor.stopped()) out_.message = "interrupted: the best so far";
      return;
    }
    out_.value = out_.landing.peak = std::numeric_limits<double>::quiet_NaN();
    out_.message = out_.held.end == End::kNoContact ? "no contact touches the floor: there is no landing to plan"
                   : scene_.limited()               ? "no motion was found that keeps the limits" + held_breaks()
                                                    : "no motion could be followed to the floor";
  }
  /// The first limit that the held posture breaks, for the message.
  std::string held_breaks() const {
    const BrokenLimit& b = out_.held.broken;
    if (!b) return "";
    return fmt::format("; holding breaks them after {:.3g} s: {}", b.t, scene_.loads[std::size_t(b.load)].name);
  }

  const BodyScene& scene_;
  const BodyPlanOptions& options_;
  const BodySpace space_;
  BodyPlan& out_;
  BodyGoals goals_;
  Stopwatch watch_{Stopwatch::Time::kWall};
};

/// Of a deadline, for the fresh drops that estimate the share of those that keep the limits.
constexpr double kFreshShare = 0.1;

/// A plan and the held posture over drops that were not used in the search; with a deadline over as many as there is
/// time for, absent where there is none.
std::optional<BodyUnderScatter> evaluate_on_fresh(const BodyScene& scene, const BodyPlan& plan,
                                                  const BodyPlanOptions& options, const Stopwatch& watch) {
  constexpr std::size_t kChunk = 128;  // drops between two checks of the clock
  const bool drawn = !options.measured;
  BodyUnderScatter out{.scatter = drawn ? std::optional(scatter_for(options.scatter, scene)) : std::nullopt,
                       .assumed = drawn && !options.scatter && !scene.scatter};
  const BodyDropModel model = drop_model(scene, options);
  if (!model.scatters()) return std::nullopt;
  const std::vector<BodyDrop> drops = model.independent(options.fresh, fresh_seed(options.seed));
  const std::function<bool()> past_deadline = [&] { return options.deadline && watch.seconds() > *options.deadline; };
  std::vector<double> planned, held;
  const std::size_t chunk = options.deadline ? kChunk : drops.size();
  for (std::size_t first = 0; first < drops.size(); first += chunk) {
    const auto next = std::span(drops).subspan(first, std::min(chunk, drops.size() - first));
    const PeaksOver of_plan = peaks_over(next, plan.motion, kSearchAccuracy, options.threads, &past_deadline),
                    of_held = peaks_over(next, plan.hold, kSearchAccuracy, options.threads, &past_deadline);
    if (past_deadline()) break;
    planned.insert(planned.end(), of_plan.peaks.begin(), of_plan.peaks.end());
    held.insert(held.end(), of_held.peaks.begin(), of_held.peaks.end());
    out.broken += of_plan.broken;
    out.exceeded.resize(std::max(out.exceeded.size(), of_plan.exceeded.size()));
    for (std::size_t i = 0; i < of_plan.exceeded.size(); ++i) out.exceeded[i] += of_plan.exceeded[i];
    out.from_floor += std::count_if(next.begin(), next.end(), [](auto& d) { return d.from_floor; });
  }
  if (planned.empty()) return std::nullopt;
  out.planned = distribution(planned), out.held = distribution(held);
  out.measured = estimated(options.measure.value_or(Measure{}), planned);
  return out;
}

}  // namespace

BodyPlan plan(const BodyScene& scene, const BodyPlanOptions& options) {
  scene.validate(), options.validate(), check_share(scene, options.share), check_solver(scene, options);
  const Stopwatch watch(Stopwatch::Time::kWall);
  const bool reports = options.fresh > 0 && (!options.deadline || options.share);
  BodyPlanOptions search = options;
  if (reports && search.deadline) *search.deadline *= 1 - kFreshShare;
  BodyPlan out;
  BodyPlanning(scene, search, out).run();
  if (reports && out.found && !options.monitor.stopped()) out.under = evaluate_on_fresh(scene, out, options, watch);
  return out;
}

}  // namespace ukemi::landing
