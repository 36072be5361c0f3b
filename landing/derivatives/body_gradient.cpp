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

/// Indices into kContactKeys.
constexpr int kPlainConstants = kConstants + 1;  // of Eq. 2-4, and tau_max: the first of actuator_constants()
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

/// Throws InputError for a parameter that the robot has not.
void check(const BodyParameter& p, const Robot& robot) {
  const bool is_contact = p.of == Of::kContact, all = p.index == -1 && (p.of == Of::kMotion || is_contact);
  const std::size_t count = is_contact ? robot.contacts.size() : robot.joints.size();
  const bool which_valid = p.which >= 0 && std::size_t(p.which) < count_of(p.of),
             index_valid = all || p.of == Of::kDrop || (p.index >= 0 && std::size_t(p.index) < count);
  if (!which_valid || !index_valid)
    throw InputError(fmt::format("parameter: the robot has none of {}, {}", p.index, p.which));
  if (all || p.of == Of::kDrop || is_contact) return;
  const Joint& joint = robot.joints[std::size_t(p.index)];
  if (!joint.driven()) throw InputError("parameter: joint " + joint.name + " is not driven");
}

/// Whether a derivative by the parameter needs a term that kernels of Plain::kLinksAndDrives leave out.
bool is_plain(const BodyParameter& p) {
  if (p.of == Of::kContact) return p.which <= kDampingTangential;
  return p.of != Of::kDrive || p.which < kPlainConstants;
}

BodyGradients gradients_of_run(const BodyScene& scene, const BodyMotion& motion,
                               std::span<const BodyParameter> parameters, const SimulateOptions& options,
                               int max_peaks) {
  const bool few = parameters.size() <= std::size_t(kFewParameters),
             plain = std::all_of(parameters.begin(), parameters.end(), is_plain);
  return in_gradient_kernel(scene.robot, plain, [&]<Capacity kSize>() {
    if constexpr (kSize.plain == Plain::kLinksAndDrives)
      if (few) return gradients_in_kernel<kSize, kFewParameters>(scene, motion, parameters, options, max_peaks);
    return gradients_in_kernel<kSize, kParametersPerRun>(scene, motion, parameters, options, max_peaks);
  });
}

/// Appends the derivatives of `more` to those of `out`. Steps depend on the derivatives, so maxima of both runs are
/// matched by their times; unmatched ones are dropped.
void append_derivatives(std::vector<BodyPeakGradient>& out, const std::vector<BodyPeakGradient>& more) {
  constexpr double kSameTime = 1e-6;  // [s]
  std::vector<BodyPeakGradient> common;
  for (BodyPeakGradient& p : out) {
    const auto same = std::find_if(more.begin(), more.end(), [&](const BodyPeakGradient& q) {
      return q.kind == p.kind && std::abs(q.t - p.t) < kSameTime;
    });
    if (same == more.end()) continue;
    const Eigen::Index n = p.d.size();
    p.d.conservativeResize(n + same->d.size());
    p.d.tail(same->d.size()) = same->d;
    common.push_back(p);
  }
  out = std::move(common);
}
void append_derivatives(BodyGradients& out, const BodyGradients& more) {
  append_derivatives(out.peaks, more.peaks);
  for (std::size_t i = 0; i < out.loads.size(); ++i) append_derivatives(out.loads[i], more.loads[i]);
  if (out.end != End::kFailed) out.end = more.end, out.status = more.status;
  out.work += more.work;
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
  return (p.index < 0 ? "contact." : "contact." + robot.contacts[index].name + ".") + kContactKeys[which];
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
  if (p.of == Of::kContact && p.index >= 0) {
    ContactPoint& c = scene.robot.contacts[std::size_t(p.index)];
    double* const x = contact_constant(c, kContactKeys[std::size_t(p.which)]);
    if (!x) throw InputError("parameter: contact " + c.name + " has no pad");
    return *x;
  }
  if (p.index < 0) throw InputError("parameter: the number of one joint or contact is needed");
  Motion& m = motion.at(std::size_t(p.index));
  if (p.which == kToSlot && !m.reposition) throw InputError("parameter: the joint does not move in the air");
  double none = 0;
  return *motion_numbers(m, none)[std::size_t(p.which)];
}

BodyGradients gradients(const BodyScene& scene, const BodyMotion& motion, std::span<const BodyParameter> parameters,
                        const SimulateOptions& options, int max_peaks) {
  scene.validate(), validate(scene.robot, motion), options.validate();
  for (const BodyParameter& p : parameters) check(p, scene.robot);
  // A few more than requested: only maxima found by all runs are kept.
  const int peaks_per_run = parameters.size() > std::size_t(kParametersPerRun) ? max_peaks + 2 : max_peaks;
  BodyGradients out;
  std::size_t from = 0;
  do {
    const std::size_t count = std::min<std::size_t>(kParametersPerRun, parameters.size() - from);
    const BodyGradients run = gradients_of_run(scene, motion, parameters.subspan(from, count), options, peaks_per_run);
    if (from == 0)
      out = run;
    else
      append_derivatives(out, run);
    from += count;
  } while (from < parameters.size());
  const std::size_t kept = std::size_t(std::max(1, max_peaks));
  const auto cut = [&](std::vector<BodyPeakGradient>& peaks) {
    if (peaks.size() > kept) peaks.resize(kept);
  };
  cut(out.peaks), std::for_each(out.loads.begin(), out.loads.end(), cut);
  return out;
}

}  // namespace ukemi::landing
