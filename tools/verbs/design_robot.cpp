// ukemi design of a robot of links.
#include <fmt/format.h>

#include "common/error.hpp"
#include "tools/program/command.hpp"
#include "tools/report/design.hpp"
#include "tools/verbs/calibrate.hpp"
#include "tools/verbs/design.hpp"
#include "tools/verbs/robot_logs.hpp"

namespace ukemi::tools {

int design_robot(const DesignArguments& a, const CommonOptions& common) {
  Run run(kDesignOutputs, common);
  allow_only(a.given,
             {"--robot", "--next", "--free", "--hits", "--criterion", "--noise", "--heights", "--columns", "--pieces",
              "--tie", "--multi-turn"},
             "--robot");
  if (a.next.empty()) throw InputError("--next: with --robot logs of commands to choose from are needed");
  if (a.free.empty()) throw InputError("--free: with --robot the constants that are to be known must be named");
  const DrivenRobot robot = robot_of(a.robot, run);
  RobotLogOptions reading = reading_of(a.reading);
  const std::vector<RobotTrial> in_hand =
      read_trials({a.trials, a.reading.columns, a.pieces, a.tie}, reading, robot, run);
  reading.measured = RobotLogOptions::Measured::kNothing;
  std::vector<double> heights;
  for (const std::string& height : split(a.heights)) heights.push_back(to_number("--heights", height));
  const std::vector<RobotTrial> next =
      from_heights(robot, read_trials({.files = a.next, .columns = {}, .pieces = {}}, reading, robot, run), heights);

  RobotDesignOptions options{.criterion = a.criterion, .trials = a.hits};
  for (const std::string& item : split(a.noise)) {
    const Assignment one = assignment("--noise", item, "CHANNEL=STD");
    set_once("--noise", one.name, one.name, to_number("--noise", one.value), options.noise);
  }
  options.fit.terms = design_terms(robot, in_hand, next, options.noise);
  CalibrateArguments fit;
  fit.free = a.free, fit.nuisance = fmt::format("{}", fmt::join(options.fit.terms.nuisance, ","));
  set_options(fit, common, options.fit);
  options.fit.threads = common.threads;
  return report(design_trials(robot, in_hand, next, options), run);
}

}  // namespace ukemi::tools
