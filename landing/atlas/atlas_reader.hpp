// The atlas in a robot's control program: an answer for the current drop in 2 ms.
#pragma once

#include <memory>
#include <string>

#include "landing/search/planner.hpp"

namespace ukemi::landing {

/// Answer of an atlas for a drop: by the goal no worse than holding the posture, as far as both were played in time.
struct AtlasEntry {
  Motion motion{};
  SeaParameters<double> sea;  ///< the drive that plays it
  MotionValues values;        ///< of the space's variables
  /// The values of the neighbouring motions, the best first: warm starts of Planner.
  std::span<const MotionValues> starts() const { return {around.data(), count}; }
  std::array<MotionValues, Planner::kStarts> around;
  std::size_t count = 0;
  double value = kNoMotion;  ///< AtlasReader::Options::goal in this drop; kNoMotion: no time was left to play it
  std::uint64_t drop = ~std::uint64_t(0);  ///< index in the grid of the drop that the motion was planned for
  bool holds = false;                      ///< `motion` holds the posture, which is the best here; `drop` is none
  bool inside = false;  ///< false: the drop is outside of the grid, or it has no motion here; this is the safest one
  bool found = false;   ///< false: the atlas has no safest motion either
};

struct AtlasReaderOptions {
  Goal goal = Goal::kTolerant;  ///< by which the motions are compared: kPeak or kTolerant
  double accuracy = 1e-5;       ///< of their landings
  double deadline = 1.5e-3;     ///< of the landings, which are not considered after it [s]
  Limits limits;                ///< that every landing must keep
};

/// Motions are not interpolated, as a cliff often lies between two drops: the motions of the neighbouring drops are
/// played in lanes, and the best is the answer.
class AtlasReader {
 public:
  using Options = AtlasReaderOptions;
  /// Allocates all memory. Throws InputError unless the file is a complete atlas of this robot, floor and drive.
  AtlasReader(const std::string& path, const Scene&, const SeaParameters<double>& sea, const Options& options = {});
  ~AtlasReader();
  /// Allocates nothing, starts no thread. To find neighbours a vertical speed is converted to height, and a pitch rate
  /// to pitch at touchdown; the drop itself is played.
  [[nodiscard]] AtlasEntry at(const Drop& drop);

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

}  // namespace ukemi::landing
