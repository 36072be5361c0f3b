// 100 robots of two to five links whose landings were computed independently in maximal coordinates
// (datasets/reference/ legs, its README): peak, order and time of touchdowns.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <sstream>

#include "landing/body/body_run.hpp"

using namespace ukemi::landing;

namespace {

struct Case {
  std::string scene, motion, contacts;
  double first, peak;
};
std::vector<Case> cases(const std::string& file) {
  std::ifstream in(std::string(UKEMI_DATASETS "/reference/legs/") + file);
  std::vector<Case> out;
  for (std::string line; std::getline(in, line);) {
    if (line[0] == '#' || line.rfind("scene", 0) == 0) continue;
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    REQUIRE(cells.size() == 7);
    out.push_back({cells[0], cells[1], cells[5], std::stod(cells[4]), std::stod(cells[6])});
  }
  return out;
}

/// One of its contacts leaves the floor for a moment and comes back, or does not: its peak and all else agree.
constexpr const char* kChatters = "floor_022.toml";

/// The contacts in the order of their touchdowns, as many as `like` names.
std::string order_of(const BodyLanding& l, const Robot& robot, const std::string& like) {
  const auto names = std::size_t(std::count(like.begin(), like.end(), ' ')) + 1;
  std::string out;
  for (std::size_t i = 0; i < std::min(names, l.touches.size()); ++i)
    out += (i > 0 ? " " : "") + robot.contacts[std::size_t(l.touches[i].point)].name;
  return out;
}

/// How many are beyond 1e-6; those named may be. Of `sensitive` ones the tight accuracy counts.
int beyond(const std::string& file, const std::vector<std::string>& named, const std::vector<std::string>& sensitive) {
  const std::string folder = UKEMI_DATASETS "/reference/legs/";
  int out = 0;
  for (const Case& c : cases(file)) {
    const BodyScene scene = read_body_scene(folder + c.scene);
    const BodyMotion motion = read_body_motion(folder + c.motion, scene.robot);
    const auto is_in = [&](const std::vector<std::string>& list) {
      return std::find(list.begin(), list.end(), c.scene) != list.end();
    };
    const SimulateOptions options{.accuracy = is_in(sensitive) ? 1e-12 : 1e-10, .rest = SimulateOptions::Rest::kIgnore};
    const BodyLanding l = simulate(scene, motion, options);
    INFO(c.scene << ": peak " << l.peak << ", reference " << c.peak);
    CHECK(l.end == End::kTimeLimit);
    CHECK(std::abs(l.contacts.first() - c.first) < 2e-9);
    if (!is_in(named) && c.scene != kChatters) CHECK(order_of(l, scene.robot, c.contacts) == c.contacts);
    const bool off = !(std::abs(l.peak / c.peak - 1) < 1e-6);
    CHECK(off == is_in(named));
    out += off;
  }
  return out;
}

}  // namespace

TEST_CASE("legs: 60 reference landings of two to five links, every base and drive") {
  CHECK(cases("peaks.csv").size() == 60);
  CHECK(beyond("peaks.csv", {}, {"leg_042.toml", "leg_045.toml"}) == 0);
}

// The four that differ: integrated without events, with steps of 2e-6 s and the modes read off the state, floor_019 and
// floor_031 come to our peaks (430.203, 191.585), not to the reference's.
TEST_CASE("legs: 40 reference landings with friction that holds, pads and slopes") {
  CHECK(cases("floor_peaks.csv").size() == 40);
  CHECK(beyond("floor_peaks.csv", {"floor_003.toml", "floor_019.toml", "floor_031.toml", "floor_037.toml"}, {}) == 4);
}
