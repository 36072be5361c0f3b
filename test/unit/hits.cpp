// Where the force acts, what the load cell reads between hits, gaps, signs.
#include "identify/logs/hits.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "common/random.hpp"
#include "identify/estimate/statistics.hpp"
#include "identify/logs/log_check.hpp"

using namespace ukemi;
using namespace ukemi::identify;

namespace {

/// 1 s at 1 kHz: half-sine hits of 20 ms from each of the times on, load-cell noise, the angle a spring's answer.
Trial log_of(const std::vector<std::pair<double, double>>& hits, double noise, double rest = 0) {
  Trial out;
  Random random(3);
  for (int i = 0; i <= 1000; ++i) {
    double force = 0;
    for (const auto& [start, newton] : hits) {
      const double s = (i * 1e-3 - start) / 0.02;
      if (s > 0 && s < 1) force += newton * std::sin(std::numbers::pi * s);
    }
    out.t.push_back(i * 1e-3);
    out.force.push_back(force + rest + noise * random.normal());
    out.phi.push_back(1e-3 * force);
  }
  return out;
}

}  // namespace

TEST_CASE("hits: found among noise, the force at rest between them, the noise told from the samples between") {
  Trial t = log_of({{0.0505, 40}, {0.5005, -30}}, 0.3);
  CHECK(force_noise_before_first_hit(t) == Approx(0.3).epsilon(0.3));
  const Trial raw = t;
  flatten_force_between_hits(t);
  CHECK(t.force_noise == Approx(0.3).epsilon(0.1));
  CHECK(t.force_rest == 0);
  const std::vector<LoggedHit> found = hits(t, t.force_noise);
  REQUIRE(found.size() == 2);
  CHECK(std::abs(double(found[0].first) - 51) <= 1);
  CHECK(std::abs(double(found[0].last) - 70) <= 1);
  CHECK(std::abs(double(found[1].first) - 501) <= 1);
  for (std::size_t i = 0; i < t.force.size(); ++i) {
    const bool in_hit = (i >= found[0].first && i <= found[0].last) || (i >= found[1].first && i <= found[1].last);
    CHECK(t.force[i] == (in_hit ? raw.force[i] : 0));
  }
}

TEST_CASE("hits: the noise before the first hit is told from the hit's own rise at a high rate") {
  Trial t;
  Random random(8);
  for (int i = 0; i < 12'000; ++i) {
    const double s = (i / 12e3 - 0.0508) / 0.02;
    t.t.push_back(i / 12e3);
    t.force.push_back((s > 0 && s < 1 ? 150 * std::sin(std::numbers::pi * s) : 0) + 0.02 * random.normal());
  }
  CHECK(force_noise_before_first_hit(t) == Approx(0.02).epsilon(0.15));
  flatten_force_between_hits(t);
  CHECK(t.force_noise == Approx(0.02).epsilon(0.05));
  CHECK(hits(t, t.force_noise).size() == 1);
}

TEST_CASE("hits: an offset of the load cell stays and is told, a given noise counts, no noise changes nothing") {
  Trial t = log_of({{0.0505, 40}}, 0.1, 0.5);
  flatten_force_between_hits(t, 0.1);
  CHECK(t.force_noise == 0.1);
  CHECK(t.force_rest == Approx(0.5).margin(0.1));
  CHECK(t.force[500] == t.force_rest);
  Trial clean = log_of({{0.0505, 40}}, 0);
  const std::vector<double> before = clean.force;
  flatten_force_between_hits(clean);
  CHECK(clean.force == before);
  CHECK(clean.force_noise == 0);
}

TEST_CASE("hits: a force that goes on is no noise and is left alone") {
  Trial t = log_of({}, 0);
  for (std::size_t i = 0; i < t.force.size(); ++i)  // a sweep that grows
    t.force[i] = 1e-2 * double(i) * std::sin(1e-4 * double(i) * double(i));
  const std::vector<double> before = t.force;
  flatten_force_between_hits(t);
  CHECK(t.force == before);
}

TEST_CASE("hits: times in milliseconds and forces in kilonewtons are asked about") {
  Trial t = log_of({{0.0505, 40}}, 0);
  t.file = "a.csv";
  CHECK(check_logs({t}).warnings.empty());
  for (double& x : t.t) x *= 1000;
  for (double& f : t.force) f /= 1000;
  CHECK(check_logs({t}).warnings ==
        std::vector<std::string>{"a.csv: a sample every 1 s: are the times in milliseconds? [s] is needed",
                                 "a.csv: the force is 0.0399 N at most: is it in kilonewtons? [N] is needed"});
}

TEST_CASE("gaps: their place and length, in a hit or at rest, and jitter is none") {
  Trial t = log_of({{0.0505, 40}}, 0);
  CHECK(gaps(t).empty());
  Trial jitter = t;
  Random random(1);
  for (double& x : jitter.t) x += 2e-4 * random.uniform(-1, 1);
  CHECK(gaps(jitter).empty());
  const auto without = [&](std::size_t from, std::size_t to) {
    Trial cut = t;
    for (auto* column : {&cut.t, &cut.phi, &cut.force})
      column->erase(column->begin() + long(from), column->begin() + long(to));
    return gaps(cut);
  };
  const auto hit = without(60, 61), tail = without(66, 80), rest = without(400, 410);
  REQUIRE(hit.size() == 1);
  CHECK(hit[0].t == Approx(0.059));
  CHECK(hit[0].length == Approx(0.002));
  CHECK(hit[0].place == Gap::Place::kInHit);
  REQUIRE(tail.size() == 1);
  CHECK(tail[0].place == Gap::Place::kInHit);
  REQUIRE(rest.size() == 1);
  CHECK(rest[0].place == Gap::Place::kAtRest);
}

TEST_CASE("the angle answers along the force, against a flipped one, a still one has no effect") {
  Trial t = log_of({{0.0505, 40}}, 0);
  CHECK(*first_hit_correlation(t) > 0.9);
  for (double& f : t.force) f = -f;
  CHECK(*first_hit_correlation(t) < -0.9);
  std::fill(t.phi.begin(), t.phi.end(), 0.0);
  CHECK_FALSE(first_hit_correlation(t));
}

TEST_CASE("Holm: all rejected until one is not, together at their level") {
  CHECK(holm({0.001, 0.5, 0.004, 0.0001}, 0.01) == std::vector<bool>{true, false, true, true});
  CHECK(holm({0.004, 0.5, 0.0040, 0.0026}, 0.01) == std::vector<bool>{false, false, false, false});
  CHECK(holm({}, 0.01).empty());
  int alarms = 0;
  for (int d = 0; d < 20'000; ++d) {
    Random random(9, std::uint64_t(d));
    std::vector<double> p(11);
    for (double& x : p) x = random.uniform();
    const auto rejected = holm(p, 0.01);
    alarms += std::find(rejected.begin(), rejected.end(), true) != rejected.end();
  }
  CHECK(std::abs(alarms - 200) < 4 * 14);
}
