// Report of the risk of a motion over drops that scatter.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "landing/body/load.hpp"
#include "landing/judge/risk.hpp"
#include "tools/report/landing.hpp"

namespace ukemi::landing {
struct BodyRisk;
}

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

/// What the report of a risk needs besides its numbers.
struct RiskTexts {
  std::string scene, source;  ///< name; where the floor's constants come from
  std::string motion, drops;  ///< sentences
  std::string held;           ///< the held reference: "held at -45 deg"
  std::optional<landing::Scatter> scatter;
  bool assumed = false;
  Json of_motion;
  std::string acceleration = "|ddr_0|";  ///< its symbol
  PointName point = point_name;
  std::function<std::string(int)> joint = {};   ///< names of joints of a robot of links
  std::function<landing::Load(int)> load = {};  ///< loads of a robot of links
  bool limited = false;                         ///< there are limits: PeakRisk::kept
};
inline constexpr const char* kMeasuredDrops = "Drops as they were measured.";
/// How the drops scatter, in sentences; `whose` constants scatter if `uncertain`, by `inflate` times their errors.
std::string drops_words(const landing::Scatter& scatter, bool assumed, const std::string& whose, bool uncertain,
                        double inflate, bool inexact);
/// The text of risk.csv of a robot of links.
std::string worst_csv(const landing::BodyScene& scene, const landing::BodyRisk& risk, const Run& run);
/// Reports and writes a risk. Returns the exit code. `worst`: the text of risk.csv, empty: none.
int report(const landing::PeakRisk& risk, const RiskTexts& texts, const std::function<std::string()>& worst, Run& run);

}  // namespace ukemi::tools
