// ukemi calibrate of a robot of links.
#include <fmt/format.h>

#include "common/error.hpp"
#include "landing/drops/body_rollout.hpp"
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

/// Reads the logs; each drop with its motion, by default the posture that the scene holds, and initial conditions.
std::vector<BodyLoggedDrop> read_drops(const std::vector<std::string>& paths, const CalibrateArguments& a,
                                       const BodyScene& scene, const std::optional<BodyMotion>& motion, Run& run) {
  const std::vector<DropChannel> channels = drop_channels(body_channels(scene.robot));
  std::vector<BodyLoggedDrop> out;
  for (const std::string& path : paths) {
    run.input(path);
    BodyLoggedDrop d{.log = read_drop(path, channels), .motion = {}, .thrown = scene.drop};
    const auto own = value_of("--motion-of", a.motion_of, path);
    d.motion = own ? motion_at(*own, scene, run) : motion ? *motion : held_posture(scene);
    set_drop(a, path, d.thrown);
    warn_of_log(d.log, run);
    out.push_back(std::move(d));
  }
  return out;
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
  check_drop_names(a);
  for (const std::string& twice : duplicate_warnings(a.drops)) run.warn(twice);
  BodyCalibratedDrops fitted{read_drops(a.drops, a, scene, motion, run), {}};
  const std::vector<BodyLoggedDrop> unseen = read_drops(a.validate, a, scene, motion, run);
  check_drops(scene, fitted.drops);
  if (!unseen.empty()) check_drops(scene, unseen);
  for (const std::string& known : overlap_warnings(a.drops, a.validate)) run.warn(known);
  run.info(fmt::format("fitting {} drops", fitted.drops.size()));
  fitted.result = calibrate(scene, fitted.drops, options);
  if (a.law == CalibrateArguments::Law::kAsked) adopt_best_law(fitted.result, fitted.drops, options);
  std::optional<BodyCalibratedDrops> validation;
  if (!unseen.empty() && !options.monitor.stopped())
    validation = {unseen, validate(fitted.result.scene, unseen, options)};
  return report(a.scene, fitted, validation, a.doubt, run);
}

}  // namespace ukemi::tools
