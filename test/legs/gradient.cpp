// Gradients of landings of robots of links against difference quotients of `peak_acceleration`, which knows nothing of
// them: on the reference robots, which have every base, drive and contact law.
#include <catch2/catch.hpp>
#include <cmath>

#include "common/error.hpp"
#include "landing/body/load.hpp"
#include "landing/derivatives/body_gradient.hpp"
#include "landing/model/motion.hpp"
#include "test/legs/robots.hpp"
#include "test/quotient.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {

constexpr SimulateOptions kTight{.accuracy = 1e-13, .rest = SimulateOptions::Rest::kIgnore};
constexpr double kSure = 1e-7, kSmooth = 1e-2;  // as test/property/gradient.cpp

struct Case {
  BodyScene scene;
  BodyMotion motion;
};
Case reference(const std::string& stem) {
  const std::string folder = UKEMI_DATASETS "/reference/legs/";
  Case c{.scene = read_body_scene(folder + stem + ".toml"), .motion = {}};
  c.motion = read_body_motion(folder + stem + "_motion.toml", c.scene.robot);
  return c;
}

/// Those that chatter: their peaks move by 1e-6 with the steps (test/legs/references.cpp).
bool is_sensitive(const std::string& stem) { return stem == "leg_042" || stem == "leg_045"; }

enum class Answer { kRight, kWrong, kUnsure };
struct Tally {
  int right = 0, wrong = 0, unsure = 0;
};

double peak_of(const BodyLanding& l) { return l.peak; }

/// The gradient's share of one parameter against its quotient, as a part of the whole gradient's size; of the largest
/// value that `read` takes from a landing.
template <class Read = double (*)(const BodyLanding&)>
Answer judge(const Case& c, const BodyParameter& p, double derivative, double peak, double size,
             Read&& read = peak_of) {
  Case moved = c;
  double& x = number(moved.scene, moved.motion, p);
  const double x0 = x;
  const bool constant = p.of == BodyParameter::Of::kDrive || p.of == BodyParameter::Of::kContact;
  const double unit = constant && x0 != 0 ? std::abs(x0) : 1;
  const auto f = [&](double by) {
    x = x0 + by;
    return read(peak_acceleration(moved.scene, moved.motion, kTight));
  };
  constexpr double kNear = 1e-6;
  const double kink = (f(kNear * unit) - 2 * peak + f(-kNear * unit)) / kNear;
  const Quotient q = central(unit, kSure, f);
  if (q.error * unit > kSure * size || std::abs(kink) > kSmooth * size) return Answer::kUnsure;
  const double off = std::abs(derivative - q.value) * unit / size;
  if (off < 1e-6) return Answer::kRight;
  WARN(name(p, c.scene.robot) << ": gradient " << derivative << ", quotient " << q.value << " +- " << q.error
                              << ", off by " << off);
  return Answer::kWrong;
}

/// Every `stride`-th parameter of a reference robot from `first` on.
Tally compare(const std::string& stem, const Case& c, std::size_t first, std::size_t stride) {
  INFO(stem);
  const std::vector<BodyParameter> all = parameters_of(c.scene, c.motion);
  const BodyGradients g = gradients(c.scene, c.motion, all, kTight, 3);
  const double peak = peak_acceleration(c.scene, c.motion, kTight).peak;
  REQUIRE(!g.peaks.empty());
  if (!is_sensitive(stem)) CHECK(g.peaks[0].value == Approx(peak).epsilon(1e-7));
  double size = 0;
  const auto share = [&](std::size_t k) {
    Case copy = c;
    const double x = std::abs(number(copy.scene, copy.motion, all[k]));
    const bool constant = all[k].of == BodyParameter::Of::kDrive || all[k].of == BodyParameter::Of::kContact;
    return g.peaks[0].d[Eigen::Index(k)] * (constant && x != 0 ? x : 1);
  };
  for (std::size_t k = 0; k < all.size(); ++k) size = std::max(size, std::abs(share(k)));
  Tally out;
  for (std::size_t k = first % stride; k < all.size(); k += stride) {
    const Answer a = judge(c, all[k], g.peaks[0].d[Eigen::Index(k)], peak, size);
    (a == Answer::kRight ? out.right : a == Answer::kWrong ? out.wrong : out.unsure) += 1;
  }
  return out;
}

/// Every `scenes`-th of the reference robots, of each every `stride`-th parameter.
Tally compare_all(const std::string& prefix, int count, int scenes, std::size_t stride) {
  Tally sum;
  for (int i = 0; i < count; i += scenes) {
    const std::string number = std::to_string(i);
    const std::string stem = prefix + std::string(3 - number.size(), '0') + number;
    const Tally t = compare(stem, reference(stem), std::size_t(i), stride);
    UNSCOPED_INFO(stem << ": " << t.right << " right, " << t.wrong << " wrong, " << t.unsure << " unsure");
    sum.right += t.right, sum.wrong += t.wrong, sum.unsure += t.unsure;
  }
  return sum;
}

}  // namespace

TEST_CASE("legs: gradients by the numbers of motion, drop, drives and contacts against difference quotients") {
  const auto [prefix, count] = GENERATE(std::pair("leg_", 60), std::pair("floor_", 40));
  const Tally t = compare_all(prefix, count, 4, 15);
  CAPTURE(prefix, t.right, t.wrong, t.unsure);
  CHECK(t.wrong == 0);
  CHECK(t.right > 3 * t.unsure);
}

TEST_CASE("legs: gradients where joints stick and slip") {
  Random r(20261131);
  Tally sum;
  for (const std::string name : {"hopper", "three_links", "foot"})
    for (int n = 0; n < 2; ++n) {
      Case c{.scene = legs::shipped(name), .motion = {}};
      legs::rub(c.scene, r);
      c.scene.drop.pitch += 0.03;  // a foot that touches with heel and toe at once has two slopes
      c.motion = held_posture(c.scene);
      for (std::size_t i = 0; i < c.motion.size(); ++i)
        if (c.scene.robot.joints[i].driven())
          c.motion[i].phi_f = r.uniform(c.scene.search[i].phi[0], c.scene.search[i].phi[1]), c.motion[i].duration = 0.3;
      const Tally t = compare(name, c, std::size_t(n), 14);
      UNSCOPED_INFO(name << ": " << t.right << " right, " << t.wrong << " wrong, " << t.unsure << " unsure");
      sum.right += t.right, sum.wrong += t.wrong, sum.unsure += t.unsure;
    }
  CHECK(sum.wrong == 0);
  CHECK(sum.right > 2 * sum.unsure);
}

// About 20 minutes.
TEST_CASE("legs: gradients by every number", "[.all]") {
  const auto [prefix, count] = GENERATE(std::pair("leg_", 60), std::pair("floor_", 40));
  const Tally t = compare_all(prefix, count, 1, 1);
  WARN(prefix << ": " << t.right << " right, " << t.wrong << " wrong, " << t.unsure << " unsure");
  CHECK(t.wrong == 0);
}

TEST_CASE("legs: gradients through what only plans have: a delay, shape terms, gains, a move in the air") {
  Case c{.scene = legs::shipped("hopper"), .motion = {}};
  c.scene.detection_delay = 0.004;
  for (const double phi : {0.6, -1.2})
    c.motion.push_back({.phi_i = phi,
                        .phi_f = phi + 0.3,
                        .duration = 0.2,
                        .bumps = {0.1, -0.05, 0.02, 0.01},
                        .gain_p = 0.8,
                        .gain_d = 1.3,
                        .reposition = Reposition{phi - 0.2, 0, 0.02, 0.15}});
  const std::vector<BodyParameter> all = parameters_of(c.scene, c.motion);
  const BodyGradients g = gradients(c.scene, c.motion, all, kTight, 3);
  const double peak = peak_acceleration(c.scene, c.motion, kTight).peak;
  REQUIRE(!g.peaks.empty());
  CHECK(g.peaks[0].value == Approx(peak).epsilon(1e-8));
  const double size = g.peaks[0].d.head(20).cwiseAbs().maxCoeff();
  int right = 0;
  for (std::size_t k = 0; k < 20; ++k) {  // of both joints' motions
    const Answer a = judge(c, all[k], g.peaks[0].d[Eigen::Index(k)], peak, size);
    CHECK(a != Answer::kWrong);
    right += a == Answer::kRight;
  }
  CHECK(right >= 18);
  // One duration for both joints: the sum of the two.
  const BodyParameter duration{BodyParameter::Of::kMotion, -1, kDurationSlot};
  const BodyGradients one = gradients(c.scene, c.motion, {&duration, 1}, kTight, 1);
  CHECK(one.peaks[0].d[0] == Approx(g.peaks[0].d[2] + g.peaks[0].d[12]).epsilon(1e-6));
  CHECK(name(duration, c.scene.robot) == "duration");
  CHECK(name(all[2], c.scene.robot) == "duration_" + c.scene.robot.joints[0].name);
  CHECK_THROWS_AS(gradients(c.scene, c.motion, std::array{BodyParameter{BodyParameter::Of::kContact, 7, 0}}, kTight),
                  InputError);
}

TEST_CASE("legs: gradients of every kind of load against difference quotients") {
  using Kind = Load::Kind;
  for (const std::string stem : {"three_links", "hopper", "foot"}) {
    Case c{.scene = legs::shipped(stem), .motion = {}};
    const int joint = int(c.scene.robot.joints.size()) - 1;
    for (const Kind k : {Kind::kTorque, Kind::kDeflection, Kind::kMotorSpeed, Kind::kMotorTorque, Kind::kAngle,
                         Kind::kForce, Kind::kImpulse, Kind::kAcceleration, Kind::kTouch}) {
      const Joint& last = c.scene.robot.joints[std::size_t(joint)];
      if (k == Kind::kDeflection && last.kind != DriveKind::kElastic) continue;
      if ((k == Kind::kMotorSpeed || k == Kind::kMotorTorque) && !last.driven()) continue;
      const bool of_contact = k == Kind::kForce || k == Kind::kImpulse || k == Kind::kTouch;
      c.scene.loads.push_back({.name = landing::name(k),
                               .kind = k,
                               .index = of_contact ? int(c.scene.robot.contacts.size()) - 1 : joint,
                               .at = {0.05, 0.01},
                               .phi = {-1.2, -0.9},
                               .limit = k == Kind::kTouch});
    }
    c.scene.t_end = 0.6;
    if (stem == "foot") c.scene.drop.pitch += 0.05;  // heel and toe touch one after the other
    c.motion = held_posture(c.scene);
    for (Motion& m : c.motion) m.phi_f += 0.3, m.duration = 0.25;
    const std::vector<BodyParameter> all = parameters_of(c.scene, c.motion);
    const BodyGradients g = gradients(c.scene, c.motion, all, kTight, 2);
    const BodyLanding l = peak_acceleration(c.scene, c.motion, kTight);
    REQUIRE(g.loads.size() == c.scene.loads.size());
    for (std::size_t i = 0; i < c.scene.loads.size(); ++i) {
      const double value = l.loads[i].value;
      INFO(stem << ": " << c.scene.loads[i].name << " " << value << " at " << l.loads[i].t << " s");
      const bool stands = [&] {  // on the limit of its drive: a plateau, and no maximum that is one
        const Kind k = c.scene.loads[i].kind;
        const double most = c.scene.robot.joints[std::size_t(joint)].sea.tau_max;
        return (k == Kind::kTorque || k == Kind::kMotorTorque) && value == most;
      }();
      if (stands) continue;
      if (c.scene.loads[i].kind == Kind::kTouch) {
        CHECK(g.loads[i].empty());
        continue;
      }
      REQUIRE(!g.loads[i].empty());
      const BodyPeakGradient& peak = g.loads[i][0];
      CHECK(peak.value == Approx(value).epsilon(1e-8));
      UNSCOPED_INFO("kind " << int(peak.kind) << " t " << peak.t << " first " << l.contacts.first());
      CHECK(peak.t == Approx(l.loads[i].t).margin(1e-5));
      const auto share = [&](std::size_t k) {
        Case copy = c;
        const bool constant = all[k].of == BodyParameter::Of::kDrive || all[k].of == BodyParameter::Of::kContact;
        const double x = std::abs(number(copy.scene, copy.motion, all[k]));
        return peak.d[Eigen::Index(k)] * (constant && x != 0 ? x : 1);
      };
      double size = 0;
      for (std::size_t k = 0; k < all.size(); ++k) size = std::max(size, std::abs(share(k)));
      int right = 0, unsure = 0;
      for (std::size_t k = i % 7; k < all.size(); k += 7) {
        INFO(name(all[k], c.scene.robot));
        const Answer a = judge(c, all[k], peak.d[Eigen::Index(k)], value, size,
                               [i](const BodyLanding& of) { return of.loads[i].value; });
        CHECK(a != Answer::kWrong);
        right += a == Answer::kRight, unsure += a == Answer::kUnsure;
      }
      CHECK(right > unsure);
    }
  }
}
