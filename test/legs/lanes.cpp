// Landings of robots of links in lanes are those of the scalar path, whatever falls beside them and on whatever
// machine.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/random.hpp"
#include "landing/body/load.hpp"
#include "landing/lanes/body_batch.hpp"
#include "landing/plan/body_drops.hpp"
#include "landing/scatter/sampler.hpp"
#include "test/legs/robots.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {

/// Motions of a robot from its scene's ranges.
std::vector<BodyMotion> motions_of(const BodyScene& scene, int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<BodyMotion> out;
  for (int n = 0; n < count; ++n) {
    BodyMotion m = held_posture(scene);
    for (std::size_t i = 0; i < m.size(); ++i) {
      if (!scene.robot.joints[i].driven()) continue;
      const auto [low, high] = scene.search[i].phi;
      m[i].phi_i = random.uniform(low, high), m[i].phi_f = random.uniform(low, high);
      m[i].duration = random.uniform(0.1, 0.5);
      if (n % 3 == 1) m[i].bumps = {random.uniform(-0.3, 0.3), random.uniform(-0.2, 0.2), 0, 0};
      if (n % 3 == 2) m[i].gain_p = random.uniform(0.5, 1.5), m[i].gain_d = random.uniform(0.5, 1.5);
    }
    out.push_back(m);
  }
  return out;
}

struct Played {
  std::vector<BodyLanding> landings;
  int off = 0;  ///< of the scalar path by more than a thousandth
};
Played in_lanes(const BodyScene& scene, const std::vector<BodyMotion>& motions, InstructionSet set, int threads = 1) {
  std::vector<BodyBatchCase> cases;
  for (const BodyMotion& m : motions) cases.push_back({&scene, &m});
  Played out{.landings = std::vector<BodyLanding>(motions.size())};
  body_batch_peaks(cases, out.landings, {.accuracy = 1e-7}, threads, set);
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const BodyLanding one = peak_acceleration(scene, motions[k], {.accuracy = 1e-9});
    const BodyLanding& l = out.landings[k];
    CHECK(l.end == one.end);
    CHECK(l.contacts.first() == Approx(one.contacts.first()).epsilon(1e-6));
    CHECK(l.contacts.first_point() == one.contacts.first_point());
    const bool off = !(std::abs(l.peak / one.peak - 1) < 1e-3);
    out.off += off;
    if (off) continue;
    REQUIRE(l.contacts.size() > 0);
    REQUIRE(l.peak_contact >= 0);
    CHECK(l.peak_contact == one.peak_contact);  // later touches are those of a robot that falls over
    for (int i = 0; i <= l.peak_contact; ++i) CHECK(l.contacts[i] == one.contacts[i]);
    CHECK(l.joint_lost == one.joint_lost);
  }
  return out;
}

}  // namespace

TEST_CASE("legs: lanes are the scalar path, on every machine, whatever the number of threads") {
  for (const std::string name : {"hopper", "three_links", "foot"}) {
    BodyScene scene = legs::shipped(name);
    const std::vector<BodyMotion> motions = motions_of(scene, 60, 20261125);
    INFO(name);
    const Played baseline = in_lanes(scene, motions, InstructionSet::kBaseline);
    CHECK(baseline.off <= 1);  // a cliff is one for any accuracy
    for (const InstructionSet set : {InstructionSet::kAvx2, InstructionSet::kAvx512}) {
      const Played wide = in_lanes(scene, motions, set, 2);
      for (std::size_t k = 0; k < motions.size(); ++k)
        CHECK(wide.landings[k].peak == Approx(baseline.landings[k].peak).epsilon(1e-3));
    }
  }
}

TEST_CASE("legs: lanes of robots with pads, slopes, delays, moves in the air, torque limits and every base") {
  int off = 0, played = 0;
  for (const std::string prefix : {"leg_", "floor_"})
    for (int i = 0; i < (prefix == "leg_" ? 60 : 40); ++i) {
      const std::string number = std::to_string(i), stem = UKEMI_DATASETS "/reference/legs/" + prefix +
                                                           std::string(3 - number.size(), '0') + number;
      BodyScene scene = read_body_scene(stem + ".toml");
      const BodyMotion motion = read_body_motion(stem + "_motion.toml", scene.robot);
      if (i % 2) scene.detection_delay = 0.003;
      const BodyBatchCase c{&scene, &motion};
      BodyLanding l;
      body_batch_peaks({&c, 1}, {&l, 1}, {.accuracy = 1e-7});
      const BodyLanding one = peak_acceleration(scene, motion, {.accuracy = 1e-10});
      INFO(stem);
      CHECK(no_landing(l.end) == no_landing(one.end));  // a lane asks less often whether it may rest
      CHECK(l.contacts.first() == Approx(one.contacts.first()).epsilon(1e-6));
      ++played, off += !(std::abs(l.peak / one.peak - 1) < 1e-4);
      if (std::abs(l.peak / one.peak - 1) > 1e-4) WARN(stem << ": " << l.peak << " in a lane, " << one.peak);
    }
  CHECK(played == 100);
  CHECK(off <= 3);
}

TEST_CASE("legs: lanes end thousands of landings that all but coincide: guards that start on zero, within rounding") {
  for (const std::string name : {"hopper", "three_links"}) {
    const BodyScene scene = legs::shipped(name);
    const BodyMotion held = held_posture(scene);
    for (const double inflate : {0.0, 1.0}) {  // 0.0 has drops, 1.0 drives too, that once stuck on a rail's friction
      const BodyDropModel model(scene, scatter_for({}, scene), {.inflate = inflate});
      const std::vector<BodyDrop> drops = model.independent(2048, fresh_seed(1));
      std::vector<BodyMotion> played;
      std::vector<BodyBatchCase> cases;
      played.reserve(drops.size());
      for (const BodyDrop& d : drops) cases.push_back({&d.scene, &played.emplace_back(d.played(held))});
      std::vector<BodyLanding> landings(drops.size());
      body_batch_peaks(cases, landings, {.accuracy = 1e-6}, 2);
      long most = 0;
      for (const BodyLanding& l : landings) {
        CHECK_FALSE(no_landing(l.end));
        most = std::max(most, l.work.steps);
      }
      INFO(name << ", inflate " << inflate);
      CHECK(most < 2000);
    }
  }
}

TEST_CASE("legs: a lane's landing is abandoned, forbidden to touch, or handed over, as the scalar path's") {
  BodyScene scene = legs::shipped("hopper");
  const std::vector<BodyMotion> motions = motions_of(scene, 24, 7);
  std::vector<BodyBatchCase> cases;
  for (const BodyMotion& m : motions) cases.push_back({&scene, &m, 60});
  std::vector<BodyLanding> landings(cases.size());
  const auto compare = [&] {
    body_batch_peaks(cases, landings, {.accuracy = 1e-7});
    int ended = 0;
    for (std::size_t k = 0; k < cases.size(); ++k) {
      const BodyLanding one =
          peak_acceleration(scene, motions[k], {.accuracy = 1e-7, .abandon_above = cases[k].abandon_above});
      INFO(k << ": " << landings[k].peak << ", " << one.peak << ", until " << landings[k].t_end << ", " << one.t_end);
      CHECK(landings[k].end == one.end);
      CHECK(landings[k].broken.load == one.broken.load);
      ended += one.end == End::kAbandoned || one.end == End::kBroken;
    }
    return ended;
  };
  CHECK(compare() > 8);
  for (BodyBatchCase& c : cases) c.abandon_above = std::numeric_limits<double>::infinity();
  forbid(scene, {"knee"});
  scene.ends_broken = true;
  CHECK(compare() > 0);
  scene.ends_broken = false;
  CHECK(compare() == 0);
  set_limit(scene, limit(scene.robot, Load::Kind::kMotorSpeed, 0, 5));
  compare();
  for (ContactPoint& c : scene.robot.contacts) c.law.hunt_crossley = true, c.law.dissipation = 0.3;
  compare();
  const std::function<bool()> over = [] { return true; };
  body_batch_peaks(cases, landings, {.over = &over});
  for (const BodyLanding& l : landings) CHECK(l.end == End::kStopped);
}

TEST_CASE("legs: kernels that leave out what a robot has not give its peaks") {
  const std::vector<std::pair<std::string, SeaParameters<double>>> drives = [] {
    SeaParameters<double> plain = legs::shipped("three_links").robot.joints[0].sea, friction = plain, output = plain;
    friction.friction = 0.3, friction.spring_loss = 0.05, friction.output_viscous = 0.02;
    output.output_friction = 0.2, output.friction = 0.1;
    return std::vector<std::pair<std::string, SeaParameters<double>>>{
        {"plain", plain}, {"friction", friction}, {"output friction", output}};
  }();
  for (const std::string name : {"paper", "three_links"})
    for (const auto& [words, sea] : drives) {
      BodyScene scene = name == "paper" ? read_body_scene(UKEMI_DATASETS "/scenes/paper.toml",
                                                          {{"", UKEMI_DATASETS "/actuators/table2.toml"}})
                                        : legs::shipped(name);
      for (Joint& j : scene.robot.joints) j.sea = sea;
      BodyScene general = scene;
      general.robot.contacts[0].at.across = 1e-15;  // off the axis, which no kernel of straight links has
      const std::vector<BodyMotion> motions = motions_of(scene, 24, 20261128);
      std::vector<BodyBatchCase> cases, of_general;
      for (const BodyMotion& m : motions) cases.push_back({&scene, &m}), of_general.push_back({&general, &m});
      std::vector<BodyLanding> lanes(cases.size()), general_lanes(cases.size());
      body_batch_peaks(cases, lanes, {.accuracy = 1e-7}),
          body_batch_peaks(of_general, general_lanes, {.accuracy = 1e-7});
      int off = 0;
      for (std::size_t k = 0; k < cases.size(); ++k) {
        const double one = peak_acceleration(scene, motions[k]).peak,
                     other = peak_acceleration(general, motions[k]).peak;
        off += !(std::abs(one / other - 1) < 1e-6) || !(std::abs(lanes[k].peak / general_lanes[k].peak - 1) < 1e-4);
      }
      INFO(name << ", " << words);
      CHECK(off <= 1);  // a cliff is one for any accuracy
    }
}

TEST_CASE("legs: loads and limits in lanes are those of the scalar path") {
  using Kind = Load::Kind;
  for (const std::string name : {"hopper", "three_links", "foot"}) {
    BodyScene scene = legs::shipped(name);
    const int joint = 0, contact = int(scene.robot.contacts.size()) - 1;
    const auto add = [&](Kind kind, int index, double rating, bool limit = false) {
      scene.loads.push_back({.name = landing::name(kind),
                             .kind = kind,
                             .index = index,
                             .phi = {0.2, 0.5},
                             .rating = rating,
                             .limit = limit});
      scene.loads.back().at = {0.05, 0.01};
    };
    for (const Kind k : {Kind::kTorque, Kind::kMotorSpeed, Kind::kMotorTorque, Kind::kAngle}) add(k, joint, 1);
    if (scene.robot.joints[0].kind == DriveKind::kElastic) add(Kind::kDeflection, joint, 1);
    add(Kind::kForce, contact, 1), add(Kind::kAcceleration, 1, 1), add(Kind::kTouch, 0, 0, true);
    add(Kind::kImpulse, contact, 1), add(Kind::kImpulse, 0, 1);
    scene.t_end = 0.8;  // of a touch that does not end before
    scene.loads.push_back({.name = "own",
                           .kind = Kind::kAcceleration,
                           .index = scene.robot.peak_link,
                           .at = scene.robot.peak,
                           .rating = 1});
    const std::vector<BodyMotion> motions = motions_of(scene, 40, 3);
    std::vector<BodyLanding> scalar;
    for (const BodyMotion& m : motions) scalar.push_back(peak_acceleration(scene, m, {.accuracy = 1e-9}));
    const auto close = [](double a, double b) { return std::abs(a - b) <= 1e-3 * std::abs(b) + 1e-6; };
    for (const InstructionSet set : {InstructionSet::kBaseline, InstructionSet::kAvx2}) {
      INFO(name << ", set " << int(set));
      std::vector<BodyLanding> lanes(motions.size());
      std::vector<BodyBatchCase> all;
      for (const BodyMotion& m : motions) all.push_back({&scene, &m});
      body_batch_peaks(all, lanes, {.accuracy = 1e-7}, 1, set);
      int handed_over = 0;
      for (std::size_t k = 0; k < motions.size(); ++k)
        handed_over += lanes[k].peak == peak_acceleration(scene, motions[k], {.accuracy = 1e-7}).peak;
      CHECK(handed_over < 10);  // a peak early in a landing may be the same in every digit
      std::vector<int> off(scene.loads.size(), 0);
      for (std::size_t k = 0; k < motions.size(); ++k)
        for (std::size_t i = 0; i < scene.loads.size(); ++i)
          off[i] += !close(lanes[k].loads[i].value, scalar[k].loads[i].value);
      for (std::size_t i = 0; i < off.size(); ++i) {
        INFO(scene.loads[i].name);
        CHECK(off[i] <= 1);  // one that stands beside a cliff
      }
    }
    // As limits, at the median of what the motions take: the same are broken, by the same.
    for (std::size_t i = 0; i < scene.loads.size(); ++i) {
      std::vector<double> values;
      for (const BodyLanding& l : scalar) values.push_back(l.loads[i].value);
      std::nth_element(values.begin(), values.begin() + 20, values.end());
      BodyScene limited = scene;
      limited.loads = {scene.loads[i]};
      limited.loads[0].limit = true, limited.loads[0].rating = values[20] * (1 + 1e-6);
      if (scene.loads[i].kind == Kind::kTouch) continue;
      limited.ends_broken = true;
      std::vector<BodyLanding> lanes(motions.size());
      std::vector<BodyBatchCase> cases;
      for (const BodyMotion& m : motions) cases.push_back({&limited, &m});
      body_batch_peaks(cases, lanes, {.accuracy = 1e-7}, 1, fastest_instruction_set(motions.size()));
      int differ = 0, broken = 0;
      for (std::size_t k = 0; k < motions.size(); ++k) {
        const BodyLanding one = peak_acceleration(limited, motions[k], {.accuracy = 1e-9});
        differ += bool(one.broken) != bool(lanes[k].broken), broken += bool(one.broken);
      }
      INFO(name << ": " << scene.loads[i].name);
      CHECK(differ <= 2);
      const auto beyond =
          std::count_if(values.begin(), values.end(), [&](double v) { return v > limited.loads[0].rating; });
      CHECK(std::abs(broken - int(beyond)) <= 1);
    }
  }
}

TEST_CASE("legs: limits of joints in lanes are those of the scalar path") {
  BodyScene scene = legs::shipped("hopper");
  using Kind = Load::Kind;
  set_limit(scene, limit(scene.robot, Kind::kMotorSpeed, 1, 12));
  set_limit(scene, limit(scene.robot, Kind::kMotorTorque, 0, 11));
  set_limit(scene, limit(scene.robot, Kind::kAngle, 1, 0, {-2.4, -0.1}));
  set_limit(scene, limit(scene.robot, Kind::kReferenceRate, 0, 20));
  for (const bool ends : {true, false}) {
    scene.ends_broken = ends;
    const std::vector<BodyMotion> motions = motions_of(scene, 200, 5);
    std::vector<BodyLanding> lanes(motions.size());
    std::vector<BodyBatchCase> cases;
    for (const BodyMotion& m : motions) cases.push_back({&scene, &m});
    body_batch_peaks(cases, lanes, {.accuracy = 1e-7}, 1, fastest_instruction_set(motions.size()));
    std::array<int, 3> count{};  // kept by both, broken in both, otherwise
    for (std::size_t k = 0; k < motions.size(); ++k) {
      const BodyLanding one = peak_acceleration(scene, motions[k], {.accuracy = 1e-9});
      ++count[one.broken && lanes[k].broken ? 1 : one.broken || lanes[k].broken ? 2 : 0];
      if (ends && one.broken && lanes[k].broken) CHECK(one.end == lanes[k].end);
      if (ends) continue;  // where a run goes on, both have the rate of the reference
      CHECK(lanes[k].loads[3].value == Approx(one.loads[3].value).epsilon(1e-6));
    }
    CAPTURE(count[0], count[1], count[2]);
    CHECK((count[0] > 10 && count[1] > 10));
    CHECK(count[2] <= 1);  // one that stands beside a limit
  }
}
