// The atlas: the best motion for every drop of a grid, and the safest one over all drops.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "landing/atlas/grid.hpp"
#include "landing/judge/under_scatter.hpp"
#include "landing/search/optimize.hpp"

namespace ukemi::landing {

/// Maximum number of variables of a motion in a file.
inline constexpr int kAtlasVariables = 12;

/// The plan for one drop; the layout of a file.
struct AtlasCell {
  enum class State : std::uint64_t {
    kOpen,     ///< not planned yet, or by another shard
    kNone,     ///< no motion of the search range could be followed, or the drive loses the joint with the best
    kPlanned,  ///< the other members are set
  };
  State state = State::kOpen;
  double value = 0;          ///< the goal [m/s^2]
  double peak = 0;           ///< of the drop itself [m/s^2]
  double tolerant_peak = 0;  ///< peak within the execution tolerance; NaN: a landing in it cannot be followed
  std::array<double, kAtlasVariables> values{};  ///< of the motion space's variables, SI; 0 beyond their number

  bool planned() const { return state == State::kPlanned; }
  Coordinates coordinates(int dimension) const { return Coordinates::Map(values.data(), dimension); }
};

struct AtlasOptions {
  AtlasGrid grid;
  AtlasShard shard;
  /// Of each drop: goal, number of motions (or landings), seed. `threads` work on different blocks.
  OptimizeOptions search;
  RobustOptions robust;  ///< with a measure: each drop of the grid scatters
  Monitor monitor;       ///< progress in open drops; where it stops, the rest stays open
  /// Called after each drop is planned, by one thread at a time.
  std::function<void(std::size_t drop, const AtlasCell& cell)> done;

  /// Default motions (or landings) a drop; the first of a block, which has no warm starts, gets four times as many.
  static constexpr long kMotions = 3'000, kTolerantMotions = 1'000, kLandings = 12'000;
  long effort() const;    ///< search.evaluations, else the default of its goal
  void validate() const;  ///< throws InputError
};

/// One drop to be planned.
struct AtlasTask {
  Drop drop;
  long effort;                       ///< motions, with a measure landings
  std::uint64_t seed;                ///< of the search
  std::vector<MotionValues> starts;  ///< warm starts: motions of the planned drops of the block
};

/// Plays motions of an atlas over drops.
class AtlasTrial {
 public:
  virtual ~AtlasTrial() = default;
  /// Sets the motion, which was planned for a drop of the atlas.
  virtual void set(const Drop& planned_for, const MotionValues& values) = 0;
  /// Its peaks [m/s^2], those above `bound` only lower bounds; kNoMotion where it cannot be followed, breaks a limit or
  /// was stopped.
  virtual void play(std::span<const Drop> drops, double bound, std::span<double> peaks) = 0;
};

/// Interface of a robot to an atlas: its drops, their plans and trials.
class AtlasRobot {
 public:
  virtual ~AtlasRobot() = default;
  /// Robot, floor, drives and motion space as text: all that determines the cells besides AtlasOptions.
  virtual std::string text() const = 0;
  /// Checksum of the robot, its floor, stops, detection delay, execution tolerance and drives, each number to 9 digits;
  /// without drop, release and uncertainties.
  virtual std::string checksum() const = 0;
  virtual std::vector<Variable> variables() const = 0;
  /// Throws InputError for an invalid robot, and for drops that it cannot have.
  virtual void validate(const AtlasGrid& grid) const = 0;
  /// The requested scatter, else the scene's, else the assumed one.
  virtual Scatter scatter(const std::optional<Scatter>& requested) const = 0;
  virtual long effort(const AtlasOptions& options) const { return options.effort(); }
  /// Plans one drop, on one thread.
  virtual AtlasCell plan(const AtlasOptions& options, const AtlasTask& task) const = 0;
  /// `over` must outlive it.
  virtual std::unique_ptr<AtlasTrial> trial(int threads, const std::function<bool()>& over) const = 0;
};

/// Checksum of all that determines the cells, without the shard: only parts of the same atlas can be merged.
[[nodiscard]] std::string atlas_identity(const AtlasRobot& robot, const AtlasOptions& options);

/// Plans the shard's drops that are open in `cells` (one for each drop of the grid). The drops of a block are planned
/// one after the other, each with the block's motions so far as warm starts; blocks are independent. So the result
/// depends neither on threads, nor on shards, nor on interruptions.
void plan_atlas(const AtlasRobot& robot, const AtlasOptions& options, std::span<AtlasCell> cells);

/// The motion of the atlas with the smallest worst peak over all drops of the grid: for a drop outside of it.
struct SafestMotion {
  std::uint64_t drop = kNoDrop;  ///< the drop of its cell; kNoDrop: no motion can be followed in all drops
  double worst = 0;              ///< its worst peak over the grid [m/s^2]
  static constexpr std::uint64_t kNoDrop = ~std::uint64_t(0);
};
/// Plays each motion, the hardest drops first, until a peak exceeds the worst peak of the best motion so far.
[[nodiscard]] SafestMotion safest_motion(const AtlasRobot& robot, const AtlasGrid& grid,
                                         std::span<const AtlasCell> cells, int threads, const Monitor& monitor);

}  // namespace ukemi::landing
