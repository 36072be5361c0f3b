#include "landing/plan/body_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/model/release.hpp"

namespace ukemi::landing {

namespace {

/// A number of a motion by its index in motion_numbers. A motion without a move in the air has no `to`.
double& number(Motion& m, int which) {
  double none = 0;
  return *motion_numbers(m, none)[std::size_t(which)];
}

}  // namespace

double fall_acceleration(const Robot& robot) {
  if (robot.base == Base::kPinned) return 0;
  const double along = robot.base == Base::kRail ? std::sin(robot.rail_direction) : 1;
  return robot.gravity * along * along;
}

double fall_time(const BodyScene& scene) {
  const Robot& robot = scene.robot;
  if (!scene.touches() || robot.base == Base::kPinned) return std::numeric_limits<double>::infinity();
  return landing::fall_time(fall_acceleration(robot), scene.drop.height, scene.drop.vertical_speed);
}

BodySpace::BodySpace(const BodyScene& scene) : base_(held_posture(scene)) {
  const std::vector<Joint>& joints = scene.robot.joints;
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (joints[i].driven()) driven_.push_back(int(i));
  if (driven_.empty()) throw InputError("no joint is driven: there is no motion to plan");
  const auto for_each_driven = [&](auto&& f) {
    for (const int i : driven_) f(i, joints[std::size_t(i)].name, scene.search[std::size_t(i)].phi);
  };
  for_each_driven([&](int i, const std::string& name, auto& phi) {
    add(i, 0, {"phi_i_" + name, "phi_I of " + name, "rad", phi[0], phi[1]});
    add(i, 1, {"phi_f_" + name, "phi_F of " + name, "rad", phi[0], phi[1]});
  });
  const std::array<double, 2>& range = scene.duration;
  if (!scene.own_durations) add(-1, 2, {"duration", "duration", "s", range[0], range[1]});
  const Freedom& free = scene.freedom;
  for_each_driven([&](int i, const std::string& name, auto&) {
    if (scene.own_durations) add(i, 2, {"duration_" + name, "duration of " + name, "s", range[0], range[1]});
    for (int k = 0; k < free.bumps; ++k)
      add(i, kBumpSlot + k,
          {fmt::format("b{}_{}", k, name), fmt::format("b_{} of {}", k, name), "rad", free.bump[0], free.bump[1], 0.0});
    if (!free.gains) return;
    const auto& [low, high] = *free.gains;
    add(i, kGainSlot, {"gain_p_" + name, "factor of K_p of " + name, "1", low, high, 1.0});
    add(i, kGainSlot + 1, {"gain_d_" + name, "factor of K_d of " + name, "1", low, high, 1.0});
  });
  if (scene.release) {
    const double from = scene.release->from;
    const auto [soonest, latest] = move_end_range(from, fall_time(scene));
    add(-1, kToSlot, {"to", "end of the move in the air", "s", soonest, latest});
    for (const int i : driven_) base_[std::size_t(i)].reposition->from = from;
  }
  if (dimension() > kMaxVariables)
    throw InputError(fmt::format("a plan of {} variables for {} driven joints: at most {} are needed", dimension(),
                                 driven_.size(), kMaxVariables));
}

void BodySpace::add(int joint, int number, const Variable& variable) {
  slots_.push_back({joint, number}), variables_.push_back(variable);
}

BodyMotion BodySpace::motion(const Coordinates& unit) const {
  BodyMotion out = base_;
  const Coordinates x = values(unit);
  for (std::size_t k = 0; k < variables_.size(); ++k) {
    for (const int i : driven_)
      if (slots_[k].joint < 0 || slots_[k].joint == i) number(out[std::size_t(i)], slots_[k].number) = x[long(k)];
  }
  return out;
}

Coordinates BodySpace::unit(const BodyMotion& motion) const {
  Coordinates out(dimension());
  for (std::size_t k = 0; k < variables_.size(); ++k) {
    const Variable& v = variables_[k];
    Motion m = motion[std::size_t(slots_[k].joint < 0 ? driven_.front() : slots_[k].joint)];
    if (!m.reposition) m.reposition = Reposition{m.phi_i, 0, 0, v.upper};
    out[long(k)] = std::clamp((number(m, slots_[k].number) - v.lower) / (v.upper - v.lower), 0.0, 1.0);
  }
  return out;
}

Coordinates BodySpace::held(Coordinates unit) const {
  const Coordinates held = this->unit(base_);
  double phi_i = 0;  // phi_F of a joint follows its phi_I
  for (std::size_t k = 0; k < slots_.size(); ++k) {
    double& u = unit[long(k)];
    if (slots_[k].number == 0)
      phi_i = u;
    else
      u = slots_[k].number == 1 ? phi_i : held[long(k)];
  }
  return unit;
}

Coordinates BodySpace::values(const Coordinates& unit) const {
  Coordinates out(dimension());
  for (std::size_t k = 0; k < variables_.size(); ++k)
    out[long(k)] = std::lerp(variables_[k].lower, variables_[k].upper, unit[long(k)]);
  return out;
}

Coordinates BodySpace::unit(const Coordinates& values) const {
  Coordinates out(dimension());
  for (std::size_t k = 0; k < variables_.size(); ++k) {
    const auto& [low, high] = std::pair(variables_[k].lower, variables_[k].upper);
    out[long(k)] = high > low ? std::clamp((values[long(k)] - low) / (high - low), 0.0, 1.0) : 0.5;
  }
  return out;
}

std::vector<BodyParameter> BodySpace::parameters() const {
  std::vector<BodyParameter> out;
  for (const Slot& s : slots_) out.push_back({BodyParameter::Of::kMotion, s.joint, s.number});
  return out;
}

Edges BodySpace::edges(const Coordinates& unit) const {
  constexpr double kEdge = 1e-3;
  Edges out{};
  for (int k = 0; k < dimension(); ++k) out[std::size_t(k)] = unit[k] < kEdge ? -1 : unit[k] > 1 - kEdge ? 1 : 0;
  return out;
}

}  // namespace ukemi::landing
