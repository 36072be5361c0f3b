// Risk of a motion over scattered drops: the distribution of its peak, compared with the held reference, the contact
// of the peak, touches and exceeded limits, and the uncertainty that matters most.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/actuator.hpp"
#include "common/monitor.hpp"
#include "landing/judge/sobol_indices.hpp"
#include "landing/run/landing.hpp"
#include "landing/scatter/drop_model.hpp"
#include "landing/scatter/measure.hpp"

namespace ukemi::landing {

struct RiskOptions {
  long samples = 10'000;                  ///< number of drawn drops: scrambled Sobol points; 1 to 10,000,000
  std::vector<ScatteredDrop> measured;    ///< played instead of drawn ones, if not empty
  std::array<bool, kPoints> forbidden{};  ///< points whose touches are counted
  std::uint64_t seed = 1;
  int threads = 0;        ///< 0: all cores; without influence on the results
  Monitor monitor;        ///< progress in landings; a result that it stops covers the drops played until then
  void validate() const;  ///< throws InputError
};

/// Number of drops in which an event occurs.
struct RiskEvent {
  /// Of a forbidden point; beyond speed_max; beyond motor_torque_max; out of the joint's stops; a load beyond its
  /// rating.
  enum class Kind { kTouch, kSpeed, kTorque, kStops, kLoad } kind;
  int point = -1, joint = -1;  ///< of a touch; of a robot of links the joint of a rating or of stops
  int load = -1;               ///< of a robot of links: the load that exceeds its rating
  double limit = 0;            ///< with kSpeed [rad/s], kTorque [Nm] and kLoad
  long drops = 0;
};

/// Number of drops with their peak in one contact.
struct PeakContact {
  int number;  ///< of the touchdown that opened it, from 1, without chatter; 0: the peak came before the first
  int point;   ///< Point; -1: before the first touchdown
  long drops = 0;
};

/// Risk of a motion of any kind of robot.
struct PeakRisk {
  /// A group of numbers that scatter, see Sampler::groups.
  struct Uncertainty {
    std::string name;
    SobolIndex index;
  };

  Distribution peaks, held;          ///< of the motion; of the held reference over the same drops (drawn: kHeldDrops)
  long failed = 0, held_failed = 0;  ///< landings that could not be followed to the floor; excluded
  long lost = 0, held_lost = 0;      ///< of the others, those whose drive lost the joint: LandingPeak::joint_lost
  long from_floor = 0;               ///< drops that would begin below the floor; they begin on it
  long broken = 0;  ///< of those followed, in which a limit breaks: forbidden touch, joint's stops, load with `limit`
  std::vector<PeakContact> contacts;       ///< most drops first
  std::vector<RiskEvent> events;           ///< of the drops that were followed
  std::vector<PeakBin> histogram;          ///< of the motion, and of the held reference
  std::vector<Uncertainty> uncertainties;  ///< the largest total index first; empty: see `why_none`
  enum class WhyNone { kThere, kMeasured, kNothingScatters, kOneGroup, kStopped } why_none = WhyNone::kThere;
  long index_landings = 0, index_failed = 0;  ///< landings of the indices; of these not followed
  /// Maximum number of drawn drops for the held reference: enough for its tail to 1 %.
  static constexpr long kHeldDrops = 16'384;
  /// Share of the followed drops that keep every limit; NaN: none was followed.
  double kept() const { return 1 - double(broken) / double(peaks.samples); }
};

struct RiskyDrop {
  ScatteredDrop drop;
  double peak;  ///< [m/s^2]
};

/// The held reference is kHeld.
struct Risk : PeakRisk {
  std::vector<RiskyDrop> worst;  ///< at most kWorst, the worst first
  static constexpr int kWorst = 100;
};

/// Plays a motion over the drops of a model, or over measured ones, in lanes; peaks are accurate to 1e-3. The indices
/// take about as many landings again. Same inputs and seed, same results.
[[nodiscard]] Risk risk(const DropModel& model, const Actuator& actuator, const Motion& motion,
                        const RiskOptions& options = {});

}  // namespace ukemi::landing
