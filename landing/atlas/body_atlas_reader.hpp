// The atlas in the control program of a robot of links: an answer for the fall at hand, before any search.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "landing/plan/body_planner.hpp"

namespace ukemi::landing {

struct AtlasHeader;

/// What an atlas has for a fall of a robot of links; as AtlasEntry.
struct BodyAtlasEntry {
  BodyMotion motion;
  std::vector<BodyMotion> starts;          ///< the motions around, the best first: where BodyPlanner may start
  double value = kNoMotion;                ///< Options::goal at this very drop; kNoMotion: no time was left to play it
  std::uint64_t drop = ~std::uint64_t(0);  ///< of the grid, for which the motion was planned
  bool inside = false;  ///< false: the grid does not reach so far, or has no motion here, and this is the safest one
  bool found = false;   ///< false: nor is there such a one, or what was measured cannot be
  std::string wrong;    ///< the number that cannot be, and its rule
};

/// As AtlasReader; unlike it, it allocates. Tests: test/legs/atlas.cpp.
class BodyAtlasReader {
 public:
  struct Options {
    Goal goal = Goal::kTolerant;  ///< by which the motions are compared: kPeak or kTolerant
    double accuracy = 1e-5;       ///< of their landings
    double deadline = 1e-2;       ///< for playing; what is not played by then is no answer [s]
  };
  /// Throws InputError for what is no whole atlas, and where it was planned for other motions, another robot, floor,
  /// limits or drives than the scene's.
  BodyAtlasReader(const std::string& path, const BodyScene& scene, const Options& options);
  BodyAtlasReader(const std::string& path, const BodyScene& scene) : BodyAtlasReader(path, scene, Options()) {}
  ~BodyAtlasReader();
  [[nodiscard]] BodyAtlasEntry at(const Drop& drop);
  /// For a robot in the air: its references stand at the measured angles until the deadline, then move to phi_I.
  [[nodiscard]] BodyAtlasEntry at(const BodyFallState& state);
  const AtlasHeader& header() const;

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

}  // namespace ukemi::landing
