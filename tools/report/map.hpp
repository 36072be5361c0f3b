// Report of a grid of peaks, for both kinds of robot.
#pragma once

#include <string>
#include <vector>

#include "landing/judge/survey.hpp"
#include "tools/report/landing.hpp"

namespace ukemi::tools {

/// What the report of a map needs besides its grid.
struct MapTexts {
  std::string scene, source;        ///< name; where the floor's constants come from
  std::vector<std::string> points;  ///< the contacts, as map.csv names them
  std::string points_words;         ///< what the names mean
  Table basins;
  std::string basins_comment, basins_words;  ///< in basins.csv and on the page
  std::vector<std::string> lines;            ///< one per basin, the best first
  std::string best;                          ///< the best basin
  bool rated = false;                        ///< peaks are loads divided by their ratings
};
/// Reports and writes a map. Returns the exit code. `extra`: further keys of the summary.
int report(const landing::MappedPeaks& peaks, const MapTexts& texts, Run& run, const Json& extra = Json::object());

}  // namespace ukemi::tools
