#include "tools/study/calibration.hpp"

#include "common/eigen.hpp"
#include "common/error.hpp"
#include "landing/body/by_links.hpp"
#include "tools/study/body_drops.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// A scene and its drops as those of a robot of links.
struct DropsByLinks {
  BodyScene scene;
  std::vector<BodyLoggedDrop> drops;

  DropsByLinks(const Scene& s, const SeaParameters<double>& sea, const std::vector<LoggedDrop>& logged) {
    for (const LoggedDrop& d : logged) {
      const TwoLinkLanding landing(s, sea, d.motion);
      scene = landing.scene, drops.push_back({d.log, landing.motion, d.thrown});
    }
  }
  BodyDrops simulated() const {
    constexpr double kUnused = 0;  // touchdowns are in closed form
    return {scene, drops, thigh_channels(), kUnused, 1, Slopes::kExact};
  }
};

/// Throws InputError for a scene, drive or motion outside its range.
void validate_each(const Scene& scene, const SeaParameters<double>& sea, const std::vector<LoggedDrop>& drops) {
  for (const LoggedDrop& d : drops) {
    Scene thrown = scene;
    thrown.drop = d.thrown, thrown.drop.pitch = scene.drop.pitch;
    landing::validate(thrown, sea, d.motion);
  }
}

}  // namespace

void check_drops(const Scene& scene, const std::vector<LoggedDrop>& drops) {
  if (drops.empty()) throw InputError("no drops: at least one log is needed");
  check_floor(scene);
  check_logs(DropsByLinks(scene, {}, drops).simulated());
}

Calibration calibrate(const Scene& scene, const SeaParameters<double>& sea, const std::vector<LoggedDrop>& drops,
                      const CalibrationOptions& options) {
  options.validate();
  check_drops(scene, drops), validate_each(scene, sea, drops);
  const DropsByLinks of(scene, sea, drops);
  Calibration out{fit_floor(of.simulated(), options), scene};
  const BodyScene fitted = fitted_scene(of.scene, options.terms, out);
  const ContactLaw& law = fitted.robot.contacts.front().law;
  out.scene.floor = {law.stiffness, law.damping_normal, law.damping_tangential},
  out.scene.drop.pitch = fitted.drop.pitch;
  static const std::vector<std::string> known(kUncertainNames.begin(), kUncertainNames.end());
  if (out.converged) out.scene.uncertainty = out.uncertainty(&known);
  out.scene.verdicts = out.verdicts();
  return out;
}

Calibration validate(const Scene& scene, const SeaParameters<double>& sea, const std::vector<LoggedDrop>& drops,
                     const CalibrationOptions& options) {
  check_drops(scene, drops), validate_each(scene, sea, drops);
  return {validate_floor(DropsByLinks(scene, sea, drops).simulated(), options), scene};
}

}  // namespace ukemi::tools
