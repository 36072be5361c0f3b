// Terms of a fit to drops: the floor's constants and the pitch, common to all drops, and nuisance terms of each drop.
// An entry of the table is all that a term needs to be fitted, bounded, given a prior and reported.
#pragma once

#include <string>
#include <vector>

#include "identify/estimate/term.hpp"

namespace ukemi::tools {

struct DropTerm : identify::Term {
  /// The numbers of a scene that it acts on, by the names of its DropSimulator: a constant is their value, a nuisance
  /// term is added to them. None: it shifts the log.
  std::vector<std::string> moves = {};
  double spread = 2;  ///< of drawn starts: up to this factor either way, or, of a term of either sign, this amount
  int run = -1;       ///< index of the run that it belongs to; -1: all

  bool shifts_log() const { return moves.empty(); }
  /// Whether both act on a common number of the scene.
  bool moves_same_number(const DropTerm& other) const;
  /// As a parameter of the least-squares problem with this start.
  identify::Parameter column(double start, const identify::Choice& choice) const;
};

/// The table of the paper's robot: stiffness, damping_normal, damping_tangential, pitch; then the nuisance terms.
const std::vector<DropTerm>& drop_terms();
/// All four constants, no nuisance term.
identify::Terms<DropTerm> drop_choice();

/// The pitch at release and the nuisance terms, of any robot. They act on "pitch", "height" and "forward_speed".
DropTerm pitch_term();
std::vector<DropTerm> drop_nuisances();
/// A constant of the floor, at least 0.
DropTerm floor_term(const std::string& name, const std::string& unit, const std::string& words, double smallest_part,
                    std::vector<std::string> moves);

inline constexpr double kLargestShift = 0.02;  ///< of a log [s]; where that is fitted, earlier samples are left out

}  // namespace ukemi::tools
