// What calibrate does with either robot.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "landing/drops/drop_log.hpp"
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
    kScene,  ///< the scene's, others are tried
    kAsked,  ///< the law that the drops support best
    kOnly,   ///< the scene's, no other is tried
  };
  std::optional<Law> law;  ///< of a robot of links; absent: kScene
};

/// Terms of a list, at commas, by their names or aliases. Throws InputError "OPTION: ...", where one is named twice
/// too.
std::vector<std::string> named_terms(const std::vector<DropTerm>& table, const std::string& option,
                                     const std::string& list, identify::Term::Role role);
/// What the arguments say of a fit, by the names of its table of terms.
void set_options(const CalibrateArguments& arguments, const CommonOptions& common, CalibrationOptions& options);
/// Throws InputError where an option means a drop that is not there.
void check_drop_names(const CalibrateArguments& arguments);
/// What an option's items, DROP=VALUE, say of a drop.
std::optional<std::string> given(const std::string& option, const std::vector<std::string>& items,
                                 const std::string& path);
/// --height-of, --speed-of.
void set_throw(const CalibrateArguments& arguments, const std::string& path, landing::Drop& thrown);
void warn_of_log(const landing::DropLog& log, Run& run);

int calibrate_body(const CalibrateArguments& arguments, const CommonOptions& common);

}  // namespace ukemi::tools
