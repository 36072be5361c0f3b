// The search as a part of a robot's control program: an answer by a deadline, again and again.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>

#include "landing/search/auto_search.hpp"

namespace ukemi::landing {

/// What a robot measures in the air. A number beyond its range, or NaN, is refused with Plan::Status::kBadInput.
struct FallState {
  double height;                         ///< clearance of the lowest contact point now, 0 to 1e4 [m]
  double forward_speed = 0;              ///< dx_0, at most 1e3 either way [m/s]
  double pitch = 0, pitch_rate = 0;      ///< of the thigh, at most 2 pi [rad] and 1e3 [rad/s] either way
  double phi = 0, rate = 0;              ///< of the joint, as the pitch [rad], [rad/s]
  double gone = 0;                       ///< since release, which was at rest; 0 to 1e3 [s]
  std::optional<double> vertical_speed;  ///< dy_0, upwards, at most 1e3 either way [m/s]; absent: -g `gone`
};

/// What a planner answers with.
struct Plan {
  enum class Status {
    kFound,
    kNothing,     ///< nothing could be followed within the limits in the time given
    kFloorFirst,  ///< the floor comes before the deadline: there is no time to plan
    kBadInput,    ///< a number of the drop, the fall or the deadline is none that can be; `wrong` says which
  } status = Status::kNothing;
  Motion motion{};            ///< times of its move in the air count from the call of `plan`
  SeaParameters<double> sea;  ///< the drive that plays it
  double value = kNoMotion;   ///< the goal, as Search::judge finds it [m/s^2]
  long motions = 0;           ///< evaluated
  Edges edges{};              ///< of the search box that the motion lies on, by variable of the space
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
    double verified = 1e-8;  ///< of the scalar path, which judges the answer as far as the time goes
    Limits limits;           ///< what no landing may do
    /// With Goal::kRobust: how the drop scatters about what is measured, and what is minimised over how many drops of
    /// it.
    struct UnderScatter {
      Measure measure;
      Scatter scatter = Scatter::assumed();
      int drops = 32;  ///< 1 to 4096
      double penalty = Robust().penalty;
    } under_scatter;
  };

  /// Throws InputError where `under_scatter.drops` is out of its range.
  Planner(const Scene& scene, std::shared_ptr<const MotionSpace> space, const Options& options);
  /// Over the motions of Eq. 6, and what the scene lets them have beside. With a [release] in the scene it plans the
  /// move in the air too.
  Planner(const Scene& scene, const SeaParameters<double>& sea, const Options& options)
      : Planner(scene, std::make_shared<ReferenceSpace>(scene, sea), options) {}
  Planner(const Scene& scene, const SeaParameters<double>& sea) : Planner(scene, sea, Options()) {}
  Planner(const Planner&) = delete;
  Planner& operator=(const Planner&) = delete;

  /// The best motion for a drop that can be found and verified within `deadline` seconds from the call (> 0 and finite;
  /// the answer comes 3 ms after it at most, however stiff the scene: landings are cut off). No worse than the best
  /// posture to hold that is known by then, see Search::held. Whatever was measured, it throws nothing: see
  /// Plan::Status.
  [[nodiscard]] Plan plan(const Drop& drop, double deadline, std::uint64_t seed = 1);
  /// The same for a robot in the air, whose reference stands at `state.phi` until the deadline and can move from then
  /// on. The release stays for later calls. Throws InputError where the scene has no [release], whatever was measured.
  [[nodiscard]] Plan plan(const FallState& state, double deadline, std::uint64_t seed = 1);
  /// The next plan tries these motions before all others, the best first, at most kStarts: values of the space's
  /// variables, as an atlas has them (the end of a move in the air from release). Each is followed for a few
  /// generations; under scatter the first alone is.
  static constexpr std::size_t kStarts = 8;
  void start(std::span<const Coordinates> values);
  void start(const Coordinates& values) { start(std::span(&values, 1)); }

 private:
  Planner(const Scene& scene, std::shared_ptr<ReferenceSpace> space, const Options& options)
      : Planner(scene, std::shared_ptr<const MotionSpace>(space), options) {
    in_air_ = std::move(space);
  }

  void scatter();
  /// From the places of starts_, which are then spent.
  Plan search(double deadline, std::uint64_t seed);

  Scene scene_;
  std::shared_ptr<const MotionSpace> space_;
  std::shared_ptr<ReferenceSpace> in_air_;  ///< the same, where it is ours to change
  Options options_;
  std::shared_ptr<Robust> robust_;  ///< for Goal::kRobust: its drops lie about the one that is planned for
  std::vector<Drop> beside_;        ///< each drop, less the planned one
  Objective objective_;
  AutoSearch search_;
  std::optional<Coordinates> last_;          ///< the last plan in the air, its move's end counted from release
  std::array<Coordinates, kStarts> starts_;  ///< see `start`
  std::size_t given_ = 0;                    ///< of them
};

/// A landing at the accuracy that judges takes up to so many times as long as one of the search.
inline constexpr double kTightLanding = 3;
/// How much of a time budget is kept back to verify what was found, where one landing of the search takes `landing`; at
/// most 0.45 of it [s].
double verification_time(double budget, double landing);
/// Throws InputError unless it is above 0 [s].
void check_deadline(double deadline);

}  // namespace ukemi::landing
