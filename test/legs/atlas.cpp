// The atlas of robots of links: planned drop by drop, kept in the file of every atlas, read in a fall.
#include "landing/atlas/body_atlas.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <set>

#include "common/degrees.hpp"
#include "landing/atlas/atlas_file.hpp"
#include "landing/atlas/body_atlas_reader.hpp"
#include "landing/plan/body_goal.hpp"
#include "test/folder.hpp"
#include "test/legs/robots.hpp"
#include "test/paper.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using Catch::Matchers::Contains;
using legs::shipped;

namespace {

AtlasOptions on(const AtlasGrid& grid, long evaluations) {
  AtlasOptions o;
  o.grid = grid, o.search.evaluations = evaluations;
  return o;
}
AtlasOptions hopper_grid() { return on({{{{0.15, 0.45, 4}, {0, 0, 1}, {0, 0, 1}}}}, 300); }
AtlasOptions links_grid() { return on({{{{0.3, 0.5, 2}, {0.4, 0.8, 2}, {10 * kDegree, 25 * kDegree, 2}}}}, 200); }

Atlas planned(const BodyScene& scene, const AtlasOptions& o) {
  const BodyAtlas robot(scene);
  Atlas out{atlas_header(robot, o), std::vector<AtlasCell>(o.grid.size())};
  plan_atlas(robot, o, out.cells);
  out.header.safest = safest_motion(robot, o.grid, out.cells, 0, {});
  return out;
}

bool same(const AtlasCell& a, const AtlasCell& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// What a cell of the table plays.
BodyMotion motion_of(BodyScene scene, const Drop& drop, const AtlasCell& cell) {
  scene.drop = drop;
  const BodySpace space(scene);
  return space.motion(space.unit(cell.coordinates(space.dimension())));
}
double peak_of(BodyScene scene, const Drop& drop, const BodyMotion& motion) {
  scene.drop = drop;
  return simulate(scene, motion).peak;
}
double worst_in_box(BodyScene scene, const Drop& drop, const BodyMotion& motion) {
  scene.drop = drop;
  const std::vector<double> peaks = peaks_over(execution_drops(scene), motion, 1e-8, 0).peaks;
  return *std::max_element(peaks.begin(), peaks.end());
}

}  // namespace

TEST_CASE("legs: an atlas holds its motions, better than holding, whatever threads, shards and stops") {
  const BodyScene scene = shipped("hopper");
  AtlasOptions o = hopper_grid();
  o.search.threads = 1;
  const Atlas whole = planned(scene, o);
  REQUIRE(whole.planned() == whole.cells.size());
  const BodyMotion held = held_posture(scene);
  std::vector<double> worst(whole.cells.size(), 0);
  for (std::size_t i = 0; i < whole.cells.size(); ++i) {
    const AtlasCell& c = whole.cells[i];
    const Drop drop = o.grid.drop(i);
    const BodyMotion m = motion_of(scene, drop, c);
    CHECK(c.value == c.peak);
    CHECK(c.peak == Approx(peak_of(scene, drop, m)).epsilon(1e-7));
    CHECK(c.peak < peak_of(scene, drop, held));
    CHECK(c.tolerant_peak == Approx(worst_in_box(scene, drop, m)).epsilon(1e-4));
    for (std::size_t k = 0; k < whole.cells.size(); ++k)
      worst[i] = std::max(worst[i], peak_of(scene, o.grid.drop(k), m));
  }
  const auto best = std::min_element(worst.begin(), worst.end());
  CHECK(whole.header.safest.worst == Approx(*best).epsilon(1e-3));
  CHECK(worst[whole.header.safest.drop] == Approx(*best).epsilon(1e-3));

  const BodyAtlas robot(scene);
  std::vector<AtlasCell> parts(o.grid.size()), stopped(o.grid.size());
  o.search.threads = 2;
  for (const std::size_t k : {2, 1}) {
    o.shard = {k, 2};
    plan_atlas(robot, o, parts);
  }
  o.shard = {}, o.search.threads = 1;
  std::size_t runs = 0;
  for (bool over = false; !over; ++runs) {
    REQUIRE(runs <= stopped.size());
    std::size_t here = 0;
    o.done = [&](std::size_t, const AtlasCell&) { ++here; };
    o.monitor.stop = [&] { return here > 0; };
    plan_atlas(robot, o, stopped);
    over = std::none_of(stopped.begin(), stopped.end(), [](auto& c) { return c.state == AtlasCell::State::kOpen; });
  }
  CHECK(runs > 1);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    CHECK(same(whole.cells[i], parts[i]));
    CHECK(same(whole.cells[i], stopped[i]));
  }
}

TEST_CASE("legs: a tolerant atlas and one under scatter are of their goals") {
  const BodyScene scene = shipped("hopper");
  AtlasOptions o = hopper_grid();
  o.grid.axes[0].count = 2;
  o.search.goal = Goal::kTolerant;
  for (const AtlasCell& c : planned(scene, o).cells) {
    REQUIRE(c.planned());
    CHECK(c.value == c.tolerant_peak);
    CHECK(c.value >= c.peak);
  }
  o.search.goal = Goal::kPeak, o.search.evaluations = 2000;
  o.robust.measure = Measure{Measure::Kind::kCvar}, o.robust.samples = 16;
  const Atlas robust = planned(scene, o);
  CHECK(robust.header.goal == std::uint64_t(Goal::kRobust));
  for (const AtlasCell& c : robust.cells) {
    REQUIRE(c.planned());
    CHECK(c.value > c.peak);
  }
}

TEST_CASE("legs: what makes another atlas makes another identity, what the motions play on another robot") {
  const AtlasOptions o = hopper_grid();
  const BodyScene scene = shipped("hopper");
  std::set<std::string> seen{atlas_identity(BodyAtlas(scene), o)};
  const std::string robot = robot_checksum(scene);
  const auto differs = [&](bool on_another, auto&& change) {
    BodyScene other = scene;
    change(other);
    CHECK(seen.insert(atlas_identity(BodyAtlas(other), o)).second);
    CHECK((robot_checksum(other) != robot) == on_another);
  };
  differs(true, [](BodyScene& s) { s.robot.links[1].mass *= 1.001; });
  differs(true, [](BodyScene& s) { s.robot.joints[0].sea.k_p += 1; });
  differs(true, [](BodyScene& s) { s.robot.contacts[2].law.friction = 0.7; });
  differs(true, [](BodyScene& s) { s.slope = 0.1; });
  differs(true, [](BodyScene& s) { s.execution.phi *= 2; });
  differs(true, [](BodyScene& s) { forbid(s, {"knee"}); });
  differs(false, [](BodyScene& s) { s.search[0].phi[1] = 1; });
  differs(false, [](BodyScene& s) { s.freedom.bumps = 1; });
  differs(false, [](BodyScene& s) { s.duration[1] = 0.5; });
  BodyScene dropped = scene;
  dropped.drop.height = 0.7;
  CHECK(atlas_identity(BodyAtlas(dropped), o) == atlas_identity(BodyAtlas(scene), o));
}

TEST_CASE("legs: an axis that the base has not is refused, and a scene without a floor") {
  AtlasOptions o = hopper_grid();
  const auto refused = [&](const BodyScene& scene) {
    std::vector<AtlasCell> cells(o.grid.size());
    return test::refusal([&] { plan_atlas(BodyAtlas(scene), o, cells); });
  };
  o.grid.axes[1] = {0, 1, 2};
  CHECK_THAT(refused(shipped("hopper")), Contains("atlas: speed: the base of this robot has no forward speed"));
  o = hopper_grid(), o.grid.axes[2] = {0, 1, 2};
  CHECK_THAT(refused(shipped("hopper")), Contains("atlas: pitch: a robot on a rail keeps the pitch"));
  o = hopper_grid();
  BodyScene bare = shipped("hopper");
  bare.floor = false;
  CHECK_THAT(refused(bare), Contains("no contact"));
}

TEST_CASE("legs: a reader takes the best of the motions around a drop, on a rail two, in the air eight") {
  const test::Folder f;
  for (const char* name : {"hopper", "three_links"}) {
    INFO(name);
    const BodyScene scene = shipped(name);
    const bool rail = name == std::string("hopper");
    const AtlasOptions o = rail ? hopper_grid() : links_grid();
    const Atlas a = planned(scene, o);
    const std::string path = f.write("atlas.bin", atlas_bytes(a));
    const Drop drop = rail ? Drop{.height = 0.3} : Drop{.height = 0.42, .forward_speed = 0.61, .pitch = 17 * kDegree};
    const std::vector<std::size_t> around =
        rail ? std::vector<std::size_t>{1, 2} : std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6, 7};
    double best = kNoMotion, tolerant = kNoMotion;
    for (const std::size_t i : around) {
      const BodyMotion m = motion_of(scene, o.grid.drop(i), a.cells[i]);
      best = std::min(best, peak_of(scene, drop, m)), tolerant = std::min(tolerant, worst_in_box(scene, drop, m));
    }
    BodyAtlasReader reader(path, scene, {.goal = Goal::kPeak, .deadline = 30});
    const BodyAtlasEntry entry = reader.at(drop);
    REQUIRE(entry.found);
    CHECK(entry.inside);
    CHECK(entry.starts.size() == around.size());
    CHECK(entry.value == Approx(best).epsilon(1e-3));
    CHECK(peak_of(scene, drop, entry.motion) == Approx(best).epsilon(1e-3));
    CHECK(peak_of(scene, drop, entry.motion) < peak_of(scene, drop, held_posture(scene)));
    const BodyAtlasEntry safe = BodyAtlasReader(path, scene, {.deadline = 30}).at(drop);
    CHECK(safe.value == Approx(tolerant).epsilon(1e-3));

    // The planner that starts there is no worse.
    BodyPlanner planner(scene, {.goal = Goal::kPeak, .threads = 1});
    planner.start(entry.starts);
    const BodyAnswer plan = planner.plan(drop, 0.3);
    REQUIRE(plan.found());
    CHECK(plan.plan.value <= best * (1 + 1e-3));

    // A fall that has begun is that from the greater height.
    const double v = -1, g = scene.robot.gravity;
    Drop begun = drop;
    begun.height -= v * v / (2 * g), begun.vertical_speed = v;
    const BodyAtlasEntry falling = reader.at(begun);
    CHECK(falling.inside);
    CHECK(falling.drop == entry.drop);
    CHECK(falling.value == Approx(entry.value).epsilon(1e-3));

    Drop far = drop;
    far.height = 0.7;
    const BodyAtlasEntry outside = reader.at(far);
    CHECK_FALSE(outside.inside);
    CHECK(outside.found);
    CHECK((outside.holds || outside.drop == a.header.safest.drop));
    // No time: a motion, and no value.
    const BodyAtlasEntry late = BodyAtlasReader(path, scene, {.deadline = 1e-9}).at(drop);
    CHECK(late.found);
    CHECK(late.value == kNoMotion);
  }
}

TEST_CASE("legs: a reader holds the posture where every motion around lands harder, by each goal") {
  const test::Folder f;
  const BodyScene scene = shipped("hopper");
  Atlas a = planned(scene, hopper_grid());
  for (AtlasCell& c : a.cells) c.values = {0, 0, -10 * kDegree, -10 * kDegree, 0.5};  // straight
  const std::string path = f.write("atlas.bin", atlas_bytes(a));
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant})
    for (const double height : {0.3, 0.7}) {
      BodyAtlasReader reader(path, scene, {.goal = goal, .deadline = 30});
      const BodyAtlasEntry entry = reader.at(Drop{.height = height});
      BodyScene here = scene;
      here.drop.height = height;
      REQUIRE(entry.found);
      CHECK(entry.holds);
      for (std::size_t i = 0; i < entry.motion.size(); ++i)
        CHECK(entry.motion[i].phi_f == Approx(held_posture(here)[i].phi_f));
      const double held = goal == Goal::kPeak ? peak_of(scene, here.drop, held_posture(here))
                                              : worst_in_box(scene, here.drop, held_posture(here));
      CHECK(entry.value == Approx(held).epsilon(1e-3));
    }
  // In the air holding is to stand where the joints are.
  BodyAtlasReader reader(path, scene, {.goal = Goal::kPeak, .deadline = 0.02});
  int holding = 0;
  for (const double height : {0.001, 0.25}) {
    BodyFallState state{.height = height, .elapsed = 0.1};
    for (const Motion& m : held_posture(scene)) state.joints.push_back({m.phi_i + 0.02, 0});
    const BodyAtlasEntry entry = reader.at(state);
    BodyScene here = scene;
    here.drop = {.height = height, .vertical_speed = -0.1 * scene.robot.gravity};
    here.release = BodyRelease{state.joints, 0.02};
    CHECK(entry.value <= simulate(here, held_posture(here)).peak * (1 + 1e-3));
    CHECK(entry.value == Approx(simulate(here, entry.motion).peak).epsilon(1e-3));
    holding += entry.holds;
    for (std::size_t i = 0; i < entry.motion.size(); ++i)
      if (entry.holds && scene.robot.joints[i].driven()) CHECK(entry.motion[i].phi_i == state.joints[i].phi);
  }
  CHECK(holding > 0);
}

TEST_CASE("legs: a reader answers a fall with every joint's move in the air, and refuses what cannot be") {
  const test::Folder f;
  const BodyScene scene = shipped("hopper");
  const AtlasOptions o = hopper_grid();
  const Atlas a = planned(scene, o);
  BodyAtlasReader reader(f.write("atlas.bin", atlas_bytes(a)), scene, {.goal = Goal::kPeak, .deadline = 0.02});
  const std::size_t second = 1;  // the grid's drop from 0.25 m; the joints are near its motion's start
  BodyFallState state{.height = 0.25, .elapsed = 0.1};
  for (const Motion& m : motion_of(scene, o.grid.drop(second), a.cells[second]))
    state.joints.push_back({m.phi_i + 0.02, 0.1});
  const BodyAtlasEntry entry = reader.at(state);
  REQUIRE(entry.found);
  CHECK(entry.inside);
  BodyScene here = scene;
  here.drop = {.height = 0.25, .vertical_speed = -0.1 * scene.robot.gravity};
  here.release = BodyRelease{state.joints, 0.02};
  CHECK(simulate(here, entry.motion).peak == Approx(entry.value).epsilon(1e-3));
  CHECK(entry.value < simulate(here, held_posture(here)).peak);
  const BodyMotion planned_there = motion_of(scene, o.grid.drop(entry.drop), a.cells[entry.drop]);
  for (std::size_t i = 0; i < entry.motion.size(); ++i) {
    if (!scene.robot.joints[i].driven()) continue;
    const Motion& m = entry.motion[i];
    REQUIRE(m.reposition);
    CHECK(m.reposition->phi == state.joints[i].phi);
    CHECK(m.reposition->from == 0.02);
    CHECK(m.reposition->to <= fall_time(here));
    CHECK(m.phi_i == Approx(planned_there[i].phi_i).margin(1e-12));
    CHECK(m.phi_f == Approx(planned_there[i].phi_f).margin(1e-12));
  }
  const auto wrong = [&](const BodyFallState& s) {
    const BodyAtlasEntry e = reader.at(s);
    CHECK_FALSE(e.found);
    return e.wrong;
  };
  BodyFallState bad = state;
  bad.height = std::nan("");
  CHECK_THAT(wrong(bad), Contains("height: 0 to 1e4 m"));
  bad = state, bad.joints.pop_back();
  CHECK_THAT(wrong(bad), Contains("joints: "));
  bad = state, bad.vertical_speed = 2e3;
  CHECK_THAT(wrong(bad), Contains("vertical_speed: "));
}

TEST_CASE("legs: a reader refuses the atlas of another robot, of other motions, of a shard, of the paper's robot") {
  const test::Folder f;
  const BodyScene scene = shipped("hopper");
  const Atlas a = planned(scene, hopper_grid());
  const std::string path = f.write("atlas.bin", atlas_bytes(a));
  const auto refusal = [&](const std::string& file, const BodyScene& s) {
    return test::refusal([&] { BodyAtlasReader reader(file, s); });
  };
  BodyScene other = scene;
  other.robot.links[1].mass *= 1.1;
  CHECK_THAT(refusal(path, other), Contains("atlas.bin: it was planned for another robot, floor or actuator"));
  other = scene, other.freedom.bumps = 1;
  CHECK_THAT(refusal(path, other), Contains("atlas.bin: its motions have other variables"));
  CHECK_THAT(refusal(path, shipped("foot")), Contains("atlas.bin: "));
  CHECK_THAT(refusal(UKEMI_SOURCE "/test/data/atlas_version_2.bin", scene), Contains("other variables"));
  other = scene, other.drop.height = 0.2;
  CHECK(refusal(path, other) == "");
  Atlas part = a;
  part.cells[1].state = AtlasCell::State::kOpen;
  CHECK_THAT(refusal(f.write("part.bin", atlas_bytes(part)), scene), Contains("part.bin: drops of it are not planned"));
  const std::string bytes = atlas_bytes(a);
  CHECK_THAT(refusal(f.write("cut.bin", bytes.substr(0, bytes.size() - 1)), scene), Contains("cut.bin: "));
  std::string changed = bytes;
  changed[sizeof(AtlasHeader) + 40] = char(changed[sizeof(AtlasHeader) + 40] ^ 1);
  CHECK_THAT(refusal(f.write("changed.bin", changed), scene),
             Contains("changed.bin: its bytes are not those of its checksum"));
}
