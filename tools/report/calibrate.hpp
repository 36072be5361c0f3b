// Reports of calibrations, for the paper's robot and robots of links.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/report/estimates.hpp"
#include "tools/study/body_calibration.hpp"
#include "tools/study/contact_times.hpp"

namespace ukemi::tools {

/// A fit and its logs.
struct FitTexts {
  const FloorFit& result;
  std::vector<const landing::DropLog*> logs;
  std::vector<std::string> runs = {};  ///< files of constants NAME@1, NAME@2, ...; empty: none per file
};
/// Comments at the top of a scene file with fitted constants.
std::string scene_comments(const Run& run, const FloorFit& fit);
/// Writes a calibration and `files`; `laws` reports the contact laws that were tried. Returns the exit code.
int report(const FitTexts& fitted, const std::optional<FitTexts>& validation, Doubt doubt,
           const std::map<std::string, std::string>& files, const std::function<void(Report&, Json&)>& laws, Run& run);

/// Contact times: names of contacts, and measured stances compared with those of the rollout.
struct ContactTimes {
  std::vector<std::string> names;
  std::vector<ComparedStance> compared;
  std::vector<StanceErrors> errors;
};
/// Reports a rollout of logs with given constants. Returns the exit code.
int report_prediction(const FitTexts& played, const ContactTimes& contacts, Run& run);

/// `path`: of the scene's file; empty: no scene is written. `validation`: drops that were not fitted.
int report(const std::string& path, const BodyCalibratedDrops& fitted,
           const std::optional<BodyCalibratedDrops>& validation, Doubt doubt, Run& run);

}  // namespace ukemi::tools
