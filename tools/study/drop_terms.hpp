// The drop's terms: the floor's constants and the pitch, one for all drops, and what may differ from drop to drop. One
// entry of the table is all that a term needs to be fitted, bounded, held by a prior and reported.
#pragma once

#include <vector>

#include "identify/estimate/term.hpp"
#include "landing/drops/drop_rollout.hpp"

namespace ukemi::tools {

struct DropTerm : identify::Term {
  /// Where it stands in a scene: a constant is the number there, a nuisance is added to it. Absent: it shifts the log,
  /// and its derivative is the outputs' rate.
  double* (*field)(landing::Scene&) = nullptr;
  landing::Parameter derivative = {};  ///< of the exact derivatives, which it takes
  double spread = 2;  ///< of drawn starts about the scene's: a factor either way, or where it has a sign, an amount

  bool shifts_log() const { return field == nullptr; }
  /// Whether both change the same number of a scene.
  bool moves_what(const DropTerm& other) const;
  double value_in(landing::Scene scene) const { return is_constant() ? *field(scene) : absent; }
  void set_in(landing::Scene& scene, double value) const {
    if (field) *field(scene) = is_constant() ? value : *field(scene) + value;
  }
  /// As a column that starts at a scene's value.
  identify::Parameter column(const landing::Scene& start, const identify::Choice& choice) const;
};

/// The table: stiffness, damping_normal, damping_tangential, pitch; then the nuisance terms.
const std::vector<DropTerm>& drop_terms();
/// All four constants, nothing along.
identify::Terms<DropTerm> drop_choice();

inline constexpr double kLargestShift = 0.02;  ///< of a log [s]; where it is fitted, samples before it are left out

}  // namespace ukemi::tools
