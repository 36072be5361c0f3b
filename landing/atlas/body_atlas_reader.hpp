// The atlas in the control program of a robot of links: an answer for the current fall, before any search.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "landing/atlas/atlas_reader.hpp"
#include "landing/plan/body_planner.hpp"

namespace ukemi::landing {

/// Answer of an atlas for a fall of a robot of links; other members as of AtlasEntry.
struct BodyAtlasEntry {
  BodyMotion motion;
  std::vector<BodyMotion> starts;  ///< neighbouring motions, the best first, for BodyPlanner::start
  double value = kNoMotion;
  std::uint64_t drop = ~std::uint64_t(0);
  bool holds = false, inside = false, found = false;
  std::string wrong;  ///< a measured number out of its range, and its rule; nothing is found then
};

/// As AtlasReader, but its `limits` are ignored, and it allocates. In the air the references stand at the measured
/// angles until the deadline, then move to phi_I. Throws as AtlasReader. Tests: test/legs/atlas.cpp.
class BodyAtlasReader {
 public:
  BodyAtlasReader(const std::string& path, const BodyScene& scene, const AtlasReaderOptions& = {.deadline = 0.03});
  ~BodyAtlasReader();
  [[nodiscard]] BodyAtlasEntry at(const Drop& drop);
  [[nodiscard]] BodyAtlasEntry at(const BodyFallState& state);

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

}  // namespace ukemi::landing
