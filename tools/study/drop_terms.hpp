// The drop's terms: the floor's constants and the pitch, one for all drops, and what may differ from drop to drop. One
// entry of the table is all that a term needs to be fitted, bounded, held by a prior and reported.
#pragma once

#include <string>
#include <vector>

#include "identify/estimate/term.hpp"

namespace ukemi::tools {

struct DropTerm : identify::Term {
  /// The numbers of a scene that it moves, by the names of its DropSimulator: a constant is the value of each of
  /// them, a nuisance is added to it. None: it shifts the log.
  std::vector<std::string> moves = {};
  double spread = 2;  ///< of drawn starts about the scene's: a factor either way, or where it has a sign, an amount
  int run = -1;       ///< of the drops of this run alone; -1: of all

  bool shifts_log() const { return moves.empty(); }
  /// Whether both change a number of a scene.
  bool moves_what(const DropTerm& other) const;
  /// As a column that starts there.
  identify::Parameter column(double start, const identify::Choice& choice) const;
};

/// The table of the paper's robot: stiffness, damping_normal, damping_tangential, pitch; then the nuisance terms.
const std::vector<DropTerm>& drop_terms();
/// All four constants, nothing along.
identify::Terms<DropTerm> drop_choice();

/// The pitch at release and the nuisance terms, of any robot. They move "pitch", "height" and "forward_speed".
DropTerm pitch_term();
std::vector<DropTerm> drop_nuisances();
/// A constant of the floor, at least 0.
DropTerm floor_term(const std::string& name, const std::string& unit, const std::string& words, double smallest_part,
                    std::vector<std::string> moves);

inline constexpr double kLargestShift = 0.02;  ///< of a log [s]; where it is fitted, samples before it are left out

}  // namespace ukemi::tools
