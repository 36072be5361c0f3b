// The risk of a motion, as the verb hands it over and the report tells it.
#pragma once

#include <optional>

#include "landing/judge/risk.hpp"

namespace ukemi::tools {

struct RiskStudy {
  landing::Scene scene;
  Actuator actuator;
  landing::Motion motion;
  std::optional<landing::Scatter> scatter;  ///< none: the drops were measured
  bool assumed = false;                     ///< nobody said what the scatter is
  landing::DropModel::Options scattering;   ///< with `scatter`: of the constants and the execution
  landing::Risk risk;
};

}  // namespace ukemi::tools
