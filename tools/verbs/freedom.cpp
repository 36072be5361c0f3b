#include "tools/verbs/freedom.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/csv.hpp"
#include "common/degrees_doubt.hpp"
#include "common/error.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/command.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

using namespace landing;

void add_objective(CLI::App& verb, Goal& goal) {
  add_choice<Goal>(verb, "--objective", goal, {{"peak", Goal::kPeak}, {"tolerant", Goal::kTolerant}},
                   "peak, or tolerant: the worst peak within the scene's [execution] tolerance [peak]");
}

void add_freedom(CLI::App& verb, FreedomArguments& a) {
  verb.add_option("--bumps", a.bumps, "shape terms of the motion, 0 to 4 [0, or the scene's]");
  verb.add_option("--landing-gains", a.gains, "LO:HI: factors of K_p and K_d from the touchdown on, searched too");
  verb.add_option("--release-phi", a.release_phi, "joint angle at release [deg]; the motion moves it in the air");
  verb.add_option("--release-rate", a.release_rate, "rate of the joint at release [deg/s; 0]");
  verb.add_option("--release-from", a.from, "when the reference may begin to move, from release [s; 0]");
}

void apply(const FreedomArguments& a, Freedom& freedom) {
  if (a.bumps) {
    if (*a.bumps < 0 || *a.bumps > kMaxBumps)
      throw InputError(fmt::format("--bumps: {}: a whole number from 0 to {} is needed", *a.bumps, kMaxBumps));
    freedom.bumps = *a.bumps;
  }
  if (a.gains) {
    const NumberRange r = number_range("--landing-gains", *a.gains, false);
    if (r.lower < 0) throw InputError(fmt::format("--landing-gains: {}: at least 0 is needed", shortest(r.lower)));
    freedom.gains = {r.lower, r.upper};
  }
}

std::optional<Release> release_of(const FreedomArguments& a, const std::optional<Release>& scene) {
  if (!a.release_phi && !a.release_rate && !a.from) return scene;
  if (!a.release_phi && !scene)
    throw InputError(fmt::format("{}: --release-phi is needed with it: the joint's angle at release",
                                 a.from ? "--release-from" : "--release-rate"));
  Release r = scene.value_or(Release{});
  const auto finite = [](const char* option, double x) {
    if (!std::isfinite(x)) throw InputError(fmt::format("{}: {}: a finite number is needed", option, x));
    return x;
  };
  if (a.release_phi) {
    if (!(std::abs(*a.release_phi) <= 360))
      throw InputError(fmt::format("--release-phi: {}: degrees from -360 to 360 are needed", *a.release_phi));
    r.phi = *a.release_phi / kDegrees;
  }
  if (a.release_rate) r.rate = finite("--release-rate", *a.release_rate) / kDegrees;
  if (a.from) {
    if (!(finite("--release-from", *a.from) >= 0))
      throw InputError(fmt::format("--release-from: {}: at least 0 s is needed", *a.from));
    r.from = *a.from;
  }
  return r;
}

void warn_of_radians(const FreedomArguments& a, Run& run) {
  const std::string doubt = radians_doubt("--release-phi", a.release_phi.value_or(0));
  if (!doubt.empty()) run.warn(doubt);
}

Scene scene_of(const std::string& path, Run& run) {
  Scene scene = read_scene(path);
  run.input(path);
  warn_of_doubts(path, scene.verdicts, run);
  return scene;
}

Scene scene_of(const std::string& path, const FreedomArguments& arguments, Run& run) {
  Scene scene = scene_of(path, run);
  apply(arguments, scene.freedom);
  scene.release = release_of(arguments, scene.release);
  warn_of_radians(arguments, run);
  if (const auto wrong = release_fault(scene))
    throw InputError((wrong->key == "from" ? "--release-from: " : "--release-phi: ") + wrong->message);
  return scene;
}

}  // namespace ukemi::tools
