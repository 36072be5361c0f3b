// The objective of a search: peak, tolerant peak or measure under scatter over a motion space, evaluated in batches.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <span>

#include "common/stopwatch.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/model/motion_space.hpp"
#include "landing/run/work.hpp"
#include "landing/scatter/scattered.hpp"
#include "landing/search/goal.hpp"
#include "landing/search/robust.hpp"
#include "landing/search/tolerant_peak.hpp"

namespace ukemi::landing {

/// How a value is computed: its goal, and under scatter the number of drops, the first ones.
struct Fidelity {
  static constexpr std::size_t kAllDrops = std::numeric_limits<std::size_t>::max();
  Goal goal = Goal::kPeak;
  std::size_t drops = kAllDrops;

  Fidelity() = default;
  Fidelity(Goal g, std::size_t d = kAllDrops) : goal(g), drops(d) {}
};

/// Under scatter, the number of stages after each of which a motion may be abandoned.
inline constexpr std::size_t kScatteredStages = 3;

/// A point of the motion space as the solvers carry it.
struct Candidate {
  Coordinates u;             ///< its place in the unit cube
  double value = kNoMotion;  ///< [m/s^2]; above `bound` only a lower bound of the value
  double bound = kNoMotion;  ///< landings are abandoned above it [m/s^2]
  /// Under scatter: values after each stage (0: not known); before evaluation those of the motion that gave the bound.
  std::array<double, kScatteredStages> stage_values{};
  int worst = -1;  ///< point of the execution box that gave the value; it is played first next time; -1: not known
  int played = 0, broken = 0;  ///< under scatter: drops of the value, and of these the ones that broke a limit
  int first_contact = -1;      ///< of a robot of links: the contact that touches first in the first drop
  bool operator<(const Candidate& o) const { return value < o.value; }
};

class Objective {
 public:
  struct Options {
    Goal goal = Goal::kPeak;
    double accuracy = 1e-6;  ///< see BatchOptions
    /// Limits that every landing of the execution box must keep; the scene's joint stops are added. A motion whose
    /// reference is too fast is refused without a landing.
    Limits limits;
    int threads = 1;                                            ///< 0: all cores; without influence on the results
    Stopwatch::Time time = Stopwatch::Time::kWall;              ///< the clock of deadlines
    double deadline = std::numeric_limits<double>::infinity();  ///< from construction, which plays a landing [s]
    std::function<bool()> stop;                                 ///< see Objective::stop
    std::shared_ptr<const Robust> robust;                       ///< for Goal::kRobust
  };

  /// Both must outlive the objective; the scene's drop may change between calls.
  Objective(const Scene& scene, const MotionSpace& space, const Options& options);
  /// Over the motions of Eq. 6.
  Objective(const Scene& scene, const SeaParameters<double>& sea, const Options& options);

  const MotionSpace& space() const { return space_; }
  /// The motion and drive of a candidate.
  DrivenMotion play(const Candidate& c) const { return space_.play(space_.values(c.u)); }
  Objective(const Objective&) = delete;
  /// Values of many motions. On one thread it allocates nothing. Where it is interrupted, motions that are not finished
  /// get kNoMotion. Drops are played in stages; a motion that can no longer reach its bound gets its value over the
  /// drops played so far, raised above the bound.
  void evaluate(std::span<Candidate> points, Fidelity fidelity);
  /// Whether values of that fidelity are those of the goal.
  bool exact(Fidelity fidelity) const {
    return fidelity.goal == options_.goal &&
           (fidelity.goal != Goal::kRobust || fidelity.drops >= options_.robust->drops.size());
  }
  /// Values over the judging drops; interrupted as above.
  void evaluate_judging(std::span<Candidate> points);
  /// Under scatter: reserves memory, so that up to `motions` at once are evaluated without allocation.
  void reserve_scattered(std::size_t motions);
  /// Under scatter: whether a motion kept the limits in Measure::share of the drops when it was last evaluated. Drops
  /// that were not played count as broken, up to the size of the smaller set (searched on, or judging).
  bool keeps_limits(const Candidate& p) const;
  double deadline;  ///< on `watch` [s]
  Stopwatch watch;
  std::function<bool()> stop;  ///< if set, called often and from any thread; true interrupts
  /// The value of one motion in the scalar path, limits included; of what was played where it is interrupted, 0 where
  /// nothing was. With a deadline, a landing of very many steps counts as one that cannot be followed.
  double verified(const DrivenMotion& play, double accuracy, double bound = kNoMotion);

  double accuracy() const { return options_.accuracy; }
  void set_accuracy(double accuracy) { options_.accuracy = accuracy; }
  const Options& options() const { return options_; }
  /// Maximum number of landings a motion: the points of its execution box, for the value or to check the limits; a
  /// motion that is only screened by its peak is checked at the exact motion alone.
  int landings_per_motion(Goal goal) const {
    if (goal == Goal::kRobust) return int(options_.robust->drops.size());
    return goal == Goal::kTolerant || (goal == options_.goal && limited_) ? kExecutionPoints : 1;
  }
  /// Whether the peak of point k of the execution box enters the value; else it only checks the limits.
  static bool in_value(int k, Goal goal) { return k == 0 || goal == Goal::kTolerant; }
  const Scene& scene() const { return scene_; }
  long motions() const { return motions_; }    ///< evaluated
  long landings() const { return landings_; }  ///< played for them, abandoned ones included
  long flights() const { return flights_; }    ///< of these, those that never touched the floor

  long work() const { return work_; }  ///< of all landings, see work_of
  /// Limits the work from now on.
  void limit_work(long work) { max_work_ = work < kUnbounded - work_ ? work_ + work : kUnbounded; }
  /// Adds the work of landings that were played elsewhere for the search.
  void add_work(long work) { work_ += work; }
  bool exhausted() const { return work_ >= max_work_; }
  /// From now on the deadline is ignored until so much processor time is used, however busy the machine is [s].
  void set_grace(double seconds) { grace_ = seconds, cpu_watch_.restart(); }
  /// True once the deadline has passed, the work is exhausted or `stop` says so: landings are cut off.
  bool interrupted() const {
    const bool passed = std::isfinite(deadline) && watch.seconds() >= deadline && cpu_watch_.seconds() >= grace_;
    return exhausted() || passed || (stop && stop());
  }
  /// interrupted() in the form of SimulateOptions::over.
  const std::function<bool()>* over() const { return &over_; }
  /// Duration of the landing at the centre of the box at the accuracy of the search [s].
  double landing_time() const { return landing_time_; }

 private:
  class Race;
  Objective(const Scene& scene, std::unique_ptr<const MotionSpace> owned, const Options& options);
  std::unique_ptr<const MotionSpace> owned_;
  const Scene& scene_;
  const MotionSpace& space_;
  Options options_;
  bool too_fast(const DrivenMotion& play) const;
  void evaluate_boxes(std::span<Candidate> points, Goal goal);
  void update_order(std::span<const Candidate> points, Goal goal);
  void race_over(std::span<Candidate> points, std::span<const ScatteredDrop> drops, bool searching);
  bool limited_;                  ///< a landing may break a limit
  SeaParameters<double> drive_;   ///< with every term of the actuators played
  bool unlimited_steps_ = false;  ///< of a landing
  long max_steps_ = 0;
  std::array<int, kExecutionPoints> order_;  ///< in which an execution box is played, the most frequent failures first
  std::array<long, kExecutionPoints> failures_{};  ///< how often each point gave a value or ended a motion
  long motions_ = 0, landings_ = 0, flights_ = 0, work_ = 0, max_work_ = kUnbounded;
  double landing_time_ = 0;
  Stopwatch cpu_watch_{Stopwatch::Time::kProcess};
  double grace_ = 0;  ///< [s]
  struct Scattered;
  std::shared_ptr<Scattered> scattered_;  ///< buffers of race_over
  const std::function<bool()> over_ = [this] { return interrupted(); };
};

}  // namespace ukemi::landing
