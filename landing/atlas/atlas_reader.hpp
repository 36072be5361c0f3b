// The atlas in a robot's control program: an answer for the drop at hand in 2 ms.
#pragma once

#include <memory>
#include <string>

#include "landing/search/planner.hpp"

namespace ukemi::landing {

/// What an atlas has for a drop: by the goal no worse than holding the posture, as far as both were played in time.
struct AtlasEntry {
  Motion motion{};
  SeaParameters<double> sea;  ///< the drive that plays it
  MotionValues values;        ///< of the space's variables
  /// The values of the motions around, the best first: where Planner may start.
  std::span<const MotionValues> starts() const { return {around.data(), count}; }
  std::array<MotionValues, Planner::kStarts> around;
  std::size_t count = 0;
  double value = kNoMotion;  ///< AtlasReader::Options::goal at this very drop; kNoMotion: no time was left to play it
  std::uint64_t drop = ~std::uint64_t(0);  ///< of the grid, for which the motion was planned
  bool holds = false;   ///< no motion around lands as softly as holding the posture: `motion` does; `drop` is none
  bool inside = false;  ///< false: the grid does not reach so far, or has no motion here, and this is the safest one
  bool found = false;   ///< false: nor has the atlas any motion that lands all its drops
};

struct AtlasReaderOptions {
  Goal goal = Goal::kTolerant;  ///< by which the motions are compared: kPeak or kTolerant
  double accuracy = 1e-5;       ///< of their landings
  double deadline = 1.5e-3;     ///< for playing; what is not played by then is no answer [s]
  Limits limits;                ///< what no landing may do
};

/// Motions do not blend: between two drops lies a cliff as often as not. So the motions of the drops around the one at
/// hand are played, in lanes, and the best is taken.
class AtlasReader {
 public:
  using Options = AtlasReaderOptions;
  /// Takes all memory. Throws InputError where the file is no whole atlas of these motions, robot, floor and drive.
  AtlasReader(const std::string& path, const Scene&, const SeaParameters<double>& sea, const Options& options = {});
  ~AtlasReader();
  /// Allocates nothing, starts no thread. A vertical speed counts as the height that makes it, a pitch rate as the
  /// pitch that it makes until the floor; what is played is the drop itself.
  [[nodiscard]] AtlasEntry at(const Drop& drop);

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

}  // namespace ukemi::landing
