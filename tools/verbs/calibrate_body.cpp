// ukemi calibrate of a robot of links.
#include <fmt/format.h>

#include "common/error.hpp"
#include "landing/drops/drop_log.hpp"
#include "tools/program/arguments.hpp"
#include "tools/report/calibrate.hpp"
#include "tools/report/results.hpp"
#include "tools/verbs/body.hpp"
#include "tools/verbs/calibrate.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

BodyMotion motion_at(const std::string& path, const BodyScene& scene, Run& run) {
  run.input(path);
  return read_body_motion(path, scene.robot);
}

}  // namespace

int calibrate_body(const CalibrateArguments& a, const CommonOptions& common) {
  Run run(kCalibrateOutputs, common);
  const BodyScene scene = body_of(a.scene, a.actuators, run);
  check_drop_arguments(scene.robot, a.height_of.empty() ? nullptr : "--height-of",
                       a.speed_of.empty() ? nullptr : "--speed-of");
  BodyCalibrationOptions options;
  options.terms = drop_choice(scene);
  if (options.terms.free.empty()) throw InputError(Location{a.scene}, "no contact: there is nothing to fit");
  set_options(a, common, options);
  options.threads = common.threads;
  if (a.law == CalibrateArguments::Law::kOnly) options.rivals = BodyCalibrationOptions::Rivals::kNone;
  options.monitor = run.monitor("calibrate", "parts");
  const auto motion = a.motion.empty() ? std::nullopt : std::optional(motion_at(a.motion, scene, run));
  const auto read = [channels = body_channels(scene.robot)](const std::string& path) {
    return read_drop(path, channels);
  };
  const auto played = [&](const std::string&, const std::optional<std::string>& own) {
    return own ? motion_at(*own, scene, run) : motion ? *motion : held_posture(scene);
  };
  auto [drops, unseen] = given_drops<BodyLoggedDrop>(a, scene, run, read, played);
  BodyCalibratedDrops fitted{std::move(drops), {}};
  fitted.result = calibrate(scene, fitted.drops, options);
  if (a.law == CalibrateArguments::Law::kAsked) adopt_best_law(fitted.result, fitted.drops, options);
  std::optional<BodyCalibratedDrops> validation;
  if (!unseen.empty() && !options.monitor.stopped())
    validation = {unseen, validate(fitted.result.scene, unseen, options)};
  return report(a.scene, fitted, validation, a.doubt, run);
}

}  // namespace ukemi::tools
