// The risk of a motion, as the verb hands it over and the report tells it.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "landing/body/load.hpp"
#include "landing/judge/risk.hpp"
#include "tools/report/landing.hpp"

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

/// What is told of a risk beside its numbers.
struct RiskTexts {
  std::string scene, source;  ///< names; source: of the floor's constants
  std::string motion, drops;  ///< sentences
  std::string held;           ///< the reference
  std::optional<landing::Scatter> scatter;
  bool assumed = false;
  Json of_motion;
  std::string acceleration = "|ddr_0|";  ///< of the point that counts
  bool rated = false;                    ///< the peaks are largest loads, as parts of their ratings
  PointName point = point_name;
  std::function<std::string(int)> joint = {};   ///< names of a robot of links
  std::function<landing::Load(int)> load = {};  ///< of one
  std::optional<double> kept = {};              ///< of a scene with limits: the share of drops that keeps them all
};
/// The sentence of the drops: standard deviations, and whose constants scatter how.
std::string drops_words(const landing::Scatter& scatter, bool assumed, const std::string& whose, bool uncertain,
                        double inflate, bool inexact);
/// Warns, tells and writes; returns the exit code. `worst`: the text of risk.csv, empty: none.
int report(const landing::PeakRisk& risk, const RiskTexts& texts, const std::function<std::string()>& worst, Run& run);

}  // namespace ukemi::tools
