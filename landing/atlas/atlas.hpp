// The atlas: the best motion for every drop of a grid, and the one that is safest over all of them.
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

/// As many numbers a motion of a file has at most.
inline constexpr int kAtlasVariables = 12;

/// What is planned for one drop. As it stands in a file.
struct AtlasCell {
  enum class State : std::uint64_t {
    kOpen,     ///< not planned yet, or by another shard
    kNone,     ///< no motion of the search range could be followed, or the drive loses the joint with the best
    kPlanned,  ///< what follows holds
  };
  State state = State::kOpen;
  double value = 0;          ///< the goal [m/s^2]
  double peak = 0;           ///< of the drop itself [m/s^2]
  double tolerant_peak = 0;  ///< the same within the execution tolerance; NaN: some landing in it cannot be followed
  std::array<double, kAtlasVariables> values{};  ///< of the motion space's variables, SI; those it has not: 0

  bool planned() const { return state == State::kPlanned; }
  Coordinates coordinates(int dimension) const { return Coordinates::Map(values.data(), dimension); }
};

struct AtlasOptions {
  AtlasGrid grid;
  AtlasShard shard;
  /// Of each drop: goal, motions (or landings) that are tried, seed. `threads` are spent over blocks.
  OptimizeOptions search;
  RobustOptions robust;  ///< with a measure: for drops that scatter about each of the grid
  Monitor monitor;       ///< told of drops that are planned, of those that were open; where it stops, open ones stay so
  /// Told of every drop as soon as it is planned; called by one thread at a time.
  std::function<void(std::size_t drop, const AtlasCell& cell)> done;

  /// Motions (or landings) that each drop is given; the first of a block, which nothing starts, has four times as many.
  static constexpr long kMotions = 3'000, kTolerantMotions = 1'000, kLandings = 12'000;
  long effort() const;    ///< what search.evaluations says, else that of its goal
  void validate() const;  ///< throws InputError
};

/// One drop to be planned.
struct AtlasTask {
  Drop drop;
  long effort;                       ///< motions, with a measure landings
  std::uint64_t seed;                ///< of the search
  std::vector<MotionValues> starts;  ///< what the drops of the block that are planned already play
};

/// Motions of an atlas over drops.
class AtlasTrial {
 public:
  virtual ~AtlasTrial() = default;
  /// The motion from now on, of a drop of the atlas.
  virtual void set(const Drop& planned_for, const MotionValues& values) = 0;
  /// Its peaks [m/s^2], one above `bound` only a bound of itself; kNoMotion where it cannot be followed, breaks a limit
  /// or was stopped.
  virtual void play(std::span<const Drop> drops, double bound, std::span<double> peaks) = 0;
};

/// A robot as an atlas sees it: what a drop of it may be, how one is planned, what a motion of it does.
class AtlasRobot {
 public:
  virtual ~AtlasRobot() = default;
  /// Robot, floor, drives and what a motion may be, as text: what determines the cells beside AtlasOptions.
  virtual std::string text() const = 0;
  /// What the motions are planned on: a checksum of the robot, its floor, its stops and detection, how exactly it
  /// plays, and its drives, each number to 9 digits; of neither the drop, nor the release, nor what is known of errors.
  virtual std::string checksum() const = 0;
  virtual std::vector<Variable> variables() const = 0;
  /// Throws InputError for a robot that is not valid, and for drops that it cannot have.
  virtual void validate(const AtlasGrid& grid) const = 0;
  /// How its drops scatter: as asked for, else as the scene says, else what is assumed.
  virtual Scatter scatter(const std::optional<Scatter>& asked) const = 0;
  virtual long effort(const AtlasOptions& options) const { return options.effort(); }
  /// One thread.
  virtual AtlasCell plan(const AtlasOptions& options, const AtlasTask& task) const = 0;
  /// `over` must outlive it.
  virtual std::unique_ptr<AtlasTrial> trial(int threads, const std::function<bool()>& over) const = 0;
};

/// What determines the cells, apart from the shard: a checksum, so that parts of different atlases never meet.
[[nodiscard]] std::string atlas_identity(const AtlasRobot& robot, const AtlasOptions& options);

/// Plans the shard's drops that are open in `cells` (one for each drop of the grid). The drops of a block are planned
/// one after the other, each search starting from the best of the block's motions so far; blocks know nothing of each
/// other. So the result depends neither on threads, nor on shards, nor on where it was stopped.
void plan_atlas(const AtlasRobot& robot, const AtlasOptions& options, std::span<AtlasCell> cells);

/// The motion of the atlas whose worst peak over all drops of the grid is the smallest: for a drop that the atlas does
/// not know.
struct SafestMotion {
  std::uint64_t drop = kNoDrop;  ///< whose motion it is; kNoDrop: no motion lands all drops
  double worst = 0;              ///< its worst peak over the grid [m/s^2]
  static constexpr std::uint64_t kNoDrop = ~std::uint64_t(0);
};
/// Each motion is played, the hardest drops first, until one is worse than the worst of the best so far.
[[nodiscard]] SafestMotion safest_motion(const AtlasRobot& robot, const AtlasGrid& grid,
                                         std::span<const AtlasCell> cells, int threads, const Monitor& monitor);

}  // namespace ukemi::landing
