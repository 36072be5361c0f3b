// Landings of robots of links a second, one by one and in SIMD lanes: bench_body_lanes PAPER.toml TABLE2.toml. The
// paper's link in a chain of two to five, every joint driven by Table 2; 1,500 random motions at 1e-6, every path in
// turn, the least of three passes.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "common/actuator.hpp"
#include "common/random.hpp"
#include "common/stopwatch.hpp"
#include "landing/body/by_links.hpp"
#include "landing/lanes/body_batch.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/plan/body_space.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {

constexpr int kLandings = 1500, kPasses = 3;

/// The paper's shank with so many further ones below, each with a contact at its end.
BodyScene chain(const Scene& paper, const Actuator& actuator, int links) {
  BodyScene out;
  out.robot = by_links(paper.robot, paper.contacts,
                       {.stiffness = paper.floor->stiffness,
                        .damping_normal = paper.floor->damping_normal,
                        .damping_tangential = paper.floor->damping_tangential});
  Robot& robot = out.robot;
  robot.joints[0].sea = actuator.sea;
  for (int i = 2; i < links; ++i) {
    Link link = robot.links.back();
    Joint joint = robot.joints.back();
    ContactPoint contact = robot.contacts.back();
    link.name += "_", link.parent = i - 1, link.at = {2 * link.com.along, 0};
    joint.name += "_", joint.child = i;
    contact.name += "_", contact.link = i;
    robot.links.push_back(link), robot.joints.push_back(joint), robot.contacts.push_back(contact);
  }
  out.floor = true, out.drop = paper.drop, out.search.resize(robot.joints.size());
  out.validate();
  return out;
}

std::vector<double> rates(const BodyScene& scene) {
  const BodySpace space(scene);
  std::vector<BodyMotion> motions;
  for (int i = 0; i < kLandings; ++i) {
    Random r(1, std::uint64_t(i));
    Coordinates u(space.dimension());
    for (double& x : u) x = r.uniform();
    motions.push_back(space.motion(u));
  }
  std::vector<BodyBatchCase> cases;
  for (const BodyMotion& m : motions) cases.push_back({&scene, &m});
  std::vector<BodyLanding> landings(cases.size());
  std::vector<double> least(std::size_t(widest_instruction_set()) + 2, std::numeric_limits<double>::infinity());
  for (int pass = 0; pass < kPasses; ++pass)
    for (std::size_t path = 0; path < least.size(); ++path) {
      const Stopwatch watch(Stopwatch::Time::kProcessor);
      if (path == 0)
        for (std::size_t i = 0; i < cases.size(); ++i)
          landings[i] = peak_acceleration(scene, motions[i], {.accuracy = 1e-6});
      else
        body_batch_peaks(cases, landings, {.accuracy = 1e-6}, 1, InstructionSet(path - 1));
      least[path] = std::min(least[path], watch.seconds());
    }
  for (double& x : least) x = kLandings / x;
  return least;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return fmt::print(stderr, "usage: bench_body_lanes PAPER.toml TABLE2.toml\n"), 2;
  const Scene paper = read_scene(argv[1]);
  const Actuator actuator = read_actuator(argv[2]);
  fmt::print("links,path,landings_per_second,times_scalar,of_two_links\n");
  std::vector<double> two;
  for (int links = 2; links <= 5; ++links) {
    const std::vector<double> rate = rates(chain(paper, actuator, links));
    if (two.empty()) two = rate;
    for (std::size_t p = 0; p < rate.size(); ++p)
      fmt::print("{},{},{:.0f},{:.2f},{:.3f}\n", links, p == 0 ? "scalar" : kInstructionSetNames[p - 1], rate[p],
                 rate[p] / rate[0], rate[p] / two[p]);
  }
}
