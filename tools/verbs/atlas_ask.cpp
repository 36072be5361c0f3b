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

constexpr double kDeadline = 600;  // long: no robot is falling [s]
constexpr double kAccuracy = 1e-7;

struct AtlasQuery {
  std::string atlas, scene, actuator;
  Goal goal;
  const std::function<Drop(const Drop&)>& drop;
};

template <class Entry>
AtlasLookup lookup_of(const std::string& name, const Drop& drop, const Entry& entry, const AtlasQuery& q) {
  AtlasLookup out{.scene = name, .drop = drop, .inside = entry.inside, .found = entry.found, .holds = entry.holds};
  out.goal = q.goal == Goal::kPeak ? "peak" : "tolerant peak", out.value = entry.value;
  if (entry.found && !entry.holds) out.planned = MappedAtlas(q.atlas).header().grid.drop(entry.drop);
  return out;
}

int ask_body(const AtlasQuery& q, Run& run) {
  BodyScene scene = body_of(q.scene, {}, run);
  BodyAtlasReader reader(q.atlas, scene, {.goal = q.goal, .accuracy = kAccuracy, .deadline = kDeadline});
  const Drop drop = q.drop(scene.drop);
  const auto single = [](double x) { return AtlasAxis{x, x, 1}; };
  BodyAtlas(scene).validate({{single(drop.height), single(drop.forward_speed), single(drop.pitch)}});
  scene.drop = drop;
  const BodyAtlasEntry entry = reader.at(scene.drop);
  if (!entry.wrong.empty()) throw InputError("--ask: " + entry.wrong);
  AtlasLookup out = lookup_of(scene.name, scene.drop, entry, q);
  out.unit = unit_of(scene);
  if (!entry.found) return report(out, run);
  out.peak = simulate(scene, entry.motion).peak, out.held = simulate(scene, held_posture(scene)).peak;
  out.motion = Table::of(motion_quantities(scene.robot, entry.motion), entry.motion).object();
  out.motion_words = motion_words(scene.robot, entry.motion);
  out.motion_toml = body_motion_toml(entry.motion, scene.robot, run.provenance_text());
  return report(out, run);
}

int ask_two_link(const AtlasQuery& q, Run& run) {
  run.input(q.actuator);
  Scene scene = scene_of(q.scene, run);
  const SeaParameters<double> sea = read_actuator(q.actuator).sea;
  AtlasReader reader(q.atlas, scene, sea, {.goal = q.goal, .accuracy = kAccuracy, .deadline = kDeadline});
  scene.drop = q.drop(scene.drop);
  scene.validate();
  const AtlasEntry entry = reader.at(scene.drop);
  AtlasLookup out = lookup_of(scene.name, scene.drop, entry, q);
  if (!entry.found) return report(out, run);
  out.peak = simulate(scene, entry.sea, entry.motion).peak;
  out.held = entry.holds ? out.peak : simulate(scene, sea, kHeld).peak;
  out.motion = motion_json(entry.motion), out.motion_words = motion_words(entry.motion);
  out.motion_toml = to_toml(entry.motion, run.provenance_text());
  return report(out, run);
}

}  // namespace

int ask_atlas(const std::string& folder, Goal goal, const std::function<Drop(const Drop& scene)>& drop, Run& run) {
  const AtlasQuery query{in(folder, "atlas.bin"), in(folder, "scene.toml"), in(folder, "actuator.toml"), goal, drop};
  run.input(query.atlas);
  return is_of_links(query.scene) ? ask_body(query, run) : ask_two_link(query, run);
}

}  // namespace ukemi::tools
