// When contacts touch and leave, read from forces: against written ones.
#include "tools/study/contact_times.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace ukemi;
using namespace ukemi::tools;

namespace {

constexpr double kRow = 1e-3;

/// Rows of a force that is a half sine of 100 N between each pair of times.
struct Log {
  std::vector<double> t, force;
  Log(double end, const std::vector<std::pair<double, double>>& stands) {
    for (int k = 0; kRow * k < end; ++k) {
      t.push_back(kRow * k), force.push_back(0);
      for (const auto& [from, to] : stands)
        if (t.back() > from && t.back() < to)
          force.back() = 100 * std::sin(std::numbers::pi * (t.back() - from) / (to - from));
    }
  }
};
constexpr double kLevel = 5;
/// How late a half sine rises through it, of its length.
const double kLate = std::asin(kLevel / 100) / std::numbers::pi, kEarly = std::asin(kLevel / 200) / std::numbers::pi;

}  // namespace

TEST_CASE("a contact's times are where its force passes the levels, between two rows") {
  const Log log(1, {{0.1003, 0.3001}, {0.6, 0.8}});
  const std::vector<Stance> all = stances(log.t, log.force, kLevel);
  REQUIRE(all.size() == 2);
  const double length = 0.3001 - 0.1003;
  CHECK(all[0].touchdown == Approx(0.1003 + kLate * length).margin(5e-5));
  CHECK(all[0].liftoff == Approx(0.3001 - kEarly * length).margin(5e-5));
  CHECK(std::isnan(all[0].previous_liftoff));
  CHECK(all[1].previous_liftoff == all[0].liftoff);
  CHECK(all[1].flight() == Approx(0.6 - 0.3001 + kLate * 0.2 + kEarly * length).margin(1e-4));
  CHECK(all[1].duration() == Approx(0.2 * (1 - kLate - kEarly)).margin(1e-4));
}

TEST_CASE("a log that begins or ends in a stance knows one of its times alone, and a contact that never touches none") {
  const Log log(0.9, {{-0.1, 0.2}, {0.5, 1.1}});
  const std::vector<Stance> all = stances(log.t, log.force, kLevel);
  REQUIRE(all.size() == 2);
  CHECK(std::isnan(all[0].touchdown));
  CHECK(all[0].liftoff == Approx(0.2).margin(0.01));
  CHECK(all[1].touchdown == Approx(0.5).margin(0.02));
  CHECK(std::isnan(all[1].liftoff));
  CHECK(std::isnan(all[1].duration()));
  CHECK(all[1].flight() == Approx(0.3).margin(0.02));
  CHECK(stances(log.t, Log(0.9, {}).force, kLevel).empty());
  const Log whole(0.5, {{-1, 2}});
  REQUIRE(stances(whole.t, whole.force, kLevel).size() == 1);
  CHECK(std::isnan(stances(whole.t, whole.force, kLevel)[0].touchdown));
}

TEST_CASE("a contact that chatters stands through flights below 10 ms, and noise below the level is none") {
  Log log(1, {{0.1, 0.4}, {0.402, 0.5}, {0.6, 0.7}});
  for (std::size_t i = 0; i < log.force.size(); ++i) log.force[i] += 0.4 * kLevel * (i % 2 == 0 ? 1 : -1);
  log.force[300] = std::nan("");  // an empty cell
  const std::vector<Stance> all = stances(log.t, log.force, kLevel);
  REQUIRE(all.size() == 2);
  CHECK(all[0].duration() == Approx(0.4).margin(0.01));
  CHECK(all[1].flight() == Approx(0.1).margin(0.01));
}

TEST_CASE("what stands by its weight alone after a hard landing stands") {
  Log log(1, {{0.1, 0.11}});
  for (std::size_t i = 0; i < log.t.size(); ++i) log.force[i] = 50 * log.force[i] + (log.t[i] > 0.105 ? 20 : 0);
  const auto level = [](double noise) { return stance_threshold(5000, 20, noise); };
  const std::vector<Stance> all = stances(log.t, log.force, level(0.1));
  REQUIRE(all.size() == 1);
  CHECK(std::isnan(all[0].liftoff));
  CHECK(level(std::nan("")) == level(0.1));
  CHECK(level(30) == 30);
  CHECK(stance_threshold(100, 0, 1) == 5);
}
