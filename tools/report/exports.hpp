// Results as other programs read them, beside a verb's own files.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "landing/judge/checked.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

/// What is asked for.
struct Exports {
  enum class Format {
    kRos2,         ///< trajectory_msgs/JointTrajectory, YAML
    kPlotJuggler,  ///< the landing's rows without comment lines
  };
  std::vector<Format> formats;
  std::string joint = "knee";  ///< its name in the files

  bool has(Format format) const;
};

/// The files of a motion and its landing, by their names. `start`: when the landing motion is expected to start, from
/// release, as landing::rows_of has it. Without a trajectory there is no file for PlotJuggler.
std::map<std::string, std::string> exported(const Exports& exports, const landing::Motion& motion, double start,
                                            const landing::Landing& landing, const Run& run);

}  // namespace ukemi::tools
