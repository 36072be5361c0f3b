#include "landing/judge/survey.hpp"

#include "common/stopwatch.hpp"
#include "landing/model/motion_space.hpp"

namespace ukemi::landing {

MappedPeaks mapped(const std::function<PeakMap()>& play) {
  MappedPeaks out;
  const Stopwatch watch(Stopwatch::Time::kWall);
  out.map = play();
  out.map_seconds = watch.seconds();
  for (const PeakMap::Cell& c : out.map.grid) {
    out.broken += c.end == End::kBroken, out.failed += no_landing(c.end) && c.end != End::kBroken;
    out.missing += c.end == End::kStopped, out.lost += c.joint_lost;
  }
  return out;
}

Survey survey(const Scene& scene, const MotionSpace& space, const SurveyOptions& options) {
  Survey out{mapped([&] { return map_peaks(scene, space, options.map); }), scene, {}};
  MapOptions search = options.map;
  search.monitor = options.basins;
  const std::vector<Basin> found = basins(scene, space, out.map, search);
  for (const Basin& b : found) {
    out.basins.push_back(
        {b, evidence(scene, space, b.values,
                     {.accuracy = search.tight, .threads = search.threads, .monitor = {{}, options.evidence.stop}})});
    options.evidence.progress(long(out.basins.size()), long(found.size()));
  }
  return out;
}

}  // namespace ukemi::landing
