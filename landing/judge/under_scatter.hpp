// A motion over scattered drops, compared with constant references: held at -45 deg, and held in the best posture to
// hold.
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

/// The reference for comparisons: held at the middle of Fig. 5's range, -45 deg.
inline constexpr Motion kHeld{-0.7853981633974483, -0.7853981633974483, 1};

/// The requested scatter, else the scene's, else Scatter::assumed().
Scatter scatter_for(const std::optional<Scatter>& requested, const Scene& scene);

/// A plan for drops that scatter.
struct RobustOptions {
  std::optional<Measure> measure;    ///< minimised; absent: the peak or the tolerant peak of the planned drop
  std::optional<Scatter> scatter;    ///< see scatter_for
  std::vector<ScatteredDrop> drops;  ///< measured drops instead of drawn ones
  double inflate = 1;                ///< see DropModel::Options
  long samples = 256;                ///< drops of the search, 1 to 1,000,000
  long judging = 2048;               ///< other drops, on which the best few are judged; the same range
  double penalty = 1000;             ///< value of a drop in which a limit is broken [m/s^2], >= 0
  void validate() const;             ///< throws InputError
};

/// The goal of a search for such a plan, with drops drawn for a seed. Throws InputError without a measure.
std::shared_ptr<const Robust> robust_goal(const DropModel& model, const RobustOptions& options, std::uint64_t seed);

struct UnderScatterOptions {
  long samples = 4096;  ///< independent drops, 1 to 10,000,000
  Measure measure;
  Limits limits;  ///< of the motion and of the held references
  double penalty = 1000;
  std::uint64_t seed = 1;  ///< of the drops, which differ from those of a search
  int threads = 0;
  std::optional<Motion> nominal;  ///< another plan, evaluated over the same drops within the same limits
  double rate = 0;                ///< sampling of the landings in `shown` [Hz]; 0: none
  Monitor monitor;
  void validate() const;  ///< throws InputError
};

struct UnderScatter {
  Distribution planned, held, posture;
  Estimated measured;        ///< UnderScatterOptions::measure of the planned motion
  double posture_phi = 0;    ///< the best posture to hold by that measure [rad]
  double posture_value = 0;  ///< its measure [m/s^2]
  long broken = 0;           ///< drops in which the motion broke a limit; each counts as the penalty
  long lost = 0;             ///< drops in which its drive lost the joint, see LandingPeak::joint_lost
  long from_floor = 0;       ///< drops that would begin below the floor; they begin on it
  bool complete = false;     ///< false where it was stopped

  std::optional<Distribution> nominal;  ///< of UnderScatterOptions::nominal
  std::vector<PeakBin> histogram;       ///< of the planned and the nominal motion; finite peaks only
  std::vector<Landing> shown;           ///< of the planned motion in the first drops
  static constexpr std::size_t kShown = 10;
};

/// Plays all over the same fresh drops. A landing that cannot be followed makes the values that contain it infinite.
[[nodiscard]] UnderScatter under_scatter(const DropModel& model, const MotionSpace& space, const DrivenMotion& planned,
                                         const UnderScatterOptions& options);

}  // namespace ukemi::landing
