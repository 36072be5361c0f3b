// The risk of a motion of the paper's robot over drops that scatter, as its report takes it.
#pragma once

#include <optional>

#include "landing/judge/risk.hpp"

namespace ukemi::tools {

struct RiskStudy {
  landing::Scene scene;
  Actuator actuator;
  landing::Motion motion;
  std::optional<landing::Scatter> scatter;  ///< absent: the drops were measured
  bool assumed = false;                     ///< neither option nor scene gives the scatter
  landing::DropModel::Options scattering;   ///< with `scatter`: scatter of constants and execution
  landing::Risk risk;
};

}  // namespace ukemi::tools
