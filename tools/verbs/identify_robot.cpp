// ukemi identify, ukemi predict of a robot of links.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "common/same_numbers.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/command.hpp"
#include "tools/report/calibrate.hpp"
#include "tools/report/robot_text.hpp"
#include "tools/verbs/calibrate.hpp"
#include "tools/verbs/robot_logs.hpp"
#include "tools/verbs/runs.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// Parses --pieces: auto, seconds, or FILE[:COLUMN].
void parse_pieces(const std::string& text, RobotLogOptions& options, Run& run) {
  if (text == "auto") return void(options.cuts = RobotLogOptions::Cuts::kHops);
  const std::size_t colon = text.rfind(':');
  const std::string path = text.substr(0, colon), column = colon == std::string::npos ? "t" : text.substr(colon + 1);
  if (!std::filesystem::exists(path)) {
    if (!number_fault(text, Whole::kNo).empty())
      throw InputError("--pieces: " + quoted(text) + ": auto, seconds, or a file that is there is needed");
    options.pieces = to_number("--pieces", text);
    if (!(options.pieces > 0)) throw InputError(fmt::format("--pieces: {:g} s: above 0 is needed", options.pieces));
    return;
  }
  run.input(path);
  const CsvTable table = read_csv(path, [&](const std::string& name) { return name == column; });
  const int c = table.require(column);
  table.require_full(c);
  options.times = table.columns[std::size_t(c)];
  table.require_increasing(c, options.times);
  if (options.times.size() < 2)
    throw InputError(table.at(c, 0), "one time: at least two are needed, a piece is between two");
}

/// Sets the options of the fit. Without --nuisance every start is fitted.
void set_options(const IdentifyArguments& a, const CommonOptions& common, RobotFitOptions& o) {
  const std::vector<std::string> starts = o.terms.nuisance;
  CalibrateArguments fit;
  fit.free = a.free, fit.lower = a.lower, fit.upper = a.upper, fit.profile = a.profile;
  fit.errors = a.errors;
  fit.priors = split(a.prior);
  if (a.nuisance != "none") fit.nuisance = a.nuisance;
  if (a.nuisance.empty()) fit.nuisance = fmt::format("{}", fmt::join(starts, ","));
  tools::set_options(fit, common, o);
  o.restarts = a.starts, o.threads = common.threads;
}

/// Names and values of numbers of the robot.
std::vector<std::pair<std::string, double>> values_of(const DrivenRobot& robot, const std::vector<std::string>& names) {
  std::vector<std::pair<std::string, double>> out;
  for (const std::string& name : names) out.emplace_back(name, number_of(robot, name));
  return out;
}

int predict(const DrivenRobot& robot, const std::vector<RobotTrial>& trials, RobotFitOptions options, Run& run) {
  warn_of_doubts(robot.scene.name, robot.scene.robot_verdicts, run);
  run.info(fmt::format("predicting {} trials", trials.size()));
  const RobotFit followed = predict_robot(robot, trials, options);
  ContactTimes contacts;
  for (const ContactPoint& c : robot.scene.robot.contacts) contacts.names.push_back(c.name);
  contacts.compared = compared_stances(robot, trials, followed);
  contacts.errors = stance_errors(robot, trials, contacts.compared);
  return report_prediction({followed, logs_of(trials)}, contacts, run);
}

}  // namespace

void add_pieces(CLI::App& verb, std::string& pieces, int& tie) {
  verb.add_option(
      "--pieces", pieces,
      "with --robot: cut each log into trials: auto (where a robot on a rail pushes off), about so long [s], or at the "
      "times of FILE[:COLUMN] [whole logs]");
  verb.add_option(
          "--tie", tie,
          "with --pieces: so many that follow each other are one trial: each begins where the one before ends [1]")
      ->check(CLI::Range(1, 100'000));
}
void check_no_pieces(const std::string& pieces, int tie) {
  if (!pieces.empty()) throw InputError("--pieces: --robot is needed with it");
  if (tie != 1) throw InputError("--tie: --pieces is needed with it");
}

RobotLogOptions reading_of(const TrialArguments& a) {
  const bool one_turn = a.angles == identify::TrialOptions::Angles::kOneTurn;
  return {.angles = one_turn ? RobotLogOptions::Angles::kOneTurn : RobotLogOptions::Angles::kMultiTurn};
}

namespace {

bool same_content(const RobotTrial& a, const RobotTrial& b) {
  const auto all_same = [](const auto& x, const auto& y) { return std::ranges::equal(x, y, same_numbers); };
  const auto each_same = [&](const auto& x, const auto& y) { return std::ranges::equal(x, y, all_same); };
  return same_numbers(a.log.t, b.log.t) && all_same(a.log.output, b.log.output) &&
         each_same(a.commands->joint, b.commands->joint) && each_same(a.commands->push, b.commands->push);
}

}  // namespace

std::vector<RobotTrial> read_trials(const LogArguments& logs, RobotLogOptions reading, const DrivenRobot& robot,
                                    Run& run) {
  reading.columns = logs.columns;
  reading.tied = logs.tie;
  if (logs.tie != 1 && logs.pieces.empty()) throw InputError("--tie: --pieces is needed with it");
  if (!logs.pieces.empty()) parse_pieces(logs.pieces, reading, run);
  std::vector<RobotTrial> out;
  for (const std::string& path : logs.files) {
    run.input(path);
    for (RobotTrial& t : read_robot_trials(path, robot.scene.robot, reading)) {
      for (const std::string& note : t.notes) run.warn(path + ": " + note);
      out.push_back(std::move(t));
    }
  }
  for (const std::string& twice : duplicate_warnings(logs.files)) run.warn(twice);
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (out[i].run != out[j].run && same_content(out[i], out[j]))
        run.warn(fmt::format("{} and {} have the same content: they count twice, and errors come out too small",
                             ukemi::quoted(out[j].log.file), ukemi::quoted(out[i].log.file)));
  for (const std::string& doubt : force_doubts(robot, out)) run.warn(doubt);
  if (reading.measured == RobotLogOptions::Measured::kAngles)
    for (const std::string& still : remove_flat_columns(robot.scene.robot, out)) run.warn(still);
  return out;
}

DrivenRobot robot_of(const std::string& path, Run& run) {
  DrivenRobot out = read_driven_robot(path);
  run.input(path);
  if (!out.scene.robot_file.empty()) run.input(out.scene.robot_file);
  return out;
}

std::vector<double> logged_peaks(const std::string& path, const Texts& texts, const LogArguments& logs,
                                 const CommonOptions& common, Run& run) {
  DrivenRobot robot = read_driven_robot(path, texts);
  robot.known.reset();  // no prediction bands
  const std::vector<RobotTrial> trials = read_trials(logs, {}, robot, run);
  run.info(fmt::format("following {} trials of the logs", trials.size()));
  RobotFitOptions options;
  options.terms = robot_terms(robot, trials), options.threads = common.threads;
  const RobotFit followed = predict_robot(robot, trials, options);
  if (!followed.converged) run.warn("--log: a trial's start did not converge: " + followed.message);
  std::vector<double> out;
  for (const DropResult& d : followed.drops)
    if (std::isfinite(d.peak_between)) out.push_back(d.peak_between);
  if (out.empty()) throw InputError("--log: no trial could be followed with this robot");
  return out;
}

int identify_robot(const IdentifyArguments& a, const CommonOptions& common, Predicts predicts) {
  const bool predicting = predicts == Predicts::kYes;
  Run run(predicting ? kPredictOutputs : kIdentifyOutputs, common);
  allow_only(a.given,
             {"--robot", "--free", "--per-run", "--nuisance", "--prior", "--errors", "--lower", "--upper", "--profile",
              "--columns", "--pieces", "--tie", "--starts", "--strict", "--multi-turn", "--start-angle"},
             "--robot");
  if (predicting && a.doubt == Doubt::kFail)
    throw InputError("--strict: it has no effect with predict --robot, which tells bands and baselines and no verdict");
  const DrivenRobot robot = robot_of(a.robot, run);
  const std::vector<RobotTrial> trials =
      read_trials({a.trials, a.reading.columns, a.pieces, a.tie}, reading_of(a.reading), robot, run);
  RobotFitOptions options;
  options.terms = robot_terms(robot, trials);
  if (predicting) {
    if (!a.nuisance.empty())
      options.terms.nuisance = a.nuisance == "none" ? std::vector<std::string>{}
                                                    : named_terms(*options.terms.table, "--nuisance", a.nuisance,
                                                                  identify::Term::Role::kNuisance);
    options.threads = common.threads;
    return predict(robot, trials, options, run);
  }
  if (a.free.empty()) throw InputError("--free: with --robot the constants that are fitted must be named");
  set_options(a, common, options);
  options.monitor = run.monitor("identify", "parts");
  const std::vector<std::string> free = options.terms.free;
  (void)robot_text(a.robot, robot, values_of(robot, free), "", run.folder());  // throws where it cannot write
  fit_per_run(named_terms(*options.terms.table, "--per-run", a.per_run, identify::Term::Role::kConstant), trials,
              options);  // the file holds their means
  run.info(fmt::format("fitting {} trials", trials.size()));
  const RobotFit fit = fit_robot(robot, trials, options);
  return report({fit, logs_of(trials), a.per_run.empty() ? std::vector<std::string>{} : runs_of(trials)}, std::nullopt,
                a.doubt,
                {{"robot.toml",
                  robot_text(a.robot, fit.robot, values_of(fit.robot, free), scene_comments(run, fit), run.folder())}},
                {}, run);
}

}  // namespace ukemi::tools
