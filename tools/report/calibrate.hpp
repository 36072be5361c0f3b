// Calibrations as they are told, whatever fell.
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

/// A fit, and the logs that it is of.
struct FitTexts {
  const FloorFit& result;
  std::vector<const landing::DropLog*> logs;
  std::vector<std::string> runs = {};  ///< the files that constants NAME@1, NAME@2, ... are of; empty: there are none
};
/// What stands above a scene with fitted constants.
std::string scene_comments(const Run& run, const FloorFit& fit);
/// The whole of a calibration; `files` hold its scene, `laws` tells those that were tried. Returns the exit code.
int report(const FitTexts& fitted, const std::optional<FitTexts>& validation, Doubt doubt,
           const std::map<std::string, std::string>& files, const std::function<void(Report&, Json&)>& laws, Run& run);

/// When contacts touch: their names, and measured stances beside those of the rollout.
struct ContactTimes {
  std::vector<std::string> names;
  std::vector<ComparedStance> compared;
  std::vector<StanceErrors> errors;
};
/// Logs played with given constants.
int report_prediction(const FitTexts& played, const ContactTimes& contacts, Run& run);

/// `path`: the scene's file; empty: there is none, and none is written. `validation`: of drops that were not fitted.
int report(const std::string& path, const BodyCalibratedDrops& fitted,
           const std::optional<BodyCalibratedDrops>& validation, Doubt doubt, Run& run);

}  // namespace ukemi::tools
