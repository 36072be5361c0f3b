// The rollout of landing/drops/drop_rollout.hpp against `simulate`, another path through the events, and its
// derivatives against difference quotients of its own values, which know nothing of them.
#include "landing/drops/drop_rollout.hpp"

#include <catch2/catch.hpp>

#include "common/actuator.hpp"
#include "common/random.hpp"
#include "landing/model/scene_file.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {

constexpr std::uint64_t kSeed = 20261123;
constexpr SimulateOptions kTight{.accuracy = 1e-13};
constexpr const char* kFloors[] = {"paper", "paper_rough_a", "paper_rough_b", "paper_soft"};
/// Size of each output, that errors are parts of.
constexpr std::array<double, kOutputs> kSize = {100, 100, 100, 0.3, 0.3, 1};

struct Case {
  Scene scene;
  SeaParameters<double> sea;
  Motion motion{};

  double& at(int slot) {
    const std::array<double*, kDropParameters.size()> all = {
        &scene.drop.height,      &scene.drop.forward_speed,    &scene.drop.pitch,
        &scene.floor->stiffness, &scene.floor->damping_normal, &scene.floor->damping_tangential};
    return *all[std::size_t(slot)];
  }
  /// What a parameter is moved by in parts of: 1 for lengths, speeds and angles, else its own size.
  double unit(int slot) { return slot < 3 ? 1 : at(slot); }
  DropRollout roll(const std::vector<double>& times) const { return roll_drop(scene, sea, motion, times, kTight); }
};

Case on_floor(const std::string& floor, std::uint64_t draw) {
  Random r(kSeed, draw);
  Case c{read_scene(UKEMI_DATASETS "/scenes/" + floor + ".toml"),
         read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea};
  c.motion = {r.uniform(-1.2, -0.3), r.uniform(-1.4, -0.2), r.uniform(0.1, 0.4)};
  return c;
}

std::vector<double> every(double step, double until) {
  std::vector<double> t;
  for (int i = 0; i * step <= until; ++i) t.push_back(i * step);
  return t;
}
bool near_jump(const DropRollout& r, double t, double within) {
  for (const double jump : r.jumps)
    if (std::abs(jump - t) < within) return true;
  return false;
}

}  // namespace

TEST_CASE("drop rollout: the samples are those of `simulate`, and so are the touchdowns") {
  for (const char* floor : kFloors) {
    Case c = on_floor(floor, 1);
    c.scene.t_end = 0.8;
    const Landing l =
        simulate(c.scene, c.sea, c.motion, {.accuracy = 1e-12, .rest = SimulateOptions::Rest::kIgnore}, 500);
    const std::vector<double> times = every(0.002, 0.8);
    const DropRollout r = c.roll(times);
    INFO(floor);
    REQUIRE(r.complete);
    REQUIRE(r.value[kAcc].size() == times.size());
    std::size_t i = 0, compared = 0;
    for (const Sample& s : l.trajectory) {
      if (i == times.size() || std::abs(s.t - times[i]) > 1e-9) continue;
      const std::size_t at = i++;
      if (near_jump(r, s.t, 1e-7)) continue;
      const std::array<double, kOutputs> wanted = {s.acc, s.ddx0, s.ddy0, s.x0, s.y0, s.phi0};
      for (std::size_t o = 0; o < kOutputs; ++o) {
        CAPTURE(s.t, thigh_channels()[o].name, r.value[o][at], wanted[o]);
        CHECK(std::abs(r.value[o][at] - wanted[o]) < 1e-6 * kSize[o]);
      }
      ++compared;
    }
    CHECK(compared > 390);
    std::vector<double> touched;
    for (const Touch& t : l.touches) touched.push_back(t.t_touchdown);
    for (const double t : touched) CHECK(near_jump(r, t, 1e-7));
    CHECK(r.jumps.size() >= touched.size());
  }
}

TEST_CASE("drop rollout: derivatives through touchdowns, against difference quotients") {
  constexpr double kMove = 1e-5;
  for (const char* floor : kFloors)
    for (std::uint64_t draw = 10; draw < 13; ++draw) {
      Case c = on_floor(floor, draw);
      if (draw == 12) c.scene.drop.pitch_rate = -1;  // the flight is integrated then
      const std::vector<double> times = every(0.01, 0.55);
      const DropRollout r = c.roll(times);
      INFO(floor << ", seed " << kSeed << ", draw " << draw);
      REQUIRE(r.complete);
      std::array<double, kOutputs> largest{}, size{};
      int compared = 0;
      const auto compare = [&](auto&& moved, auto&& wanted) {
        // Fourth order: f' = (8 (f(h) - f(-h)) - (f(2h) - f(-2h))) / 12 h.
        const DropRollout a = moved(-2 * kMove), b = moved(-kMove), d = moved(kMove), e = moved(2 * kMove);
        REQUIRE((a.complete && b.complete && d.complete && e.complete));
        for (std::size_t i = 0; i < times.size(); ++i) {
          if (near_jump(r, times[i], 2e-3)) continue;
          ++compared;
          for (std::size_t o = 0; o < kOutputs; ++o) {
            const auto f = [&](const DropRollout& x) { return x.value[o][i]; };
            const double quotient = (8 * (f(d) - f(b)) - (f(e) - f(a))) / (12 * kMove), exact = wanted(i, o);
            largest[o] = std::max(largest[o], std::abs(quotient - exact));
            size[o] = std::max(size[o], std::abs(exact));
          }
        }
      };
      for (int k = 0; k < int(kDropParameters.size()); ++k) {
        const double unit = c.unit(k);
        compare(
            [&](double by) {
              Case m = c;
              m.at(k) += by * unit;
              return m.roll(times);
            },
            [&](std::size_t i, std::size_t o) { return r.slope[o](long(i), k) * unit; });
      }
      compare(
          [&](double by) {
            std::vector<double> moved = times;
            for (double& t : moved) t = std::max(0.0, t + by);
            moved[0] = 0;
            return c.roll(moved);
          },
          [&](std::size_t i, std::size_t o) { return i == 0 ? 0 : r.slope[o](long(i), long(kDropParameters.size())); });
      CHECK(compared > 150);
      for (std::size_t o = 0; o < kOutputs; ++o) {
        CAPTURE(thigh_channels()[o].name, largest[o], size[o]);
        CHECK(size[o] > 0);
        CHECK(largest[o] < 1e-6 * size[o]);
      }
    }
}

TEST_CASE("drop rollout: no floor, one instant, no instant") {
  Case c = on_floor("paper", 3);
  CHECK(c.roll({}).complete);
  const DropRollout at_release = c.roll({0});
  REQUIRE(at_release.value[kAcc].size() == 1);
  CHECK(at_release.value[kAcc][0] == Approx(9.81));
  CHECK(at_release.value[kThighX][0] == Approx(0).margin(1e-15));
  c.scene.floor.reset();
  const DropRollout r = c.roll({0, 0.3, 1});
  REQUIRE(r.complete);
  CHECK(r.jumps.empty());
  CHECK(r.value[kThighY][2] == Approx(r.value[kThighY][0] - 4.905));
  CHECK(r.slope[kThighY](2, 3) == 0);
  c.scene.robot.gravity = 0;
  const DropRollout weightless = c.roll({0, 1});
  REQUIRE(weightless.complete);
  CHECK(weightless.value[kAcc][1] == 0);
  CHECK(weightless.slope[kAcc].row(1).isZero());
}
