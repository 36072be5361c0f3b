// An atlas as it is written.
#pragma once

#include <string>
#include <vector>

#include "common/actuator.hpp"
#include "landing/atlas/atlas_file.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

struct AtlasResult {
  landing::Scene scene;
  Actuator actuator;
  std::string scene_toml, actuator_toml;  ///< their texts, of which the header has the checksum
  landing::Atlas atlas;                   ///< drops of other shards are open
  std::vector<std::size_t> drops;         ///< of the shard, in the grid's order
  std::string shard;                      ///< "2/3"; empty: the whole
  std::size_t resumed = 0;                ///< drops that an earlier run had planned
  std::string journal;                    ///< where it was interrupted: what the next run goes on from
};

/// atlas.csv, atlas.bin, scene.toml and actuator.toml; of an interrupted run its journal in place of atlas.bin.
int report(const AtlasResult& result, Run& run);

}  // namespace ukemi::tools
