// Reports of an atlas and of a query to one.
#pragma once

#include <string>
#include <vector>

#include "landing/atlas/atlas_file.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

extern const Outputs kAtlasOutputs;

struct AtlasResult {
  std::string scene;                         ///< its name
  std::vector<landing::Variable> variables;  ///< of its motions
  std::string scene_toml, actuator_toml;     ///< texts whose checksum is in the header; actuator_toml is empty for a
                                             ///< robot of links, whose scene names its drives
  landing::Atlas atlas;                      ///< drops of other shards are not planned
  std::vector<std::size_t> drops;            ///< of the shard, in the grid's order
  std::string shard;                         ///< "2/3"; empty: the whole
  std::size_t resumed = 0;                   ///< number of drops that an earlier run had planned
  std::string unit = "m/s^2";                ///< of the goal
  std::string journal;                       ///< of an interrupted run: what the next one resumes from; else empty
};

/// Result of looking up a drop in an atlas, compared with the held posture.
struct AtlasLookup {
  std::string scene;      ///< its name
  landing::Drop drop;     ///< the requested one
  landing::Drop planned;  ///< the grid's drop that the motion was planned for
  bool inside = false, found = false;
  bool holds = false;          ///< no neighbouring motion is softer than the held posture; `planned` is unused
  std::string goal;            ///< by which the neighbouring motions were compared
  double value = 0;            ///< of the goal at `drop`
  std::string unit = "m/s^2";  ///< of `value`
  double peak = 0, held = 0;   ///< of the motion and the held posture at full accuracy [m/s^2]
  Json motion;
  std::string motion_words, motion_toml;
};
/// Writes motion.toml. Returns the exit code.
int report(const AtlasLookup& lookup, Run& run);

/// Writes atlas.csv, atlas.bin (its journal if interrupted), scene.toml and, for the paper's robot, actuator.toml.
/// Returns the exit code.
int report(const AtlasResult& result, Run& run);

}  // namespace ukemi::tools
