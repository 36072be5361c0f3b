#include "tools/study/drop_terms.hpp"

#include <algorithm>
#include <numbers>

namespace ukemi::tools {

using identify::Scope;

identify::Parameter DropTerm::column(double start, const identify::Choice& choice) const {
  return identify::parameter_of(*this, start, is_constant() && lower >= 0 ? std::max(start, size) : size, choice);
}

bool DropTerm::moves_same_number(const DropTerm& other) const {
  return std::any_of(moves.begin(), moves.end(), [&](const std::string& number) {
    return std::find(other.moves.begin(), other.moves.end(), number) != other.moves.end();
  });
}

DropTerm floor_term(const std::string& name, const std::string& unit, const std::string& words, double smallest_part,
                    std::vector<std::string> moves) {
  return {{.name = name,
           .unit = unit,
           .words = words,
           .role = identify::Term::Role::kConstant,
           .lower = 0,
           .smallest_part = smallest_part},
          std::move(moves)};
}

DropTerm pitch_term() {
  constexpr double kPi = std::numbers::pi;
  return {{.name = "pitch",
           .unit = "rad",
           .words = "pitch at release",
           .role = identify::Term::Role::kConstant,
           .lower = -kPi,
           .upper = kPi,
           .size = 10 * kPi / 180,
           .judged_size = 10 * kPi / 180},  // its zero is a convention
          {"pitch"},
          0.2};
}

std::vector<DropTerm> drop_nuisances() {
  constexpr auto kEach = Scope::kEach;
  return {
      {{.name = "time_shift",
        .unit = "s",
        .words = "by which the log's t = 0 is after the release",
        .scope = kEach,
        .lower = -kLargestShift,
        .upper = kLargestShift,
        .size = 1e-3}},
      {{.name = "height_offset", .unit = "m", .words = "added to the drop's height", .scope = kEach, .size = 0.01},
       {"height"}},
      {{.name = "speed_offset", .unit = "m/s", .words = "added to its forward speed", .scope = kEach, .size = 0.05},
       {"forward_speed"}},
      {{.name = "pitch_offset", .unit = "rad", .words = "added to its pitch", .scope = kEach, .size = 0.02}, {"pitch"}},
  };
}

const std::vector<DropTerm>& drop_terms() {
  static const std::vector<DropTerm> terms = [] {
    std::vector<DropTerm> out = {
        floor_term("stiffness", "N/m", "stiffness of the floor", 1e-3, {"stiffness"}),
        floor_term("damping_normal", "N/(m/s)", "damping of the floor along its normal", 0, {"damping_normal"}),
        floor_term("damping_tangential", "N/(m/s)", "damping of the floor along it", 0, {"damping_tangential"}),
        pitch_term()};
    for (DropTerm& t : drop_nuisances()) out.push_back(std::move(t));
    return out;
  }();
  return terms;
}

identify::Terms<DropTerm> drop_choice() { return identify::all_constants(drop_terms()); }

}  // namespace ukemi::tools
