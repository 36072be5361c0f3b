// What a search minimises: the peak of a motion, or its tolerant peak, over a motion space; many motions at once.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "common/stopwatch.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/model/motion_space.hpp"
#include "landing/run/work.hpp"
#include "landing/scatter/scattered.hpp"
#include "landing/search/goal.hpp"
#include "landing/search/robust.hpp"
#include "landing/search/tolerant_peak.hpp"

namespace ukemi::landing {

/// How a value is computed: by which goal, and under scatter over how many of the drops.
struct Fidelity {
  static constexpr std::size_t kAllDrops = std::numeric_limits<std::size_t>::max();
  Goal goal = Goal::kPeak;
  std::size_t drops = kAllDrops;

  Fidelity() = default;
  Fidelity(Goal g, std::size_t d = kAllDrops) : goal(g), drops(d) {}
};

/// Under scatter, the number of stages after each of which a motion may be given up.
inline constexpr std::size_t kScatteredStages = 3;

/// A point of the motion space as the solvers carry it.
struct Candidate {
  Coordinates u;             ///< its place in the unit cube
  double value = kNoMotion;  ///< the goal [m/s^2]; above `bound` only a lower bound of it
  double bound = kNoMotion;  ///< landings are abandoned above it: the caller needs no larger value
  /// Under scatter: values over the first drops (0: not known); before it is played, of the motion that has the bound.
  std::array<double, kScatteredStages> early{};
  int worst = -1;  ///< which point of the execution box gave the value, and is tried first next time; -1: not known
  int played = 0, broken = 0;  ///< under scatter: the drops of the value, and those of them that broke a limit
  int first_contact = -1;      ///< of a robot of links: which contact touches first in its first drop
  bool operator<(const Candidate& o) const { return value < o.value; }
};

class Objective {
 public:
  struct Options {
    Goal goal = Goal::kPeak;
    double accuracy = 1e-6;  ///< see BatchOptions
    /// What no landing may do, wherever in the execution box; the scene's joint stops are added. None is spent on a
    /// motion whose reference is too quick.
    Limits limits;
    int threads = 1;                                            ///< 0: all cores; without influence on the results
    Stopwatch::Time time = Stopwatch::Time::kWall;              ///< the clock of deadlines
    double deadline = std::numeric_limits<double>::infinity();  ///< from the construction on, which plays a landing [s]
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
  /// Values of many motions. On one thread it allocates nothing. What ends it early (see `late`) cuts landings off:
  /// their motions come back with kNoMotion. Drops are played in stages; a motion that cannot be as good as its bound
  /// any more is left with its value over those that it was played on, above the bound.
  void evaluate(std::span<Candidate> points, Fidelity fidelity);
  /// Whether values of that fidelity are the goal's own.
  bool exact(Fidelity fidelity) const {
    return fidelity.goal == options_.goal &&
           (fidelity.goal != Goal::kRobust || fidelity.drops >= options_.robust->drops.size());
  }
  /// Values of the best few over the judging drops; cut off as above.
  void judge_scattered(std::span<Candidate> points);
  /// Under scatter: room for so many motions at once over the drops that are searched on; they allocate nothing then.
  void reserve_scattered(std::size_t motions);
  /// Under scatter: whether a motion, as it was last played, kept the limits in as many of the drops as Measure::share
  /// asks for; of all that are searched on or judge, whichever are fewer. A drop that was not played was not kept.
  bool keeps_limits(const Candidate& p) const;
  double deadline;  ///< on `watch` [s]
  Stopwatch watch;
  std::function<bool()> stop;  ///< asked often, from any thread, if set; true: no time is left
  /// The value of one motion in the scalar path, limits included, as far as it may be played; 0 where nothing of it
  /// may. With a deadline, a landing of very many steps counts as one that cannot be followed.
  double verified(const DrivenMotion& play, double accuracy, double bound = kNoMotion);

  double accuracy() const { return options_.accuracy; }
  void set_accuracy(double accuracy) { options_.accuracy = accuracy; }
  const Options& options() const { return options_; }
  /// How many landings a motion takes at most: of its execution box, to be its value or to keep the limits; a motion
  /// that is only screened by its peak keeps them at the exact motion alone.
  int points(Goal goal) const {
    if (goal == Goal::kRobust) return int(options_.robust->drops.size());
    return goal == Goal::kTolerant || (goal == options_.goal && limited_) ? kExecutionPoints : 1;
  }
  /// Whether landing k of its box is part of a motion's value.
  static bool counts(int k, Goal goal) { return k == 0 || goal == Goal::kTolerant; }
  const Scene& scene() const { return scene_; }
  long motions() const { return motions_; }    ///< evaluated so far
  long landings() const { return landings_; }  ///< followed for them, abandoned ones included
  long flights() const { return flights_; }    ///< of these, never touched the floor

  long work() const { return work_; }  ///< spent on them, see work_of
  /// Limits the work that may be spent from now on.
  void grant(long work) { granted_ = work < kUnbounded - work_ ? work_ + work : kUnbounded; }
  /// Counts landings that were played outside of this objective for the search.
  void spend(long work) { work_ += work; }
  bool exhausted() const { return work_ >= granted_; }
  /// From now on the deadline has no say before so much processor time is used, whatever else the machine does [s].
  void grant_time(double seconds) { grace_ = seconds, used_.restart(); }
  /// True once the deadline has passed, the work is spent or somebody has asked to stop: landings are cut off.
  bool late() const {
    const bool passed = std::isfinite(deadline) && watch.seconds() >= deadline && used_.seconds() >= grace_;
    return exhausted() || passed || (stop && stop());
  }
  /// late() in the form that a landing's options take.
  const std::function<bool()>* over() const { return &over_; }
  /// What the landing in the middle of the box took at the search's accuracy [s].
  double landing_time() const { return landing_time_; }

 private:
  class Race;
  Objective(const Scene& scene, std::unique_ptr<const MotionSpace> own, const Options& options);
  std::unique_ptr<const MotionSpace> own_;
  const Scene& scene_;
  const MotionSpace& space_;
  Options options_;
  bool too_quick(const DrivenMotion& play) const;
  void evaluate_boxes(std::span<Candidate> points, Goal goal);
  void learn_order(std::span<const Candidate> points, Goal goal);
  void race_over(std::span<Candidate> points, std::span<const ScatteredDrop> drops, bool searching);
  bool limited_;  ///< a landing may break a limit
  bool extended_, late_;
  Feedback feedback_;
  bool patient_ = false;  ///< landings may take any number of steps
  long max_steps_ = 0;
  std::array<int, kExecutionPoints> order_;        ///< order in which an execution box is played: the worst come first
  std::array<long, kExecutionPoints> failures_{};  ///< how often each gave a value or ended a motion
  long motions_ = 0, landings_ = 0, flights_ = 0, work_ = 0, granted_ = kUnbounded;
  double landing_time_ = 0;
  Stopwatch used_{Stopwatch::Time::kProcess};
  double grace_ = 0;  ///< [s]
  struct Scattered;
  std::shared_ptr<Scattered> scattered_;  ///< memory of the races under scatter
  const std::function<bool()> over_ = [this] { return late(); };
};

}  // namespace ukemi::landing
