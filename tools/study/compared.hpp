// Comparison of two sets of constants, nominal and identified, for any robot: their differences, and each set's best
// motion landed under both.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/actuator.hpp"

namespace ukemi::tools {

inline constexpr std::array<const char*, 2> kSets = {"nominal", "identified"};
template <class T>
using PerSet = std::array<T, 2>;  ///< one of each of kSets

struct ConstantDifference {
  std::string name, unit;
  PerSet<double> value;
  std::optional<double> std;  ///< standard error of the identified one

  double difference() const { return value[1] - value[0]; }
  std::optional<double> percent() const {  ///< of the nominal value; absent where that is 0
    return value[0] != 0 ? std::optional(100 * difference() / value[0]) : std::nullopt;
  }
  std::optional<double> z() const;     ///< difference in standard errors
  std::optional<bool> inside() const;  ///< whether the nominal value lies in the identified one's 95 % interval
};
/// The five constants of an actuator in both sets, then the others that differ; `suffix` is appended to their names.
std::vector<ConstantDifference> differences(const PerSet<Actuator>& sets, const std::string& suffix = "");

/// A set's best motion, landed under both sets.
template <class Best, class Landed>
struct ComparedMotionOf {
  std::string set;                         ///< the one that it is the best for
  Best best;                               ///< with its `motion`, `found` and `message`
  PerSet<std::optional<Landed>> landings;  ///< absent where stopped earlier
};

/// A plan for drops that scatter, and its peaks if the identified constants are true.
template <class Best, class Truth>
struct ComparedPlanOf {
  std::string set;  ///< see planned_with
  Best best;
  Truth truth;
};

/// Names of the plans for scatter: "nominal", "identified", "identified, with its covariance".
inline std::string planned_with(std::size_t plan) {
  return plan == 2 ? "identified, with its covariance" : kSets[plan];
}

/// Whether all four landings were simulated.
template <class Motion>
bool all_landed(const std::vector<Motion>& motions) {
  return motions.size() == 2 && motions[1].landings[1];
}

/// Appends the best motion of each set, `search(set)`, then lands each under both sets, `land(set, motion)`; false
/// where one could not be found or simulated, or `stopped()`.
template <class Motion, class Search, class Land, class Stopped>
bool compare_motions(std::vector<Motion>& motions, Search&& search, Land&& land, Stopped&& stopped) {
  for (std::size_t s = 0; s < 2; ++s) {
    motions.push_back({kSets[s], search(s), {}});
    if (!motions.back().best.found || stopped()) return false;
  }
  bool landed = true;
  for (Motion& m : motions)
    for (std::size_t s = 0; s < 2; ++s) {
      auto landing = land(s, m.best.motion);
      if (stopped()) return false;
      landed = landed && !no_landing(landing.end);
      m.landings[s] = std::move(landing);
    }
  return landed;
}

}  // namespace ukemi::tools
