// calibrate, for both kinds of robot.
#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

#include "landing/drops/drop_log.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/output.hpp"
#include "tools/report/estimates.hpp"
#include "tools/study/floor_fit.hpp"

namespace ukemi::tools {

struct CalibrateArguments {
  std::vector<std::string> drops, validate, motion_of, height_of, speed_of, priors, actuators;
  std::string scene, motion, free, nuisance, lower, upper, profile, errors;
  double accuracy = 1e-9;
  Doubt doubt = Doubt::kReport;
  enum class Law {
    kScene,  ///< fit the scene's and test others
    kAsked,  ///< fit the law that the drops support best
    kOnly,   ///< fit the scene's only
  };
  std::optional<Law> law;  ///< of a robot of links; absent: kScene
};

/// Names of the terms in a comma-separated list of names or aliases. Throws InputError "OPTION: ...", also where one is
/// named twice.
std::vector<std::string> named_terms(const std::vector<DropTerm>& table, const std::string& option,
                                     const std::string& list, identify::Term::Role role);
/// Sets the options of a fit from the arguments, by the names in its table of terms.
void set_options(const CalibrateArguments& arguments, const CommonOptions& common, CalibrationOptions& options);
/// Throws InputError where an option names a drop that is not given.
void check_drop_names(const CalibrateArguments& arguments);
/// The VALUE for a drop among an option's items DROP=VALUE.
std::optional<std::string> value_of(const std::string& option, const std::vector<std::string>& items,
                                    const std::string& path);
/// Applies --height-of and --speed-of.
void set_drop(const CalibrateArguments& arguments, const std::string& path, landing::Drop& drop);
void warn_of_log(const landing::DropLog& log, Run& run);

template <class LoggedDrop>
struct GivenDrops {
  std::vector<LoggedDrop> fitted, unseen;
};
/// The drops that the arguments name, checked: each log is `read(path)`; it is thrown as the scene says, unless the
/// arguments do; its motion is `played(path, own)`, `own` the file of --motion-of.
template <class LoggedDrop, class Scene, class Read, class Played>
GivenDrops<LoggedDrop> given_drops(const CalibrateArguments& a, const Scene& scene, Run& run, Read&& read,
                                   Played&& played) {
  check_drop_names(a);
  for (const std::string& twice : duplicate_warnings(a.drops)) run.warn(twice);
  GivenDrops<LoggedDrop> out;
  for (const auto& [paths, drops] : {std::pair(&a.drops, &out.fitted), {&a.validate, &out.unseen}}) {
    for (const std::string& path : *paths) {
      run.input(path);
      const auto own = value_of("--motion-of", a.motion_of, path);
      LoggedDrop d{.log = read(path), .motion = played(path, own), .thrown = scene.drop};
      set_drop(a, path, d.thrown);
      warn_of_log(d.log, run);
      drops->push_back(std::move(d));
    }
  }
  check_drops(scene, out.fitted);
  if (!out.unseen.empty()) check_drops(scene, out.unseen);
  for (const std::string& known : overlap_warnings(a.drops, a.validate)) run.warn(known);
  run.info(fmt::format("fitting {} drops", out.fitted.size()));
  return out;
}

int calibrate_body(const CalibrateArguments& arguments, const CommonOptions& common);

}  // namespace ukemi::tools
