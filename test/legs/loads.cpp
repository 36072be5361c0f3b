// Loads of robots of links: each against an independent reading of a fine trajectory, and what plans make of them.
#include <catch2/catch.hpp>
#include <cmath>

#include "common/degrees.hpp"
#include "landing/body/load.hpp"
#include "landing/lanes/body_batch.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/plan/body_plan.hpp"
#include "landing/plan/body_risk.hpp"
#include "test/folder.hpp"
#include "test/legs/robots.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using legs::shipped;
using Kind = Load::Kind;

namespace {

constexpr double kRate = 1e5;  // of the trajectories that are read [Hz]

BodyScene paper() {
  return legs::long_paper(read_scene(UKEMI_DATASETS "/scenes/paper.toml"),
                          read_actuator(UKEMI_DATASETS "/actuators/table2.toml"));
}

/// The largest of v over rows, by the parabola through the three rows at a top; events have two rows at one time.
double largest(const std::vector<double>& t, const std::vector<double>& v) {
  double out = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    out = std::max(out, v[i]);
    if (i == 0 || i + 1 == v.size() || v[i] < v[i - 1] || v[i] < v[i + 1]) continue;
    const double a = t[i] - t[i - 1], b = t[i + 1] - t[i];
    if (std::abs(a - 1 / kRate) > 1e-9 || std::abs(b - 1 / kRate) > 1e-9) continue;
    const double bend = v[i - 1] - 2 * v[i] + v[i + 1], slope = 0.5 * (v[i + 1] - v[i - 1]);
    if (bend < 0) out = std::max(out, v[i] - slope * slope / (2 * bend));
  }
  return out;
}
/// The derivative of a smooth column, by five rows of equal distance; elsewhere 0.
std::vector<double> rate_of(const std::vector<double>& t, const std::vector<double>& v) {
  std::vector<double> out(v.size(), 0);
  for (std::size_t i = 2; i + 2 < v.size(); ++i)
    if (std::abs(t[i + 2] - t[i - 2] - 4 / kRate) < 1e-9 && t[i + 1] > t[i] && t[i] > t[i - 1])
      out[i] = std::abs(8 * (v[i + 1] - v[i - 1]) - (v[i + 2] - v[i - 2])) * kRate / 12;
  return out;
}

struct Reading {
  std::vector<double> t;
  const BodyLanding& l;
  explicit Reading(const BodyLanding& landing) : l(landing) {
    for (const BodySample& s : l.trajectory) t.push_back(s.t);
  }
  template <class F>
  std::vector<double> column(F&& f) const {
    std::vector<double> out;
    for (const BodySample& s : l.trajectory) out.push_back(f(s));
    return out;
  }
  template <class F>
  double most(F&& f) const {
    return largest(t, column(f));
  }
  /// Of one contact, over each touch of it: the norm of the integral of its force.
  double impulse(std::size_t contact) const {
    double out = 0;
    for (const Touch& touch : l.touches) {
      if (touch.point != int(contact)) continue;
      const double end = std::isnan(touch.t_liftoff) ? l.t_end : touch.t_liftoff;
      double x = 0, y = 0;
      for (std::size_t i = 1; i < t.size(); ++i) {
        const BodySample &a = l.trajectory[i - 1], &b = l.trajectory[i];
        if (a.t < touch.t_touchdown || b.t > end) continue;
        x += 0.5 * (b.t - a.t) * (a.force_x[contact] + b.force_x[contact]);
        y += 0.5 * (b.t - a.t) * (a.force_y[contact] + b.force_y[contact]);
      }
      out = std::max(out, std::hypot(x, y));
    }
    return out;
  }
};

Load load(Kind kind, int index, double rating = 1) {
  return {.name = name(kind), .kind = kind, .index = index, .rating = rating};
}
BodyMotion moved(const BodyScene& scene) {
  BodyMotion out = held_posture(scene);
  for (std::size_t i = 0; i < out.size(); ++i) out[i].phi_f += i == 0 ? 0.4 : -0.5, out[i].duration = 0.25;
  return out;
}
BodyScene with_loads(BodyScene scene) {
  const int joint = int(scene.robot.joints.size()) - 1, contact = int(scene.robot.contacts.size()) - 1;
  for (const Kind k : {Kind::kTorque, Kind::kDeflection, Kind::kMotorSpeed, Kind::kMotorTorque, Kind::kAngle})
    if (k != Kind::kDeflection || scene.robot.joints[std::size_t(joint)].kind == DriveKind::kElastic)
      scene.loads.push_back(load(k, joint));
  for (const Kind k : {Kind::kForce, Kind::kImpulse, Kind::kTouch}) scene.loads.push_back(load(k, contact));
  scene.loads.back().limit = true;
  scene.loads.push_back(load(Kind::kAcceleration, int(scene.robot.links.size()) - 1));
  for (Load& l : scene.loads) {
    l.phi = {-1.2, -0.9};
    if (l.kind == Kind::kAcceleration) l.at = {0.1, 0.02};
  }
  scene.t_end = 1.0;  // the impulse of a foot that stays down ends there
  return scene;
}
double value(const BodyScene& scene, const BodyLanding& l, Kind kind) {
  for (std::size_t i = 0; i < scene.loads.size(); ++i)
    if (scene.loads[i].kind == kind) return l.loads[i].value;
  return -1;
}

}  // namespace

TEST_CASE("legs: every load is what a fine trajectory shows") {
  for (const char* name : {"three_links", "hopper"}) {
    const BodyScene scene = with_loads(shipped(name));
    const BodyMotion motion = moved(scene);
    const BodyLanding l = simulate(scene, motion, {.accuracy = 1e-11}, kRate);
    REQUIRE(l.loads.size() == scene.loads.size());
    const Reading r(l);
    const std::size_t j = scene.robot.joints.size() - 1, c = scene.robot.contacts.size() - 1;
    const Joint& joint = scene.robot.joints[j];
    INFO(name);
    const auto is = [&](Kind kind, double read) {
      INFO(landing::name(kind) << ": " << value(scene, l, kind) << ", read " << read);
      CHECK(value(scene, l, kind) == Approx(read).epsilon(1e-6));
      CHECK(value(scene, l, kind) > 0);
    };
    is(Kind::kForce, r.most([&](auto& s) { return std::hypot(s.force_x[c], s.force_y[c]); }));
    is(Kind::kImpulse, r.impulse(c));
    is(Kind::kAngle, r.most([&](auto& s) {
      return std::max({0.0, s.phi[j] - scene.loads[0].phi[1], scene.loads[0].phi[0] - s.phi[j]});
    }));
    is(Kind::kTorque, r.most([&](auto& s) { return std::abs(s.tau[j]); }));  // no friction, no parallel spring
    if (joint.kind == DriveKind::kElastic)
      is(Kind::kMotorSpeed, largest(r.t, rate_of(r.t, r.column([&](auto& s) { return s.phi_m[j]; }))));
    else
      is(Kind::kMotorSpeed, r.most([&](auto& s) { return std::abs(s.dphi[j]); }));
    if (joint.kind == DriveKind::kElastic)
      is(Kind::kDeflection, r.most([&](auto& s) { return std::abs(s.phi_m[j] - s.phi[j]); }));
    is(Kind::kTouch, 1);
    for (std::size_t i = 0; i < scene.loads.size(); ++i)
      if (scene.loads[i].kind == Kind::kTouch)
        CHECK(l.loads[i].t == std::find_if(l.touches.begin(), l.touches.end(), [&](auto& t) {
                                return t.point == int(c);
                              })->t_touchdown);
    BodyScene other = shipped(name);  // the acceleration: of the robot whose peak is taken there
    other.t_end = scene.t_end;
    other.robot.peak_link = scene.loads.back().index, other.robot.peak = scene.loads.back().at;
    const BodyLanding there = simulate(other, motion, {.accuracy = 1e-11}, kRate);
    is(Kind::kAcceleration, Reading(there).most([](auto& s) { return s.acc; }));
    CHECK(l.peak == simulate(shipped(name), motion, {.accuracy = 1e-11}).peak);
  }
}

TEST_CASE("legs: a motor's torque as a load is Eq. 3 of the trajectory, and rest does not hide a load") {
  BodyScene scene = shipped("three_links");
  scene.loads = {load(Kind::kMotorTorque, 1), load(Kind::kTorque, 1)};
  scene.t_end = 3;
  const BodyMotion held = held_posture(scene);  // the reference stands
  const BodyLanding l = simulate(scene, held, {.accuracy = 1e-11}, kRate);
  const Reading r(l);
  const SeaParameters<double>& sea = scene.robot.joints[1].sea;
  const double torque =
      r.most([&](auto& s) { return std::abs(sea.k_p * (held[1].phi_i - s.phi[1]) - sea.k_d * s.dphi[1]); });
  CHECK(l.loads[0].value == Approx(torque).epsilon(1e-6));
  const BodyLanding on = simulate(scene, held, {.accuracy = 1e-11, .rest = SimulateOptions::Rest::kIgnore});
  for (std::size_t i = 0; i < 2; ++i) CHECK(l.loads[i].value == Approx(on.loads[i].value).epsilon(1e-6));
  BodyScene hopper = shipped("hopper");  // a motor that is at its limit does not pass a rating that is the same
  hopper.loads = {load(Kind::kTorque, 1, 12), load(Kind::kMotorTorque, 1, 12)};
  for (Load& x : hopper.loads) x.limit = true;
  const BodyLanding limited = simulate(hopper, held_posture(hopper));
  CHECK(limited.loads[0].value == 12);
  CHECK(limited.loads[1].value == 12);
  CHECK_FALSE(limited.broken);
}

TEST_CASE("legs: the acceleration that counts, rated 1, is no other plan, and another rating scales its value alone") {
  const BodyScene plain = shipped("hopper");
  BodyScene scene = plain;
  scene.loads = {load(Kind::kAcceleration, plain.robot.peak_link)};
  scene.loads[0].at = plain.robot.peak;
  CHECK_FALSE(observed(scene));
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
    const BodyPlanOptions options{.goal = goal, .evaluations = 300, .seed = 4};
    const BodyPlan a = plan(plain, options), b = plan(scene, options);
    CHECK(a.value == b.value);
    CHECK(a.landing.peak == b.landing.peak);
    for (std::size_t i = 0; i < a.motion.size(); ++i) CHECK(a.motion[i].phi_f == b.motion[i].phi_f);
  }
  const BodyPlanOptions robust{.measure = Measure{}, .samples = 8, .judging = 8, .fresh = 0, .evaluations = 800};
  CHECK(plan(plain, robust).value == plan(scene, robust).value);
  scene.loads[0].rating = 50;
  const BodyPlan c = plan(scene, {.evaluations = 300, .seed = 4});
  CHECK(c.value == Approx(c.landing.peak / 50));
}

TEST_CASE("legs: a plan makes the largest part of a rating small, and keeps limits that the peak's plan breaks") {
  BodyScene scene = shipped("hopper");
  scene.loads = {load(Kind::kAcceleration, scene.robot.peak_link, 40), load(Kind::kForce, 2, 250)};
  scene.loads[0].at = scene.robot.peak;
  const BodyPlanOptions options{.evaluations = 400, .seed = 3};
  const BodyPlan both = plan(scene, options);
  REQUIRE(both.found);
  CHECK(both.value < 0.7 * both.held_value);  // the foot's force at the touchdown itself cannot be reduced
  CHECK(both.value == worth(scene, both.landing));
  CHECK(both.value == std::max(both.landing.loads[0].value / 40, both.landing.loads[1].value / 250));

  scene.loads.pop_back();
  scene.loads.push_back(load(Kind::kMotorSpeed, 1, 0));
  scene.loads[1].limit = true, scene.loads[1].rating = 1e3;
  const BodyPlan loose = plan(scene, options);
  scene.loads[1].rating = 0.8 * loose.landing.loads[1].value;
  const BodyPlan kept = plan(scene, options);
  REQUIRE(kept.found);
  CHECK(kept.landing.loads[1].value <= scene.loads[1].rating);
  CHECK_FALSE(kept.landing.broken);
  const BodyLanding broken = simulate(scene, loose.motion);
  CHECK(broken.broken.load == 1);
}

TEST_CASE("legs: limits hold in the share of fresh drops that was asked for, and risk tells each load") {
  BodyScene scene = shipped("hopper");
  scene.scatter = Scatter{.height = 0.02, .phi = 0.02};
  const int knee = 1;
  scene.loads = {load(Kind::kMotorSpeed, knee)};
  const double held = simulate(scene, held_posture(scene)).loads[0].value;
  scene.loads[0].limit = true, scene.loads[0].rating = 0.9 * held;
  const BodyPlan p = plan(scene, {.measure = Measure{},
                                  .share = 0.95,
                                  .samples = 16,
                                  .judging = 64,
                                  .fresh = 1000,
                                  .evaluations = 6000,
                                  .seed = 2});
  REQUIRE(p.found);
  REQUIRE(p.under);
  const double error = std::sqrt(0.95 * 0.05 / 1000);
  CHECK(double(p.under->broken) / 1000 <= 0.05 + 3 * error);
  CHECK(p.under->exceeded == std::vector<long>{p.under->broken});
  const BodyRisk risk = body_risk(scene, held_posture(scene), {.samples = 64});
  REQUIRE(risk.events.size() == 1);
  CHECK(risk.events[0].kind == RiskEvent::Kind::kLoad);
  CHECK(risk.events[0].drops > 32);  // the held posture is beyond it in its own drop
  CHECK(risk.broken == risk.events[0].drops);
  CHECK_THROWS_WITH(plan(scene, {.share = 0.9}), Catch::Matchers::Contains("share"));
  scene.loads.clear();
  CHECK_THROWS_WITH(plan(scene, {.measure = Measure{}, .share = 0.9}), Catch::Matchers::Contains("no limit to keep"));
}

TEST_CASE("legs: a limit that binds is kept in 0.99 of 10,000 fresh drops, on three scenes") {
  struct Case {
    const char* name;
    Kind kind;
    int joint;
  };
  for (const Case& c : {Case{"hopper", Kind::kMotorSpeed, 1}, Case{"three_links", Kind::kTorque, 1},
                        Case{"paper", Kind::kDeflection, 0}}) {
    BodyScene scene = std::string(c.name) == "paper" ? paper() : shipped(c.name);
    scene.scatter = Scatter{.pitch = 0.02, .height = 0.01, .phi = 0.01};
    if (scene.robot.base != Base::kFree) scene.scatter->pitch = 0;
    scene.loads = {load(c.kind, c.joint, 1e6)};
    BodyPlanOptions o{.measure = Measure{}, .fresh = 10'000, .evaluations = 40'000, .seed = 5};
    BodyPlanOptions first = o;
    first.fresh = 0;
    scene.loads.push_back(load(Kind::kAcceleration, scene.robot.peak_link, 1));
    scene.loads[1].at = scene.robot.peak;
    scene.loads[0].limit = true;
    const BodyPlan free = plan(scene, first);
    REQUIRE(free.found);
    scene.loads[0].rating = 0.95 * free.landing.loads[0].value;
    o.share = 0.99;
    const BodyPlan p = plan(scene, o);
    INFO(c.name << ": " << free.value << " without the limit, " << p.value << " within it");
    REQUIRE(p.found);
    REQUIRE(p.under);
    CHECK(p.landing.loads[0].value <= scene.loads[0].rating);
    CHECK(p.value < p.held_value);
    const double n = double(p.under->planned.samples), error = std::sqrt(0.99 * 0.01 / n);
    CHECK(n == 10'000);
    CHECK(1 - double(p.under->broken) / n >= 0.99 - 3 * error);
  }
}

TEST_CASE("legs: a motor that is clamped at its rating keeps it, whatever rounding makes of its torque", "[legs]") {
  BodyScene scene = shipped("hopper");
  constexpr double kLimit = 5.4;  // [Nm], no power of two: clamped in many of the drops
  for (Joint& j : scene.robot.joints) j.sea.tau_max = kLimit, j.motor_torque_max = kLimit;
  CHECK(respect_ratings(scene).empty());
  const BodyMotion held = held_posture(scene);
  int clamped = 0;
  std::vector<BodyScene> drops(200, scene);
  std::vector<BodyBatchCase> cases;
  for (std::size_t i = 0; i < drops.size(); ++i) {
    drops[i].drop.height = 0.1 + 0.002 * double(i);
    cases.push_back({&drops[i], &held});
    const BodyLanding l = simulate(drops[i], held);
    INFO("from " << drops[i].drop.height << " m");
    CHECK((!l.broken || scene.loads[std::size_t(l.broken.load)].kind != Kind::kMotorTorque));
    for (const JointDemands& d : l.demands) clamped += d.motor_torque >= kLimit * (1 - 1e-12);
  }
  CHECK(clamped > 100);
  std::vector<BodyLanding> lanes(cases.size());
  body_batch_peaks(cases, lanes, {});
  for (const BodyLanding& l : lanes)
    CHECK((!l.broken || scene.loads[std::size_t(l.broken.load)].kind != Kind::kMotorTorque));
}

TEST_CASE("legs: a robot that dry friction holds rests beside an angle load near its largest, at every accuracy") {
  BodyScene scene = shipped("hopper");
  scene.robot.joints[1].sea.friction = 10;
  scene.loads = {load(Kind::kAngle, 1, 0.1)};
  scene.loads[0].phi = {-75 * kDegree, 100 * kDegree};  // it ends far from their middle
  scene.loads.push_back(scene.loads[0]), scene.loads[1].phi = {-60 * kDegree, 100 * kDegree};
  const BodyMotion held = held_posture(scene);
  const BodyLanding tight = simulate(scene, held, {.accuracy = 1e-11});
  REQUIRE(tight.end == End::kRest);
  CHECK(tight.loads[1].value > 0);
  for (const double accuracy : {1e-9, 1e-7, 1e-6, 1e-5}) {
    INFO("accuracy " << accuracy);
    const BodyLanding l = simulate(scene, held, {.accuracy = accuracy});
    CHECK(l.end == End::kRest);
    CHECK(l.t_end < 2);
    CHECK(l.loads[1].value == Approx(tight.loads[1].value).epsilon(1e-3));
    BodyLanding lane;
    const BodyBatchCase one{&scene, &held};
    body_batch_peaks({&one, 1}, {&lane, 1}, {.accuracy = accuracy});
    CHECK(lane.end == End::kRest);
  }
}
