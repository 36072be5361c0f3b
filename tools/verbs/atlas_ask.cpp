#include "tools/verbs/atlas_ask.hpp"

#include "common/error.hpp"
#include "landing/atlas/atlas_file.hpp"
#include "landing/atlas/atlas_reader.hpp"
#include "landing/atlas/body_atlas.hpp"
#include "landing/atlas/body_atlas_reader.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/report/atlas.hpp"
#include "tools/report/body.hpp"
#include "tools/verbs/body.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

constexpr double kPatience = 600;  // nobody falls [s]
constexpr double kAccuracy = 1e-7;

struct Asked {
  std::string atlas, scene, actuator;
  Goal goal;
  const std::function<Drop(const Drop&)>& drop;
};

template <class Entry>
AskedAtlas found_of(const std::string& name, const Drop& drop, const Entry& entry, const Asked& a) {
  AskedAtlas out{.scene = name, .drop = drop, .inside = entry.inside, .found = entry.found, .holds = entry.holds};
  out.goal = a.goal == Goal::kPeak ? "peak" : "tolerant peak", out.value = entry.value;
  if (entry.found && !entry.holds) out.planned = MappedAtlas(a.atlas).header().grid.drop(entry.drop);
  return out;
}

int ask_body(const Asked& a, Run& run) {
  BodyScene scene = body_of(a.scene, {}, run);
  BodyAtlasReader reader(a.atlas, scene, {.goal = a.goal, .accuracy = kAccuracy, .deadline = kPatience});
  const Drop drop = a.drop(scene.drop);
  const auto stands = [](double x) { return AtlasAxis{x, x, 1}; };
  BodyAtlas(scene).validate({{stands(drop.height), stands(drop.forward_speed), stands(drop.pitch)}});
  scene.drop = drop;
  const BodyAtlasEntry entry = reader.at(scene.drop);
  if (!entry.wrong.empty()) throw InputError("--ask: " + entry.wrong);
  AskedAtlas out = found_of(scene.name, scene.drop, entry, a);
  out.unit = unit_of(scene);
  if (!entry.found) return report(out, run);
  out.peak = simulate(scene, entry.motion).peak, out.held = simulate(scene, held_posture(scene)).peak;
  out.motion = Table::of(motion_quantities(scene.robot, entry.motion), entry.motion).object();
  out.motion_words = motion_words(scene.robot, entry.motion);
  out.motion_toml = body_motion_toml(entry.motion, scene.robot, run.provenance_text());
  return report(out, run);
}

int ask_two_link(const Asked& a, Run& run) {
  run.input(a.actuator);
  Scene scene = scene_of(a.scene, run);
  const SeaParameters<double> sea = read_actuator(a.actuator).sea;
  AtlasReader reader(a.atlas, scene, sea, {.goal = a.goal, .accuracy = kAccuracy, .deadline = kPatience});
  scene.drop = a.drop(scene.drop);
  scene.validate();
  const AtlasEntry entry = reader.at(scene.drop);
  AskedAtlas out = found_of(scene.name, scene.drop, entry, a);
  if (!entry.found) return report(out, run);
  out.peak = simulate(scene, entry.sea, entry.motion).peak;
  out.held = entry.holds ? out.peak : simulate(scene, sea, kHeld).peak;
  out.motion = motion_json(entry.motion), out.motion_words = motion_words(entry.motion);
  out.motion_toml = to_toml(entry.motion, run.provenance_text());
  return report(out, run);
}

}  // namespace

int ask_atlas(const std::string& folder, Goal goal, const std::function<Drop(const Drop& own)>& drop, Run& run) {
  const Asked asked{in(folder, "atlas.bin"), in(folder, "scene.toml"), in(folder, "actuator.toml"), goal, drop};
  run.input(asked.atlas);
  return is_of_links(asked.scene) ? ask_body(asked, run) : ask_two_link(asked, run);
}

}  // namespace ukemi::tools
