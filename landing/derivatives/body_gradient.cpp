#include "landing/derivatives/body_gradient.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/actuator.hpp"
#include "common/actuator_constants.hpp"
#include "common/error.hpp"
#include "landing/body/floor_constants.hpp"
#include "landing/derivatives/differentiated_body.hpp"
#include "landing/derivatives/gradient_kernel.hpp"

namespace ukemi::landing {

namespace {

using Of = BodyParameter::Of;

/// Of kContactKeys.
enum { kStiffness, kDampingNormal, kDampingTangential, kStiffnessTangential, kFriction, kExponent, kDissipation, kPad };

std::size_t count_of(Of of) {
  switch (of) {
    case Of::kMotion:
      return kMotionNames.size();
    case Of::kDrop:
      return kDropNames.size();
    case Of::kDrive:
      return actuator_constants().size();
    case Of::kContact:
      break;
  }
  return kContactKeys.size();
}

/// Throws InputError for what the robot has not.
void check(const BodyParameter& p, const Robot& robot) {
  const bool of_contact = p.of == Of::kContact, all = p.index == -1 && p.of == Of::kMotion;
  const std::size_t most = of_contact ? robot.contacts.size() : robot.joints.size();
  const bool known = p.which >= 0 && std::size_t(p.which) < count_of(p.of),
             there = all || p.of == Of::kDrop || (p.index >= 0 && std::size_t(p.index) < most);
  if (!known || !there) throw InputError(fmt::format("parameter: the robot has none of {}, {}", p.index, p.which));
  if (all || p.of == Of::kDrop || of_contact) return;
  const Joint& joint = robot.joints[std::size_t(p.index)];
  if (!joint.driven()) throw InputError("parameter: joint " + joint.name + " is not driven");
}

BodyGradients some_gradients(const BodyScene& scene, const BodyMotion& motion,
                             std::span<const BodyParameter> parameters, const SimulateOptions& options, int most) {
  return in_landing_kernel(scene.robot, [&]<Capacity kSize>() {
    return gradients_in_kernel<kSize>(scene, motion, parameters, options, most);
  });
}

/// The derivatives of `more` behind those of `out`. The runs step by their own derivatives too, so that one maximum of
/// both is told by its time; what is no maximum of both is dropped.
void join(std::vector<BodyPeakGradient>& out, const std::vector<BodyPeakGradient>& more) {
  constexpr double kOneTime = 1e-6;  // [s]
  std::vector<BodyPeakGradient> both;
  for (BodyPeakGradient& p : out) {
    const auto same = std::find_if(more.begin(), more.end(), [&](const BodyPeakGradient& q) {
      return q.kind == p.kind && std::abs(q.t - p.t) < kOneTime;
    });
    if (same == more.end()) continue;
    const Eigen::Index n = p.d.size();
    p.d.conservativeResize(n + same->d.size());
    p.d.tail(same->d.size()) = same->d;
    both.push_back(p);
  }
  out = std::move(both);
}
void join(BodyGradients& out, const BodyGradients& more) {
  join(out.peaks, more.peaks);
  for (std::size_t i = 0; i < out.loads.size(); ++i) join(out.loads[i], more.loads[i]);
  if (out.end != End::kFailed) out.end = more.end, out.status = more.status;
}

}  // namespace

std::string name(const BodyParameter& p, const Robot& robot) {
  check(p, robot);
  const auto which = std::size_t(p.which);
  if (p.of == Of::kDrop) return std::string("drop.") + kDropNames[which];
  if (p.of == Of::kMotion && p.index < 0) return kMotionNames[which];
  const auto index = std::size_t(p.index);
  if (p.of == Of::kMotion) return kMotionNames[which] + ("_" + robot.joints[index].name);
  if (p.of == Of::kDrive) return "drive." + robot.joints[index].name + "." + actuator_constants()[which].key;
  return "contact." + robot.contacts[index].name + "." + kContactKeys[which];
}

std::vector<BodyParameter> parameters_of(const BodyScene& scene, const BodyMotion& motion) {
  const Robot& robot = scene.robot;
  validate(robot, motion);
  std::vector<BodyParameter> out;
  const auto add = [&](Of of, int index, int which) { out.push_back({of, index, which}); };
  for (int i = 0; i < int(robot.joints.size()); ++i) {
    if (!robot.joints[std::size_t(i)].driven()) continue;
    const bool moves = motion[std::size_t(i)].reposition && std::isfinite(motion[std::size_t(i)].reposition->to);
    for (int k = 0; k < kToSlot + moves; ++k) add(Of::kMotion, i, k);
  }
  if (robot.base != Base::kPinned) add(Of::kDrop, -1, 0), add(Of::kDrop, -1, 2), add(Of::kDrop, -1, 4);
  if (robot.base == Base::kFree) add(Of::kDrop, -1, 1);
  if (robot.base != Base::kRail) add(Of::kDrop, -1, 3);
  for (int i = 0; i < int(robot.joints.size()); ++i) {
    const Joint& joint = robot.joints[std::size_t(i)];
    if (!joint.driven()) continue;
    const auto constants = actuator_constants();
    for (int k = 0; k < int(constants.size()); ++k) {
      const double x = joint.sea.*constants[std::size_t(k)].at;
      if (std::isfinite(x) && x != constants[std::size_t(k)].absent) add(Of::kDrive, i, k);
    }
  }
  for (int i = 0; i < int(robot.contacts.size()) && scene.floor; ++i) {
    const ContactPoint& c = robot.contacts[std::size_t(i)];
    add(Of::kContact, i, kStiffness);
    if (!c.law.hunt_crossley) add(Of::kContact, i, kDampingNormal);
    if (c.law.stiffness_tangential > 0) add(Of::kContact, i, kStiffnessTangential);
    add(Of::kContact, i, kDampingTangential);
    if (std::isfinite(c.law.friction)) add(Of::kContact, i, kFriction);
    if (c.law.hunt_crossley) add(Of::kContact, i, kExponent), add(Of::kContact, i, kDissipation);
    for (int k = 0; k < 3 && c.pad; ++k) add(Of::kContact, i, kPad + k);
  }
  return out;
}

double& number(BodyScene& scene, BodyMotion& motion, const BodyParameter& p) {
  check(p, scene.robot);
  if (p.of == Of::kDrop) return *drop_numbers(scene.drop)[std::size_t(p.which)];
  if (p.of == Of::kDrive)
    return scene.robot.joints[std::size_t(p.index)].sea.*actuator_constants()[std::size_t(p.which)].at;
  if (p.of == Of::kContact) {
    ContactPoint& c = scene.robot.contacts[std::size_t(p.index)];
    double* const x = contact_constant(c, kContactKeys[std::size_t(p.which)]);
    if (!x) throw InputError("parameter: contact " + c.name + " has no pad");
    return *x;
  }
  if (p.index < 0) throw InputError("parameter: one joint's number is needed");
  Motion& m = motion.at(std::size_t(p.index));
  if (p.which == kToSlot && !m.reposition) throw InputError("parameter: the joint does not move in the air");
  double none = 0;
  return *motion_numbers(m, none)[std::size_t(p.which)];
}

BodyGradients gradients(const BodyScene& scene, const BodyMotion& motion, std::span<const BodyParameter> parameters,
                        const SimulateOptions& options, int most) {
  scene.validate(), validate(scene.robot, motion), options.validate();
  for (const BodyParameter& p : parameters) check(p, scene.robot);
  // A few more than asked for: what is joined is of all runs.
  const int each = parameters.size() > std::size_t(kAtOnce) ? most + 2 : most;
  BodyGradients out;
  std::size_t from = 0;
  do {
    const std::size_t count = std::min<std::size_t>(kAtOnce, parameters.size() - from);
    const BodyGradients some = some_gradients(scene, motion, parameters.subspan(from, count), options, each);
    if (from == 0)
      out = some;
    else
      join(out, some);
    from += count;
  } while (from < parameters.size());
  const std::size_t kept = std::size_t(std::max(1, most));
  const auto cut = [&](std::vector<BodyPeakGradient>& peaks) {
    if (peaks.size() > kept) peaks.resize(kept);
  };
  cut(out.peaks), std::for_each(out.loads.begin(), out.loads.end(), cut);
  return out;
}

}  // namespace ukemi::landing
