// An atlas as it is written.
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
  std::string scene_toml, actuator_toml;     ///< texts, of which the header has the checksum; of a robot of links the
                                             ///< scene names its drives, and the other is empty
  landing::Atlas atlas;                      ///< drops of other shards are open
  std::vector<std::size_t> drops;            ///< of the shard, in the grid's order
  std::string shard;                         ///< "2/3"; empty: the whole
  std::size_t resumed = 0;                   ///< drops that an earlier run had planned
  std::string unit = "m/s^2";                ///< of what is made small
  std::string journal;                       ///< where it was interrupted: what the next run goes on from
};

/// What an atlas has for a drop, beside the held posture there.
struct AskedAtlas {
  std::string scene;      ///< its name
  landing::Drop drop;     ///< that was asked for
  landing::Drop planned;  ///< of the grid, for which the motion was planned
  bool inside = false, found = false;
  bool holds = false;          ///< nothing around lands as softly as the held posture: `planned` has no say
  std::string goal;            ///< by which the motions around were compared
  double value = 0;            ///< of it at this drop
  std::string unit = "m/s^2";  ///< of that
  double peak = 0, held = 0;   ///< of the motion and of the held posture, accurately [m/s^2]
  Json motion;
  std::string motion_words, motion_toml;
};
/// motion.toml. Returns the exit code.
int report(const AskedAtlas& asked, Run& run);

/// atlas.csv, atlas.bin, scene.toml and, of the paper's robot, actuator.toml; of an interrupted run its journal in
/// place of atlas.bin.
int report(const AtlasResult& result, Run& run);

}  // namespace ukemi::tools
