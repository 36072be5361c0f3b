// What a motion is worth where drops scatter, compared with constant references: held at -45 deg, and held in the
// posture that is best to hold.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/monitor.hpp"
#include "landing/scatter/drop_model.hpp"
#include "landing/scatter/measure.hpp"
#include "landing/scatter/scattered.hpp"
#include "landing/search/robust.hpp"

namespace ukemi::landing {

/// The reference that others are compared with: it holds the middle of Fig. 5's range, -45 deg.
inline constexpr Motion kHeld{-0.7853981633974483, -0.7853981633974483, 1};

/// How drops scatter: as asked for, else as the scene says, else Scatter::assumed().
Scatter scatter_for(const std::optional<Scatter>& asked, const Scene& scene);

/// A plan for drops that scatter.
struct RobustOptions {
  std::optional<Measure> measure;    ///< what is minimised; absent: the peak or the tolerant peak of the planned drop
  std::optional<Scatter> scatter;    ///< see scatter_for
  std::vector<ScatteredDrop> drops;  ///< measured ones, instead of drawn ones
  double inflate = 1;                ///< see DropModel::Options
  long samples = 256;                ///< drops that are searched on, 1 to 1,000,000
  long judging = 2048;               ///< others, that the best few are judged on; the same range
  double penalty = 1000;             ///< what a drop that breaks a limit counts [m/s^2], >= 0
  void validate() const;             ///< throws InputError
};

/// The goal of a search for such a plan, measure set (else InputError): drops drawn for the search's seed.
std::shared_ptr<const Robust> robust_goal(const DropModel& model, const RobustOptions& options, std::uint64_t seed);

struct UnderScatterOptions {
  long samples = 4096;  ///< independent drops, 1 to 10,000,000
  Measure measure;
  Limits limits;  ///< of the motion, and of what holds still
  double penalty = 1000;
  std::uint64_t seed = 1;  ///< of the drops: others than any search's
  int threads = 0;
  std::optional<Motion> nominal;  ///< another plan, over the same drops and within the same limits
  double rate = 0;                ///< rows a second of the landings that are shown [Hz]; 0: none is
  Monitor monitor;
  void validate() const;  ///< throws InputError
};

struct UnderScatter {
  Distribution planned, held, posture;
  Estimated measured;        ///< UnderScatterOptions::measure of the planned motion
  double posture_phi = 0;    ///< the best posture to hold by that measure [rad]
  double posture_value = 0;  ///< the measure of it [m/s^2]
  long broken = 0;           ///< drops in which the motion broke a limit; each counts as the penalty
  long lost = 0;             ///< in which its drive lost the joint, see LandingPeak::joint_lost
  long from_floor = 0;       ///< that would begin below the floor: they begin on it
  bool complete = false;     ///< false where it was stopped

  std::optional<Distribution> nominal;  ///< of UnderScatterOptions::nominal
  std::vector<PeakBin> histogram;       ///< of the planned motion, and of the nominal one; finite peaks alone
  std::vector<Landing> shown;           ///< of the planned motion in the first drops
  static constexpr std::size_t kShown = 10;
};

/// Plays them over the same fresh drops. A landing that cannot be followed makes what it is part of infinite.
[[nodiscard]] UnderScatter under_scatter(const DropModel& model, const MotionSpace& space, const DrivenMotion& planned,
                                         const UnderScatterOptions& options);

}  // namespace ukemi::landing
