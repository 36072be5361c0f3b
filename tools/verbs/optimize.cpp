// ukemi optimize.
#include <fmt/format.h>

#include <ctime>
#include <memory>

#include "common/error.hpp"
#include "common/files.hpp"
#include "common/stopwatch.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/plan/body_goal.hpp"
#include "landing/plan/body_least_breaking.hpp"
#include "landing/plan/body_space.hpp"
#include "landing/search/solvers.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/interrupt.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/body.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/results.hpp"
#include "tools/report/scatter.hpp"
#include "tools/verbs/body.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// Time since the program's start: processor time up to construction, then wall clock [s].
class Clock {
 public:
  Clock() : startup_(double(std::clock()) / CLOCKS_PER_SEC) {}
  double seconds() const { return startup_ + watch_.seconds(); }

 private:
  double startup_;
  Stopwatch watch_{Stopwatch::Time::kWall};
};

RobustOptions robust_of(const OptimizeArguments& a, const Scene& scene, const Actuator& actuator, Run& run) {
  const Scattering scattering = scattering_of(a.scatter, scene, actuator, run);
  RobustOptions out{.scatter = scattering.scatter, .drops = scattering.measured, .inflate = scattering.inflate};
  if (a.robust) out.measure = Measure::parse("--robust", *a.robust);
  out.samples = scattered_samples(a).value_or(out.samples);
  if (a.penalty && !a.robust) throw InputError("--penalty: of drops that scatter: --robust is needed");
  out.penalty = a.penalty.value_or(out.penalty);
  if (!(out.penalty > 0 && out.penalty <= 1e6))
    throw InputError(fmt::format("--penalty: {}: above 0 to 1e6 m/s^2 is needed", out.penalty));
  return out;
}

/// Whether results need rows of the landings.
bool draws(const OptimizeArguments& a, const CommonOptions& common) {
  return common.figures_wanted() || a.exports.has(Exports::Format::kPlotJuggler);
}

AnswerOptions options_of(const OptimizeArguments& a, const CommonOptions& common, const Actuator& actuator,
                         const Run& run) {
  const bool compare_solvers = a.solver == "compare";
  AnswerOptions out;
  OptimizeOptions& o = out.search;
  o.solver = compare_solvers ? "auto" : a.solver;
  o.goal = a.goal;
  o.evaluations = a.evaluations;
  o.deadline = a.deadline;
  o.tolerance = a.tolerance;
  o.seed = common.seed;
  o.threads = common.threads;
  for (const std::string& point : a.forbid)
    o.limits.forbidden[choice_index("--forbid", point, {kPointNames.begin(), kPointNames.end()})] = true;
  if (a.ratings == OptimizeArguments::Ratings::kRespect) respect_ratings(actuator, o);
  o.validate();
  if (compare_solvers) out.solvers = solver_names();
  out.rate = draws(a, common) ? 1000 : 0;
  out.evidence = a.evidence;
  out.evidence_monitor = run.monitor("evidence", "landings");
  return out;
}

/// Time reserved for writing the results within a deadline [s].
double writing_time(double deadline) {
  constexpr double kTexts = 0.02, kPlotShare = 0.2;  // without plots [s]; with plots, over the deadline
  return deadline < kDrawnFrom ? kTexts : std::min(1.0, kPlotShare * deadline);
}

int optimize_body(const OptimizeArguments& a, const CommonOptions& common) {
  const Stopwatch watch(Stopwatch::Time::kWall);
  Run run(kOptimizeOutputs, common);
  BodyScene scene = scene_to_plan(a, run);
  check_exports(a.exports, scene.robot);
  if (a.ratings == OptimizeArguments::Ratings::kRespect) keep_ratings(scene, run);
  const double rate = checked_rate(a.rate);
  BodyPlanOptions options = plan_options(a, common, scene, run);
  check_share(scene, a.share, "--share"), check_solver(scene, options);
  options.deadline = a.deadline;
  options.validate();
  options.rate = draws(a, common) && drawn(a.deadline) ? 1000 : 0;
  if (a.deadline) options.deadline = std::max(1e-3, *a.deadline - watch.seconds() - writing_time(*a.deadline));
  options.monitor = run.monitor("optimize", options.measure ? "landings" : "motions");
  std::vector<double> logged;
  if (!a.logs.files.empty()) {
    if (a.deadline) throw InputError("--log: not with --deadline: following a log takes its own time");
    logged = logged_peaks(a.scene, edited_texts(a), a.logs, common, run);
  }
  const std::string limit = a.deadline
                                ? fmt::format("{:g} s", *a.deadline)
                                : fmt::format("{} {}", options.evaluations.value_or(options.default_evaluations(scene)),
                                              options.measure ? "landings" : "motions");
  run.info(fmt::format("optimising the {} of {} over {} variables: {}, seed {}", goal_words(scene, options), scene.name,
                       BodySpace(scene).dimension(), limit, options.seed));
  const BodyPlan best = plan(scene, options);
  options.deadline = a.deadline;
  std::optional<BodyLeastBreaking> least;
  if (!best.found && !a.deadline && !interrupted()) least = least_breaking(scene, options);
  return report(scene, best, options, rate, a.exports, run, {.least = least, .logged = logged});
}

}  // namespace

int run_optimize(const OptimizeArguments& a, const CommonOptions& common) {
  const bool of_links = is_of_links(a.scene);
  if (!of_links) refuse_set(a.set);
  if (a.logs.files.empty() && !(a.logs.columns.empty() && a.logs.pieces.empty()))
    throw InputError((a.logs.columns.empty() ? "--pieces" : "--columns") + std::string(": --log is needed"));
  if (of_links || a.share) return optimize_body(a, common);
  if (!a.logs.files.empty()) throw InputError("--log: of robots of links: the paper's robot has no log's commands");
  const std::string file = only_actuator(a.actuators);
  const Clock clock;
  Run run(kOptimizeOutputs, common);
  Scene scene = scene_of(a.scene, a.freedom, run);
  scene.drop.height = checked_height(a.height).value_or(scene.drop.height);
  const Actuator actuator = rated_actuator_of(file, run);
  (void)checked_rate(a.rate);
  AnswerOptions options = options_of(a, common, actuator, run);
  options.robust = robust_of(a, scene, actuator, run);
  const OptimizeOptions& o = options.search;
  const Goal goal = a.robust ? Goal::kRobust : o.goal;
  const char* const unit = a.robust ? "landings" : "motions";
  const bool by_clock = o.deadline && !o.evaluations;
  options.search.monitor = run.monitor(options.solvers.empty() ? "optimize" : "solvers", by_clock ? "ms" : unit);
  const int variables = ReferenceSpace(scene, actuator.sea).dimension();
  run.info(fmt::format("optimising the {} of {} with {}: {}, seed {}", goal_words(options), scene.name, a.solver,
                       o.deadline
                           ? fmt::format("{:g} s", *o.deadline)
                           : fmt::format("{} {}", o.evaluations.value_or(default_evaluations(goal, variables)), unit),
                       o.seed));
  if (o.deadline) options.kept_back = writing_time(*o.deadline);
  options.used = clock.seconds();
  return report(answer(scene, actuator, options), a.rate, a.exports, run);
}

namespace {

/// Options for drops that scatter.
void add_robust_options(CLI::App* verb, const std::shared_ptr<OptimizeArguments>& args) {
  verb->add_option("--robust", args->robust,
                   "plan for drops that scatter: mean, cvar (the mean of the worst tenth), quantile:Q or worst; with "
                   "--objective tolerant each drop plays the motion somewhere in its execution box");
  add_scatter(*verb, args->scatter), add_drops(*verb, args->scatter);
  add_samples(*verb, args->samples);
  verb->add_option("--share", args->share,
                   "with --robust: the share of drops that keep every limit [mean 0.5; worst 1; else its level; of the "
                   "paper's scene without loads --penalty]");
  verb->add_option("--penalty", args->penalty,
                   "with --robust, what a drop that breaks --forbid, a rating or a joint stop counts [1000 m/s^2]");
}
/// Options of logs to compare the plan with.
void add_log_options(CLI::App* verb, const std::shared_ptr<OptimizeArguments>& args) {
  verb->add_option("--log", args->logs.files,
                   "of a robot of links with [command]: CSV logs of it; the plan is compared with what it did there")
      ->allow_extra_args(false);
  verb->add_option("--columns", args->logs.columns, "with --log: its columns by other names, as of identify");
  verb->add_option("--pieces", args->logs.pieces,
                   "with --log: cut it into trials, as of identify --robot [whole logs]");
}

void add_optimize(CLI::App* verb, Action& chosen) {
  auto args = std::make_shared<OptimizeArguments>();
  verb->add_option("SCENE", args->scene, "scene file (TOML)")->required();
  add_actuators(*verb, args->actuators);
  verb->add_option("--height", args->height, "drop from this height instead [m]; SCENE may be a robot of links alone");
  std::string names;
  for (const std::string& n : solver_names()) names += n + ", ";
  verb->add_option("--solver", args->solver,
                   names + "or compare: all of them, side by side, each with its part of a --deadline [auto]");
  add_set(*verb, args->set);
  add_objective(*verb, args->goal);
  verb->add_option("--evaluations", args->evaluations,
                   "how many motions are tried in all, with --robust landings [40000; tolerant 10000, of a robot of "
                   "links 5000; with n > 3 "
                   "variables 2 (n - 2) times as "
                   "many; no limit with --deadline]");
  verb->add_option("--deadline", args->deadline,
                   "time by which the answer is verified and written, from the program's start [s]");
  verb->add_flag_callback(
      "--evidence", [args] { args->evidence = AnswerOptions::Extras::kAlways; },
      "always test the motion under deviations and inside the execution box, even beyond the deadline and however long "
      "it takes");
  verb->add_option("--tolerance", args->tolerance,
                   "stop once 5000 motions in a row better the best by less than this fraction [0: never]");
  verb->add_option("--forbid", args->forbid, "points that must never touch: hip,knee,foot")->delimiter(',');
  verb->add_flag_callback(
      "--respect-ratings", [args] { args->ratings = OptimizeArguments::Ratings::kRespect; },
      "keep the reference's rate, the motor's speed and its torque within the actuator's speed_max and "
      "motor_torque_max");
  add_freedom(*verb, args->freedom);
  add_robust_options(verb, args);
  verb->add_option("--rate", args->rate, "rows of motion.csv a second [1000 Hz]");
  add_log_options(verb, args);
  add_export(*verb, args->exports, landing_exports());
  verb->add_flag_callback(
      "--details", [args] { args->lines = CommonOptions::Lines::kAll; }, "every number of the answer on stdout");
  add_action<OptimizeArguments>(*verb, args, "ukemi optimize scene.toml --actuator actuator.toml -o out", chosen,
                                [](auto& a, auto& common) {
                                  CommonOptions with = common;
                                  with.lines = a.lines;
                                  return run_optimize(a, with);
                                });
}

const Verb optimize_verb(VerbGroup::kLandings, "optimize",
                         "the knee motion with the smallest peak acceleration of the thigh (Eq. 6)", add_optimize);

}  // namespace

}  // namespace ukemi::tools
