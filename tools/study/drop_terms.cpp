#include "tools/study/drop_terms.hpp"

#include <algorithm>
#include <numbers>

namespace ukemi::tools {

using landing::Parameter, landing::Scene, identify::Scope;

identify::Parameter DropTerm::column(const Scene& start, const identify::Choice& choice) const {
  const double at = value_in(start);
  return identify::parameter_of(*this, at, is_constant() && lower >= 0 ? std::max(at, size) : size, choice);
}

bool DropTerm::moves_what(const DropTerm& other) const {
  Scene scene;
  scene.floor.emplace();
  return field && other.field && field(scene) == other.field(scene);
}

namespace {

constexpr double kPi = std::numbers::pi;

DropTerm floor_constant(const char* name, const char* unit, const char* words, double smallest_part,
                        Parameter derivative, double* (*field)(Scene&)) {
  return {{.name = name,
           .unit = unit,
           .words = words,
           .role = identify::Term::Role::kConstant,
           .lower = 0,
           .smallest_part = smallest_part},
          field,
          derivative};
}

std::vector<DropTerm> table() {
  constexpr auto kEach = Scope::kEach;
  const auto pitch = [](Scene& s) { return &s.drop.pitch; };
  return {
      floor_constant("stiffness", "N/m", "stiffness of the floor", 1e-3, Parameter::kStiffness,
                     [](Scene& s) { return &s.floor->stiffness; }),
      floor_constant("damping_normal", "N/(m/s)", "damping of the floor along its normal", 0, Parameter::kDampingNormal,
                     [](Scene& s) { return &s.floor->damping_normal; }),
      floor_constant("damping_tangential", "N/(m/s)", "damping of the floor along it", 0, Parameter::kDampingTangential,
                     [](Scene& s) { return &s.floor->damping_tangential; }),
      {{.name = "pitch",
        .unit = "rad",
        .words = "pitch at release",
        .role = identify::Term::Role::kConstant,
        .lower = -kPi,
        .upper = kPi,
        .size = 10 * kPi / 180,
        .judged_size = 10 * kPi / 180},  // its zero is a convention
       pitch,
       Parameter::kPitch,
       0.2},
      {{.name = "time_shift",
        .unit = "s",
        .words = "by which the log's t = 0 is after the release",
        .scope = kEach,
        .lower = -kLargestShift,
        .upper = kLargestShift,
        .size = 1e-3}},
      {{.name = "height_offset", .unit = "m", .words = "added to the drop's height", .scope = kEach, .size = 0.01},
       [](Scene& s) { return &s.drop.height; },
       Parameter::kHeight},
      {{.name = "speed_offset", .unit = "m/s", .words = "added to its forward speed", .scope = kEach, .size = 0.05},
       [](Scene& s) { return &s.drop.forward_speed; },
       Parameter::kForwardSpeed},
      {{.name = "pitch_offset", .unit = "rad", .words = "added to its pitch", .scope = kEach, .size = 0.02},
       pitch,
       Parameter::kPitch},
  };
}

}  // namespace

const std::vector<DropTerm>& drop_terms() {
  static const std::vector<DropTerm> terms = table();
  return terms;
}

identify::Terms<DropTerm> drop_choice() { return identify::all_constants(drop_terms()); }

}  // namespace ukemi::tools
