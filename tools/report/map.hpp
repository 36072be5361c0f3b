// A grid of peaks as a reader sees it, of either kind of robot.
#pragma once

#include <string>
#include <vector>

#include "landing/judge/survey.hpp"
#include "tools/report/landing.hpp"

namespace ukemi::tools {

/// What is told of a map beside its grid.
struct MapTexts {
  std::string scene, source;  ///< names; source: of the floor's constants
  enum class Contacts { kShow, kUnknown } contacts;
  Table basins;
  std::string basins_comment, basins_words;  ///< in basins.csv and on the page
  std::vector<std::string> lines;            ///< a basin each, the best first
  std::string best;                          ///< the best basin
  bool rated = false;                        ///< what counts is a load / its rating
};
/// Tells, writes and returns the exit code; `more` comes behind the summary's keys.
int report(const landing::MappedPeaks& peaks, const MapTexts& texts, Run& run, const Json& more = Json::object());

}  // namespace ukemi::tools
