// calibrate, for both kinds of robot.
#pragma once

#include <optional>
#include <string>
#include <vector>

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

}  // namespace ukemi::tools
