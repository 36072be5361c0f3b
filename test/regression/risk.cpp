// Risk over drops: against the scalar path, and against an independent program.
#include <catch2/catch.hpp>

#include "common/degrees.hpp"
#include "landing/judge/answer.hpp"
#include "landing/judge/risk.hpp"
#include "landing/scatter/scattered.hpp"
#include "test/paper.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace test;

namespace {

const Motion kQuintic{-24.4 * kDegree, -85 * kDegree, 0.261},
    kTwoBumps{-74.2 * kDegree, -63.9 * kDegree, 0.2067, {14.7 * kDegree, -119.9 * kDegree, 0, 0}};

std::vector<double> peaks(const Motion& motion, const std::vector<ScatteredDrop>& drops, double accuracy) {
  ScatteredLandings landings;
  const DrivenMotion planned{motion, table2().sea};
  std::vector<double> out;
  for (const LandingPeak& l : landings.play({&planned, 1}, drops, {.accuracy = accuracy})) out.push_back(counted(l, 0));
  return out;
}

}  // namespace

TEST_CASE("risk: mean and CVaR in lanes are those of the scalar path, drop by drop") {
  const DropModel model(paper(), Scatter::assumed(), table2(), {.inexact = true});
  const std::vector<ScatteredDrop> drops = model.independent(300, 7);
  for (const Motion& motion : {kQuintic, kTwoBumps, kHeld}) {
    std::vector<double> scalar;
    for (const ScatteredDrop& d : drops) {
      const DrivenMotion p = d.played({motion, table2().sea});
      scalar.push_back(peak_acceleration(d.scene, p.sea, p.motion).peak);
    }
    const Distribution a = distribution(peaks(motion, drops, 1e-5)), b = distribution(scalar);
    CHECK(a.mean.value == Approx(b.mean.value).epsilon(1e-3));
    CHECK(a.cvar90.value == Approx(b.cvar90.value).epsilon(1e-3));
  }
}

TEST_CASE("risk: the paper's scene under the assumed scatter, against an independent program") {
  struct Known {
    Motion motion;
    double mean, cvar90;
  };
  const std::vector<ScatteredDrop> drops = DropModel(paper(), Scatter::assumed()).independent(10'000, 1);
  for (const Known& k : {Known{kHeld, 464, 498}, {kQuintic, 215, 282}, {kTwoBumps, 142, 152.6}}) {
    const Distribution d = distribution(peaks(k.motion, drops, 1e-5));
    CHECK(d.mean.value == Approx(k.mean).epsilon(0.02));
    CHECK(d.cvar90.value == Approx(k.cvar90).epsilon(0.02));
    if (k.mean == 142) CHECK(d.q99.value == Approx(162).epsilon(0.02));
  }
}

TEST_CASE("risk: what is told adds up, and the worst drops are the worst") {
  const DropModel model(paper(), Scatter::assumed());
  RiskOptions options;
  options.samples = 2000;
  options.forbidden = {true, false, true};
  const Risk r = risk(model, table2(), kQuintic, options);
  CHECK(r.peaks.samples + r.failed == 2000);
  CHECK(r.held.samples + r.held_failed == 2000);
  long in_contacts = 0, in_bins = 0, held_in_bins = 0;
  for (const PeakContact& c : r.contacts) in_contacts += c.drops;
  for (const PeakBin& b : r.histogram) in_bins += b.drops, held_in_bins += b.beside;
  CHECK(in_contacts == r.peaks.samples);
  CHECK(in_bins == r.peaks.samples);
  CHECK(held_in_bins == r.held.samples);

  REQUIRE(r.worst.size() == 100);
  CHECK(r.worst[0].peak == r.peaks.max);
  CHECK(std::is_sorted(r.worst.begin(), r.worst.end(), [](auto& a, auto& b) { return a.peak > b.peak; }));
  const std::vector<double> own = peaks(kQuintic, model.even(2000, 1), 1e-6);
  CHECK(std::count_if(own.begin(), own.end(), [&](double x) { return x >= r.worst[99].peak; }) == 100);
  CHECK(peaks(kQuintic, {r.worst[7].drop}, 1e-6)[0] == Approx(r.worst[7].peak).epsilon(1e-3));

  // Each event, counted landing by landing.
  REQUIRE(r.events.size() == 4);
  std::vector<long> counted(4, 0);
  for (const ScatteredDrop& d : model.even(256, 1)) {
    const Landing l = simulate(d.scene, table2().sea, kQuintic, {.accuracy = 1e-6});
    counted[0] += l.contacts.touched(kHip), counted[1] += l.contacts.touched(kFoot);
    counted[2] += l.demands.motor_speed > r.events[2].limit, counted[3] += l.demands.motor_torque > r.events[3].limit;
  }
  for (std::size_t e = 0; e < 4; ++e) {
    INFO(e);
    CHECK(double(r.events[e].drops) / 2000 == Approx(double(counted[e]) / 256).margin(0.05));
  }

  REQUIRE(r.uncertainties.size() == 3);
  CHECK(r.uncertainties[0].name == "pitch");
  CHECK(r.why_none == Risk::WhyNone::kThere);
  CHECK(risk(DropModel(paper(), {.pitch = 0.01}), table2(), kQuintic, options).why_none == Risk::WhyNone::kOneGroup);
  options.measured = model.independent(20, 3);
  const Risk measured = risk(model, table2(), kQuintic, options);
  CHECK(measured.why_none == Risk::WhyNone::kMeasured);
  CHECK(measured.peaks.samples == 20);
  CHECK(measured.peaks.mean.value == Approx(distribution(peaks(kQuintic, options.measured, 1e-6)).mean.value));
}

TEST_CASE("risk: what is interrupted is of the drops that were played") {
  const DropModel model(paper(), Scatter::assumed());
  RiskOptions options;
  options.samples = 100'000;
  bool stop = false;
  options.monitor.on_progress = [&](long, long) { stop = true; };
  options.monitor.stop = [&] { return stop; };
  const Risk r = risk(model, table2(), kHeld, options);
  CHECK(r.why_none == Risk::WhyNone::kStopped);
  CHECK(r.peaks.samples > 0);
  CHECK(r.peaks.samples < 100'000);
  CHECK(r.peaks.mean.value == r.held.mean.value);
}
