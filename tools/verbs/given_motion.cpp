#include "tools/verbs/given_motion.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/error.hpp"
#include "landing/model/scene_file.hpp"

namespace ukemi::tools {

void add_motion(CLI::App& verb, MotionArguments& a) {
  verb.add_option("--motion", a.file, "motion file: TOML, or the rows of a motion.csv");
  verb.add_option("--hold", a.hold, "hold the reference at this angle [deg]; the joint stays compliant");
}

landing::Motion motion_of(const MotionArguments& a, const std::string& verb, Run& run) {
  if (a.file.empty() == !a.hold) throw InputError(verb + ": one of --motion FILE and --hold DEG is needed");
  if (a.hold) {
    if (!std::isfinite(*a.hold) || std::abs(*a.hold) > 360)
      throw InputError(fmt::format("--hold: {}: degrees from -360 to 360 are needed", *a.hold));
    if (*a.hold != 0 && std::abs(*a.hold) < 2)
      run.warn(fmt::format("--hold: {:g}: degrees, not radians ({:g} rad would be {:.4g})", *a.hold, *a.hold,
                           *a.hold * kDegrees));
    return {*a.hold / kDegrees, *a.hold / kDegrees, 1};
  }
  run.input(a.file);
  return landing::read_motion(a.file);
}

}  // namespace ukemi::tools
