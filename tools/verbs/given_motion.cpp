#include "tools/verbs/given_motion.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/degrees_doubt.hpp"
#include "common/error.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/arguments.hpp"

namespace ukemi::tools {

void add_motion(CLI::App& verb, MotionArguments& a) {
  verb.add_option("--motion", a.file, "motion file: TOML, or the rows of a motion.csv");
  verb.add_option(
          "--hold", a.hold,
          "hold the reference at this angle [deg], of a robot of links JOINT=DEG,...; the joint stays compliant")
      ->type_name("DEG");
}

landing::Motion motion_of(const MotionArguments& a, const std::string& verb, Run& run) {
  if (a.file.empty() == !a.hold) throw InputError(verb + ": one of --motion FILE and --hold DEG is needed");
  if (a.hold) {
    const double hold = to_number("--hold", *a.hold);
    if (std::abs(hold) > 360) throw InputError(fmt::format("--hold: {}: degrees from -360 to 360 are needed", hold));
    if (const std::string doubt = radians_doubt("--hold", hold); !doubt.empty()) run.warn(doubt);
    return {hold / kDegrees, hold / kDegrees, 1};
  }
  run.input(a.file);
  return landing::read_motion(a.file);
}

}  // namespace ukemi::tools
