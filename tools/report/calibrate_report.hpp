// What `ukemi calibrate` writes of a calibration.
#pragma once

#include <string>
#include <vector>

#include "tools/study/calibration.hpp"
#include "tools/report/estimates.hpp"

namespace ukemi::tools {

/// Value, standard error and unit; an angle in degrees too.
std::string words(const identify::Estimate& estimate);
/// The drops sample by sample: fit.csv, validation.csv.
std::string samples_csv(const Run& run, const std::vector<LoggedDrop>& drops, const std::vector<DropResult>& results);

/// "drops", "outputs" and "nuisance" of summary.json.
Json drops_json(const Calibration& calibration);
Json outputs_json(const Calibration& calibration);
Json nuisance_json(const Calibration& calibration);

/// A line a drop, for a reader.
void say_drops(const Run& run, const Calibration& calibration);
/// The scene with the fitted constants.
std::string scene_toml(const Run& run, const Calibration& calibration);
std::string calibration_html(const Run& run, const std::vector<LoggedDrop>& drops, const Calibration& calibration,
                             const std::vector<LoggedDrop>& unseen, const Calibration* validation);

}  // namespace ukemi::tools
