// What a search minimises, for any kind of robot: values of points of a box of variables, within a time and an amount
// of work.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "common/stopwatch.hpp"
#include "landing/model/motion_space.hpp"
#include "landing/run/work.hpp"
#include "landing/scatter/measure.hpp"
#include "landing/search/goal.hpp"

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

/// The objective of a search. Its counts of motions, landings and work are for budgets.
class Objective {
 public:
  /// Options that every objective has.
  struct Common {
    Goal goal = Goal::kPeak;
    double accuracy = 1e-6;                                     ///< relative tolerance of the landings' steps
    int threads = 1;                                            ///< 0: all cores; without influence on the results
    Stopwatch::Time time = Stopwatch::Time::kWall;              ///< the clock of deadlines
    double deadline = std::numeric_limits<double>::infinity();  ///< from construction, which plays a landing [s]
    std::function<bool()> stop;                                 ///< see Objective::stop
  };
  virtual ~Objective() = default;
  Objective(const Objective&) = delete;

  /// The variables, and the centre of their box in the unit cube.
  virtual const std::vector<Variable>& variables() const = 0;
  int dimension() const { return int(variables().size()); }
  Coordinates centre() const { return Coordinates::Constant(dimension(), 0.5); }
  Goal goal() const { return common_.goal; }
  int threads() const { return common_.threads; }
  double accuracy() const { return common_.accuracy; }
  virtual void set_accuracy(double accuracy) { common_.accuracy = accuracy; }

  /// Accuracy at which the best few are evaluated again: the tightest that lanes have.
  virtual double tight_accuracy() const { return 1e-9; }

  /// Sets the values of points. Where it is interrupted, points that are not finished get kNoMotion; a point that can
  /// no longer reach its bound gets a value above it.
  virtual void evaluate(std::span<Candidate> points, Fidelity fidelity) = 0;
  /// Whether values of that fidelity are those of the goal.
  virtual bool exact(Fidelity fidelity) const = 0;
  /// Maximum number of landings a motion.
  virtual int landings_per_motion(Goal goal) const = 0;
  /// The value of one motion at `accuracy`, limits included; of what was played where it is interrupted, 0 where
  /// nothing was.
  virtual double verified(const Candidate& p, double accuracy, double bound) = 0;

  /// Whether basins are kept apart by the contact that touches first, see Candidate::first_contact.
  virtual bool several_contacts() const { return false; }

  /// Under scatter: the measure of the peaks; else null.
  virtual const Measure* measure() const { return nullptr; }
  /// Minimum distance of the best few, as a fraction of the box.
  virtual double separation() const { return 1e-3; }
  /// Under scatter: whether the best few are evaluated over other drops, and their values over those.
  virtual bool has_judging() const { return false; }
  virtual void evaluate_judging(std::span<Candidate>) {}
  /// Under scatter: whether a motion kept the limits in the required share of the drops when it was last evaluated.
  virtual bool keeps_limits(const Candidate&) const { return true; }

  /// The posture to hold that is known beforehand, maybe with its value; absent: the box has none.
  virtual std::optional<Candidate> held() const = 0;
  /// Whether other postures may be held: a robot in the air holds the one that it was released in.
  virtual bool may_hold_others() const = 0;
  /// Sets postures to be tried: of round 0 over the whole box, of round 1 around the best of those of round 0.
  virtual void draw_postures(int round, std::span<Candidate> postures) const = 0;

  /// Number of peaks with derivatives at a point; 0: the values of this fidelity have none.
  virtual int gradient_rows(Fidelity) const { return 0; }
  /// Whether an automatic search descends from its best by them.
  virtual bool refines() const { return false; }
  /// At a point the peaks whose maximum is its value, and their derivatives by the coordinates, row by row; rows beyond
  /// the peaks that were found are 0.
  virtual void linearise(const Coordinates&, Fidelity, std::span<double> /*peaks*/, std::span<double> /*gradient*/) {}

  double deadline;  ///< on `watch` [s]
  Stopwatch watch;
  std::function<bool()> stop;                  ///< if set, called often and from any thread; true interrupts
  long motions() const { return motions_; }    ///< evaluated
  long landings() const { return landings_; }  ///< played for them, abandoned ones included
  long flights() const { return flights_; }    ///< of these, those that never touched the floor
  long work() const { return work_; }          ///< of all landings, see work_of
  /// Limits the work from now on.
  void limit_work(long work) { max_work_ = work < kUnbounded - work_ ? work_ + work : kUnbounded; }
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
  /// Duration of a landing at the accuracy of the search [s].
  double landing_time() const { return landing_time_; }

 protected:
  explicit Objective(const Common& common)
      : deadline(common.deadline), watch(common.time), stop(common.stop), common_(common) {}

  Common common_;
  long motions_ = 0, landings_ = 0, flights_ = 0, work_ = 0, max_work_ = kUnbounded;
  double landing_time_ = 0;
  const std::function<bool()> over_ = [this] { return interrupted(); };

 private:
  Stopwatch cpu_watch_{Stopwatch::Time::kProcess};
  double grace_ = 0;  ///< [s]
};

}  // namespace ukemi::landing
