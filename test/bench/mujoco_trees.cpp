// Accelerations of random trees of links beside MuJoCo's, whose equations are others: bench_mujoco_trees [TREES
// [SEED]]. Needs Debian's libmujoco-dev. Exit code 1 where any differs by more than 1e-9 of the tree's largest.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "test/legs/trees.hpp"

using namespace legs;

namespace {

/// The tree as MJCF in the plane of x and z: links hang along -z, hinges turn about -y. `pitch`: of a base on a rail.
std::string mjcf(const Robot& robot, double pitch) {
  std::string out = fmt::format(
      "<mujoco><compiler angle=\"radian\" inertiafromgeom=\"false\"/><option gravity=\"0 0 {:.17g}\"/><worldbody>",
      -robot.gravity);
  const std::function<void(int)> add = [&](int i) {
    const Link& l = robot.links[std::size_t(i)];
    const auto place = [](const Place& p) { return fmt::format("{:.17g} 0 {:.17g}", p.across, -p.along); };
    out += fmt::format("<body name=\"b{}\" pos=\"{}\"", i, i == 0 ? "0 0 0" : place(l.at));
    const bool rail = robot.base == Base::kRail;
    if (i == 0 && rail) out += fmt::format(" axisangle=\"0 -1 0 {:.17g}\"", pitch);
    out += ">";
    if (i == 0 && rail) {
      const double c = std::cos(robot.rail_direction - pitch), s = std::sin(robot.rail_direction - pitch);
      out += fmt::format("<joint name=\"rail\" type=\"slide\" axis=\"{:.17g} 0 {:.17g}\"/>", c, s);
    }
    if (i == 0 && robot.base == Base::kFree)
      out += "<joint name=\"x\" type=\"slide\" axis=\"1 0 0\"/><joint name=\"z\" type=\"slide\" axis=\"0 0 1\"/>";
    if (i > 0 || !rail) out += fmt::format("<joint name=\"j{}\" type=\"hinge\" axis=\"0 -1 0\"/>", i);
    out += fmt::format("<inertial pos=\"{0}\" mass=\"{1:.17g}\" diaginertia=\"{2:.17g} {2:.17g} {2:.17g}\"/>",
                       place(l.com), l.mass, l.inertia_com);
    for (int k = i + 1; k < int(robot.links.size()); ++k)
      if (robot.links[std::size_t(k)].parent == i) add(k);
    out += "</body>";
  };
  add(0);
  return out + "</worldbody></mujoco>";
}

/// By how much its accelerations differ from ours, in parts of the largest.
double apart(const Robot& robot, const State& y, const std::string& path) {
  std::ofstream(path) << mjcf(robot, y[System::kTheta]);
  char error[1000] = "";
  mjModel* const model = mj_loadXML(path.c_str(), nullptr, error, sizeof error);
  if (!model) throw std::runtime_error(error);
  mjData* const data = mj_makeData(model);
  const auto joint = [&](const std::string& name) { return mj_name2id(model, mjOBJ_JOINT, name.c_str()); };
  const int links = int(robot.links.size());
  for (int i = 0; i < links; ++i) {
    const int j = joint(fmt::format("j{}", i)), parent = robot.links[std::size_t(i)].parent;
    if (j < 0) continue;
    data->qpos[model->jnt_qposadr[j]] = y[System::kTheta + i] - (parent < 0 ? 0 : y[System::kTheta + parent]);
    data->qvel[model->jnt_dofadr[j]] = y[System::kOmega + i] - (parent < 0 ? 0 : y[System::kOmega + parent]);
  }
  mj_forward(model, data);
  System ours(robot, 0);
  const State dy = ours.derivative(0, y);
  std::vector<double> theirs(std::size_t(links), 0.0);
  double largest = 1, out = 0;
  for (int i = 0; i < links; ++i) {
    const int j = joint(fmt::format("j{}", i)), parent = robot.links[std::size_t(i)].parent;
    const double own = j < 0 ? 0 : data->qacc[model->jnt_dofadr[j]];
    theirs[std::size_t(i)] = own + (parent < 0 ? 0 : theirs[std::size_t(parent)]);
    largest = std::max(largest, std::abs(theirs[std::size_t(i)]));
  }
  for (int i = 0; i < links; ++i) out = std::max(out, std::abs(theirs[std::size_t(i)] - dy[System::kOmega + i]));
  if (robot.base == Base::kRail) {
    const double travel = data->qacc[model->jnt_dofadr[joint("rail")]];
    largest = std::max(largest, std::abs(travel)), out = std::max(out, std::abs(travel - dy[System::kVx]));
  }
  mj_deleteData(data), mj_deleteModel(model);
  return out / largest;
}

}  // namespace

int main(int argc, char** argv) {
  const int trees = argc > 1 ? std::atoi(argv[1]) : 1000;
  const auto seed = std::uint64_t(argc > 2 ? std::atoll(argv[2]) : 20261127);
  const std::string path = (std::filesystem::temp_directory_path() / fmt::format("ukemi_tree_{}.xml", seed)).string();
  double worst = 0;
  for (int n = 0; n < trees; ++n) {
    Random r(seed, std::uint64_t(n));
    const Robot robot =
        random_tree(r, kMaxLinks, std::array{Base::kFree, Base::kRail, Base::kPinned}[std::size_t(n % 3)]);
    worst = std::max(worst, apart(robot, random_state(r, robot), path));
  }
  std::filesystem::remove(path);
  fmt::print("{} random trees of 2 to {} links beside MuJoCo {}: accelerations within {:.1e} of the tree's largest\n",
             trees, kMaxLinks, mj_versionString(), worst);
  return worst < 1e-9 ? 0 : 1;
}
