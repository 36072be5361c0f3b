// What a number of a design buys: the numbers by their names, and that no neighbour's motion is better.
#include "landing/plan/trade.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>

#include "common/error.hpp"
#include "landing/body/load.hpp"
#include "landing/body/places.hpp"
#include "landing/plan/design_numbers.hpp"
#include "landing/plan/trade_journal.hpp"
#include "test/folder.hpp"
#include "test/legs/robots.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using Catch::Matchers::Contains;

TEST_CASE("legs: every number of a design is found by its name, and set in its file's unit") {
  for (const std::string name : {"hopper", "three_links", "foot"}) {
    const BodyScene scene = legs::shipped(name);
    const std::vector<std::string> names = design_names(scene);
    CHECK(std::set<std::string>(names.begin(), names.end()).size() == names.size());
    for (const std::string& key : names) {
      const double x = design_number(scene, key);
      if (!std::isfinite(x) || x == 0) continue;
      BodyScene changed = scene;
      INFO(name << ": " << key);
      set_design_number(changed, key, 0.9 * x);
      CHECK(design_number(changed, key) == Approx(0.9 * x).epsilon(1e-12));
      if (key.find('*') != std::string::npos) continue;
      for (const std::string& other : names)  // a contact's own, and that of all contacts
        if (key.rfind("drive.", 0) == 0 && other != key && other.find('*') == std::string::npos &&
            std::isfinite(design_number(scene, other)))
          CHECK(design_number(changed, other) == design_number(scene, other));
    }
  }
}

TEST_CASE("legs: a number of all drives sets each") {
  BodyScene scene = legs::shipped("three_links");
  set_design_number(scene, "drive.*.k_sea", 300);
  set_design_number(scene, "drive.*.speed_max", 9);
  for (const Joint& j : scene.robot.joints) CHECK((j.sea.k_sea == 300 && j.speed_max == 9));
  CHECK(design_number(scene, "drive.*.k_sea") == 300);
}

TEST_CASE("legs: a pad, a rating and a slope as numbers of a design, and what there is not is refused") {
  BodyScene scene = legs::shipped("foot");
  set_design_number(scene, "robot.contact.heel.pad.thickness", 0);
  CHECK_FALSE(scene.robot.contacts[3].pad);
  CHECK(design_number(scene, "robot.contact.heel.pad.thickness") == 0);
  CHECK_THROWS_WITH(set_design_number(scene, "robot.contact.heel.pad.thickness", 0.01),
                    Contains("heel.pad.thickness: there is no pad"));
  scene.robot.joints[1].speed_max.reset();
  CHECK(std::isnan(design_number(scene, "drive.knee.speed_max")));
  set_design_number(scene, "drive.knee.speed_max", 6);
  CHECK(scene.robot.joints[1].speed_max == 6);
  set_design_number(scene, "floor.slope_deg", 5);
  CHECK(scene.slope == Approx(5 * 3.14159265358979 / 180));
  set_design_number(scene, "robot.contact.*.friction", 0.4);
  for (const ContactPoint& c : scene.robot.contacts) CHECK(c.law.friction == 0.4);
  CHECK_THROWS_WITH(set_design_number(scene, "drive.knee.k_see", 1), Contains("drive.knee.k_sea"));
  CHECK_THROWS_WITH(set_design_number(scene, "robot.link.shank.mass", -1), Contains("robot.link.shank.mass = -1"));
}

TEST_CASE("legs: a link's length stretches it with all that is on it") {
  BodyScene scene = legs::shipped("hopper");
  const Robot before = scene.robot;
  CHECK(design_number(scene, "robot.link.thigh.length") == before.links[2].at.along);
  set_design_number(scene, "robot.link.thigh.length", 1.2 * before.links[2].at.along);
  const Link &thigh = scene.robot.links[1], &was = before.links[1];
  CHECK(scene.robot.links[2].at.along == Approx(1.2 * before.links[2].at.along));
  CHECK(thigh.com.along == Approx(1.2 * was.com.along));
  CHECK(thigh.inertia_com == Approx(1.44 * was.inertia_com));
  CHECK(thigh.mass == was.mass);
  for (std::size_t c = 0; c < before.contacts.size(); ++c)
    CHECK(scene.robot.contacts[c].at.along ==
          Approx((before.contacts[c].link == 1 ? 1.2 : 1) * before.contacts[c].at.along));
  CHECK(scene.robot.links[2].com.along == before.links[2].com.along);
  CHECK(reach(scene.robot) > reach(before));
  // A longer shank lands otherwise, and a trade of it is planned.
  TradeOptions options;
  options.search.evaluations = 600;
  const Trade t = trade(legs::shipped("hopper"), {{"robot.link.shank.length", {0.15, 0.2, 0.25}}}, options);
  for (const TradePoint& p : t.points) CHECK((p.found() && p.planned < p.held));
  CHECK(t.points[0].held != Approx(t.points[2].held).epsilon(1e-3));
}

TEST_CASE("legs: a robot's design has the numbers that it reads, and no others") {
  const BodyScene hopper = legs::shipped("hopper");  // geared, on a rail
  for (const char* key : {"drive.knee.k_sea", "drive.*.c_sea", "drop.forward_speed"})
    CHECK_THROWS_WITH(design_number(hopper, key), Contains("no number of this robot"));
  for (const char* key :
       {"drive.knee.k_p", "drive.*.i_motor", "drive.*.speed_max", "drop.height", "drive.hip.friction"})
    CHECK_NOTHROW(design_number(hopper, key));
}

TEST_CASE("legs: no plan of a trade is worse than holding, the middle's motion or that of a neighbour") {
  const BodyScene scene = legs::shipped("hopper");
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
    TradeOptions options;
    options.search.goal = goal, options.search.evaluations = goal == Goal::kPeak ? 1200 : 250;
    const Trade t = trade(scene, {{"drive.knee.k_p", {25, 50, 100, 200}}}, options);
    REQUIRE(t.points.size() == 4);
    CHECK(t.middle == 2);
    CHECK(t.points[2].unchanged == t.points[2].planned);
    for (std::size_t k = 0; k < t.points.size(); ++k) {
      const TradePoint& p = t.points[k];
      REQUIRE(p.found());
      CHECK(p.planned < p.held);
      CHECK(p.planned <= p.unchanged * (1 + 1e-6));
      BodyScene s = scene;
      set_design_number(s, "drive.knee.k_p", p.at[0]);
      const double peak = peak_acceleration(s, p.motion).peak;
      CHECK(p.peak == Approx(peak).epsilon(1e-6));
      if (goal == Goal::kTolerant) CHECK(p.planned >= peak);
      for (const std::size_t i : {k - 1, k + 1})
        if (goal == Goal::kPeak && i < t.points.size())
          CHECK(p.planned <= peak_acceleration(s, t.points[i].motion).peak * (1 + 1e-5));
    }
  }
}

TEST_CASE("legs: a trade of two numbers, under scatter and within ratings") {
  const BodyScene scene = legs::shipped("hopper");
  TradeOptions options;
  options.search.evaluations = 2000, options.search.measure = Measure{}, options.search.samples = 8,
  options.search.judging = 32;
  options.prepare = [](BodyScene& s) { (void)respect_ratings(s); };
  const Trade t = trade(scene, {{"drop.height", {0.2, 0.3}}, {"drive.knee.speed_max", {5, 20}}}, options);
  REQUIRE(t.points.size() == 4);
  CHECK(t.points[1].at == std::vector<double>{0.2, 20});
  for (const TradePoint& p : t.points) CHECK(p.found());
  CHECK(t.points[1].planned <= t.points[3].planned);  // from lower
  CHECK(t.points[1].planned <= t.points[0].planned);  // a faster motor is no loss
  CHECK_THROWS_WITH(trade(scene, {{"drop.height", {0.3, 0.2}}}, options), Contains("that rise"));
  CHECK_THROWS_WITH(trade(scene, {}, options), Contains("one or two"));
}

namespace {

bool same(const TradePoint& a, const TradePoint& b) {
  const auto numbers = [](const TradePoint& p) {
    std::vector<double> out{p.held, p.unchanged, p.planned, p.peak, double(p.plans)};
    for (const Motion& m : p.motion) out.insert(out.end(), {m.phi_i, m.phi_f, m.duration});
    return out;
  };
  return a.at == b.at && a.edges == b.edges && numbers(a) == numbers(b);
}

}  // namespace

TEST_CASE("legs: a trade goes on from where it was stopped, and ends as if it had not been, and parts make a whole") {
  const BodyScene scene = legs::shipped("hopper");
  const std::vector<TradeAxis> axes = {{"drive.knee.k_p", {25, 50, 100, 200}}};
  const test::Folder f;
  TradeOptions options;
  options.search.evaluations = 300;
  const Trade whole = trade(scene, axes, options);
  for (const int stop : {1, 3, 6}) {
    std::vector<TradePoint> known(4);
    {
      TradeJournal journal(f.at(std::to_string(stop)), std::string(16, 'a'), 2, known);
      int done = 0;
      TradeOptions first = options;
      first.done = [&](std::size_t k, const TradePoint& p) { journal.add(k, p), ++done; };
      first.monitor.stop = [&] { return done >= stop; };
      (void)trade(scene, axes, first);
    }
    TradeJournal journal(f.at(std::to_string(stop)), std::string(16, 'a'), 2, known);
    TradeOptions second = options;
    second.known = known;
    const Trade again = trade(scene, axes, second);
    CHECK(again.plans < whole.plans);
    for (std::size_t k = 0; k < 4; ++k) CHECK(same(again.points[k], whole.points[k]));
  }
  std::vector<TradePoint> known(4);
  for (std::size_t part = 0; part < 2; ++part) {
    TradeOptions shard = options;
    shard.part = {part, 2};
    const Trade t = trade(scene, axes, shard);
    for (std::size_t k = 0; k < 4; ++k) {
      CHECK(t.points[k].found() == (k / 2 == part));
      if (t.points[k].plans > 0) known[k] = t.points[k];
    }
  }
  TradeOptions merge = options;
  merge.known = known;
  const Trade merged = trade(scene, axes, merge);
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK(merged.points[k].planned <= known[k].planned);
    CHECK(merged.points[k].planned <= merged.points[k].unchanged);
  }
  TradeOptions bad = options;
  bad.part = {4, 5};
  CHECK_THROWS_WITH(trade(scene, axes, bad), Contains("part 5 of 5"));
}

TEST_CASE("legs: a front falls, each of its motions keeps the limit, and its ends are the best for each load alone") {
  BodyScene scene = legs::shipped("hopper");
  scene.loads = {{.name = "knee", .kind = Load::Kind::kTorque, .index = 1, .rating = 12},
                 {.name = "foot", .kind = Load::Kind::kForce, .index = 2, .rating = 300}};
  std::map<std::string, Front> fronts;
  for (const auto& [cost, limited] : {std::pair("peak", "knee"), {"foot", "knee"}, {"knee", "peak"}}) {
    INFO(cost << " in " << limited);
    TradeOptions options;
    options.search.evaluations = 2500;  // with 1,500 a plan may stay in a wide basin
    const Front front = pareto(scene, cost, limited, 4, options);
    REQUIRE(front.trade.points.size() == 4);
    CHECK(front.trade.axes[0].name == std::string("load.") + limited + ".rating");
    double before = kNoMotion;
    for (const TradePoint& p : front.trade.points) {
      REQUIRE(p.found());
      CHECK(p.planned <= before * (1 + 1e-6));
      before = p.planned;
      const BodyLanding l = peak_acceleration(front.scene, p.motion);
      const std::vector<LoadPeak> loads = loads_of(front.scene, l);
      CHECK(loads.back().value <= p.at[0]);
      CHECK(loads.front().value == Approx(p.planned).epsilon(1e-6));
    }
    fronts.emplace(std::string(cost) + limited, front);
  }
  // Asked the other way round: no motion there is much better in both.
  for (const auto& [one, other] : {std::pair("peakknee", "kneepeak"), {"kneepeak", "peakknee"}})
    for (const TradePoint& p : fronts.at(one).trade.points)
      for (const TradePoint& q : fronts.at(other).trade.points)
        if (1.1 * q.planned <= p.at[0]) {  // its limit is kept in the whole execution box, which q.planned is not of
          INFO(one << ": " << p.planned << " at " << p.at[0] << "; " << q.planned << " at " << q.at[0]);
          CHECK(p.planned <= 1.1 * q.at[0]);
        }
  TradeOptions options;
  options.monitor.stop = [] { return true; };  // before the ends are known nothing is told
  const Front none = pareto(scene, "peak", "knee", 4, options);
  CHECK(std::none_of(none.trade.points.begin(), none.trade.points.end(), [](auto& p) { return p.found(); }));
  CHECK_THROWS_WITH(pareto(scene, "knee", "knee", 4, options), Contains("two loads"));
  CHECK_THROWS_WITH(pareto(scene, "nee", "peak", 4, options), Contains("did you mean \"knee\""));
}

TEST_CASE("legs: a front goes on from where it was stopped, and no plan is made twice, those of its ends neither") {
  BodyScene scene = legs::shipped("hopper");
  scene.loads = {{.name = "knee", .kind = Load::Kind::kTorque, .index = 1, .rating = 12}};
  const test::Folder f;
  const std::size_t count = 3;
  TradeOptions options;
  options.search.evaluations = 300;
  std::set<std::size_t> told;
  options.done = [&](std::size_t k, const TradePoint&) { told.insert(k); };
  const Front whole = pareto(scene, "peak", "knee", count, options);
  REQUIRE(whole.trade.points.size() == count);
  CHECK(told == std::set<std::size_t>{0, 1, 2, 3, 4, 5});
  for (const int stop : {1, 2, 3, 5}) {
    INFO("stopped after " << stop);
    const std::string path = f.at(std::to_string(stop));
    std::vector<TradePoint> known(2 * count);
    int done = 0;
    {
      TradeJournal journal(path, std::string(16, 'a'), 2, known);
      TradeOptions first = options;
      first.known = known;
      first.done = [&](std::size_t k, const TradePoint& p) { journal.add(k, p), ++done; };
      first.monitor.stop = [&] { return done >= stop; };
      (void)pareto(scene, "peak", "knee", count, first);
    }
    TradeJournal journal(path, std::string(16, 'a'), 2, known);
    TradeOptions second = options;
    second.known = known;
    const Front again = pareto(scene, "peak", "knee", count, second);
    CHECK(again.trade.plans == whole.trade.plans - done);
    for (std::size_t k = 0; k < count; ++k) CHECK(same(again.trade.points[k], whole.trade.points[k]));
  }
  TradeOptions bad = options;
  bad.known.resize(count);
  CHECK_THROWS_WITH(pareto(scene, "peak", "knee", count, bad), Contains("3 known points: 6 are needed"));
}

TEST_CASE("legs: a trade that is stopped tells nothing of designs that were not planned") {
  const BodyScene scene = legs::shipped("hopper");
  bool planned = false;
  TradeOptions options;
  options.search.evaluations = 200;
  options.monitor = {[&](long done, long) { planned = done > 0; }, [&] { return planned; }};
  const Trade t = trade(scene, {{"drive.knee.k_p", {25, 50, 100}}}, options);
  CHECK(t.plans == 1);
  for (std::size_t k = 0; k < t.points.size(); ++k) {
    const TradePoint& p = t.points[k];
    CHECK(p.found() == (k == t.middle));
    for (const double value : {p.held, p.planned, p.peak}) CHECK((value < kNoMotion) == (k == t.middle));
  }
  planned = true;  // before anything is planned
  for (const TradePoint& p : trade(scene, {{"drive.knee.k_p", {25, 50}}}, options).points) {
    CHECK_FALSE(p.found());
    CHECK_FALSE(std::min({p.held, p.unchanged, p.planned, p.peak}) < kNoMotion);
  }
}
