// The results of `ukemi calibrate` as they are written.
#pragma once

#include <optional>
#include <vector>

#include "tools/report/estimates.hpp"
#include "tools/study/calibration.hpp"

namespace ukemi::tools {

/// Drops and what became of them.
struct CalibratedDrops {
  std::vector<LoggedDrop> drops;
  Calibration result;
};

/// Writes it to the terminal, the summary and the files; returns the exit code. `validation`: of drops that were
/// not fitted.
int report(const CalibratedDrops& fitted, const std::optional<CalibratedDrops>& validation, Doubt doubt, Run& run);

}  // namespace ukemi::tools
