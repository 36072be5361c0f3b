// Calibration of the paper's robot: K_f, C_fy, C_fx and the pitch from logs of drops (floor_fit.hpp), with exact
// derivatives through the touchdowns (landing/drops/drop_rollout.hpp).
//
// No printing, no files: tools/verbs/calibrate.cpp is the verb. Tests: test/regression/calibrate.cpp.
#pragma once

#include <vector>

#include "landing/model/scene.hpp"
#include "tools/study/floor_fit.hpp"

namespace ukemi::tools {

using LoggedDrop = LoggedDropOf<landing::Motion>;

struct Calibration : FloorFit {
  landing::Scene scene;  ///< the given one with the fitted constants, their covariance and verdicts
};

/// Drops and their calibration.
struct CalibratedDrops {
  std::vector<LoggedDrop> drops;
  Calibration result;
};

/// Throws InputError where the scene has no floor or no contacts, and as check_logs does.
void check_drops(const landing::Scene& scene, const std::vector<LoggedDrop>& drops);

/// Fits the constants of `scene` to the drops, see fit_floor. Throws InputError as check_drops does.
[[nodiscard]] Calibration calibrate(const landing::Scene& scene, const SeaParameters<double>& sea,
                                    const std::vector<LoggedDrop>& drops, const CalibrationOptions& options = {});

/// Simulates the drops with the scene's constants, see validate_floor.
[[nodiscard]] Calibration validate(const landing::Scene& scene, const SeaParameters<double>& sea,
                                   const std::vector<LoggedDrop>& drops, const CalibrationOptions& options = {});

}  // namespace ukemi::tools
