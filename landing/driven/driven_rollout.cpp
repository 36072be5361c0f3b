#include "landing/driven/driven_rollout.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "landing/body/body_system.hpp"
#include "landing/driven/driven_kernel.hpp"

namespace ukemi::landing {

void check_driven(const Robot& robot) {
  if (robot.base == Base::kPinned && !robot.joint_of(0))
    throw InputError("link " + quoted(robot.links[0].name) +
                     ": trials need the angle of every link: the first link needs a joint of its own, its pin");
}

namespace {

void check(const Commands& commands, const Robot& robot) {
  if (!commands.push.empty() && commands.push.size() != robot.pushes.size())
    throw InputError(std::to_string(commands.push.size()) + " forces: one for each of " +
                     std::to_string(robot.pushes.size()) + " pushes of the robot is needed");
}

template <class F>
auto in_driven_kernel(const Robot& robot, F&& f) {
  return in_kernel<kPendulum, kTriple, kQuad, kSmall, kLateLeg, kLate, kAny>(robot, f);
}

}  // namespace

std::vector<double> extensions(const Robot& robot, const std::vector<std::vector<double>>& phi) {
  using System = BodySystem<kAny>;
  System system(robot, 0);
  std::vector<double> out(phi.empty() ? 0 : phi.front().size());
  for (std::size_t row = 0; row < out.size(); ++row) {
    System::State y = System::State::Zero();
    for (int i = 0; i < system.body.joints; ++i) {
      const TreeJoint& at = system.body.joint[i];
      const double parent = at.parent < 0 ? 0 : y[System::kTheta + at.parent];
      y[System::kTheta + at.child] = phi[std::size_t(at.joint)][row] - at.offset + parent;
    }
    const auto pose = system.pose(y);
    for (int i = 0; i < system.body.contacts; ++i) {
      const auto r = position(system.body.contact[i], pose, system.body.bodies);
      out[row] = std::max(out[row], -(r[0] * system.body.rail[0] + r[1] * system.body.rail[1]));
    }
  }
  return out;
}

double stable_step(const Robot& robot, const CommandPath& path, const Commands& commands, const DrivenStart& start) {
  check(commands, robot);
  return in_driven_kernel(robot,
                          [&]<Capacity kSize>() { return stable_in_kernel<kSize>(robot, path, commands, start); });
}

DrivenRollout roll_driven(const Robot& robot, const CommandPath& path, const Commands& commands,
                          const DrivenStart& start, const std::vector<double>& times, const DrivenOptions& options) {
  check_driven(robot);
  if (times.empty() || commands.t.empty()) throw InputError("a trial of no rows");
  check(commands, robot);
  DrivenOptions resolved = options;
  if (resolved.step <= 0) resolved.step = stable_step(robot, path, commands, start);
  return in_driven_kernel(
      robot, [&]<Capacity kSize>() { return roll_in_kernel<kSize>(robot, path, commands, start, times, resolved); });
}

}  // namespace ukemi::landing
