// The search for a robot's control program: repeated plans, each by a deadline.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "landing/model/variables.hpp"
#include "landing/run/landing.hpp"
#include "landing/scatter/measure.hpp"
#include "landing/search/goal.hpp"

namespace ukemi::landing {

class MotionSpace;

/// State measured in the air. A number out of its range, or NaN, is refused with Plan::Status::kBadInput.
struct FallState {
  double height;                         ///< clearance of the lowest contact point now, 0 to 1e4 [m]
  double forward_speed = 0;              ///< dx_0, at most 1e3 either way [m/s]
  double pitch = 0, pitch_rate = 0;      ///< of the thigh, at most 2 pi [rad] and 1e3 [rad/s] either way
  double phi = 0, rate = 0;              ///< of the joint, as the pitch [rad], [rad/s]
  double elapsed = 0;                    ///< time since release, which was at rest; 0 to 1e3 [s]
  std::optional<double> vertical_speed;  ///< dy_0, upwards, at most 1e3 either way [m/s]; absent: -g `elapsed`
};

/// The answer of a planner.
struct Plan {
  enum class Status {
    kFound,
    kNothing,     ///< nothing could be followed within the limits in the time given
    kFloorFirst,  ///< touchdown comes before the deadline: there is no time to plan
    kBadInput,    ///< a number of the drop, the fall or the deadline is out of its range; `wrong` says which
  } status = Status::kNothing;
  Motion motion{};            ///< times of its move in the air count from the call of `plan`
  SeaParameters<double> sea;  ///< the drive that plays it
  double value = kNoMotion;   ///< the goal, verified by Search::judge [m/s^2]
  long motions = 0;           ///< evaluated
  Edges edges{};              ///< edges of the search box on which the motion lies, by variable
  const char* wrong = "";     ///< with kBadInput: the number and its rule
  bool found() const { return status == Status::kFound; }
};

/// "found", "nothing", "floor_first", "bad_input".
const char* name(Plan::Status status);

/// Owns a scene, a motion space and all the memory that a search needs; `plan` allocates nothing and starts no thread.
/// Not to be called from two threads at once.
class Planner {
 public:
  struct Options {
    Goal goal = Goal::kTolerant;
    double accuracy = 1e-6;  ///< of the search
    double verified = 1e-8;  ///< of the scalar path, which verifies the answer as far as time allows
    Limits limits;           ///< that every landing must keep
    /// With Goal::kRobust: how the drop scatters about the measured one, and the measure that is minimised over its
    /// drops.
    struct UnderScatter {
      Measure measure;
      Scatter scatter = Scatter::assumed();
      int drops = 32;         ///< 1 to 4096
      double penalty = 1000;  ///< see Robust
    } under_scatter;
  };

  /// Throws InputError where `under_scatter.drops` is out of its range.
  Planner(const Scene& scene, std::shared_ptr<const MotionSpace> space, const Options& options);
  /// Over the motions of Eq. 6 with the scene's shape terms and gains. With a [release] in the scene it plans the move
  /// in the air too.
  Planner(const Scene& scene, const SeaParameters<double>& sea, const Options& options);
  Planner(const Scene& scene, const SeaParameters<double>& sea) : Planner(scene, sea, Options()) {}
  ~Planner();

  /// The best motion for a drop that can be found and verified within `deadline` seconds from the call (> 0, <= 1000;
  /// the answer comes 3 ms after it at most, however stiff the scene: landings are cut off). No worse than the best
  /// posture to hold that is known by then (Search::held), and than the last plan, or the first of `start`, for this
  /// drop. Throws nothing for bad measurements: see Plan::Status.
  [[nodiscard]] Plan plan(const Drop& drop, double deadline, std::uint64_t seed = 1);
  /// `plan` for a robot in the air, whose reference stands at `state.phi` until the deadline and can move from then
  /// on. The release stays for later calls. Throws InputError where the scene has no [release] only.
  [[nodiscard]] Plan plan(const FallState& state, double deadline, std::uint64_t seed = 1);
  /// Warm starts of the next plan, the best first, at most kStarts: values of the space's variables, as an atlas has
  /// them (the end of a move in the air from release). Each is searched for a few generations; under scatter the first
  /// alone is.
  static constexpr std::size_t kStarts = 8;
  void start(std::span<const MotionValues> values);
  void start(const MotionValues& values) { start(std::span(&values, 1)); }

 private:
  struct Search;
  std::unique_ptr<Search> search_;
};

}  // namespace ukemi::landing
