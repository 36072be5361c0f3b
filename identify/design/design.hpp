// Experiment design: the half-sine hits to try next, chosen by their Fisher information of the constants
// (identify/design/information.hpp), one rollout a hit. The model is odd in the force: a hit and its mirror image have
// the same information. Tests: test/unit/design.cpp, test/regression/design.cpp.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "identify/design/information.hpp"

namespace ukemi::identify {

/// F_e(t) = peak sin(pi (t - start) / width) for `width` from `start` on, else 0.
struct Hit {
  double peak = 0;   ///< [N]; below 0: the other direction
  double width = 0;  ///< [s], > 0
};

/// What the experiment allows.
struct HitBudget {
  double peak = 300;                            ///< largest |peak| [N], > 0
  double min_width = 0.010, max_width = 0.020;  ///< [s], 0 < min <= max
  double angle = 0.6;                           ///< largest |phi_1| [rad], in (0, pi)
  enum class Directions { kAlternate, kPositive } directions = Directions::kAlternate;  ///< of a set's hits, in turn
};

/// How the next trials will be logged.
struct HitLog {
  double rate = 1000;   ///< samples a second [Hz], > 0
  double duration = 1;  ///< [s]
  double start = 0.05;  ///< of the hit [s]
  double noise = 0;     ///< standard deviation of an angle [rad], > 0
  enum class Outputs { kLink, kLinkAndMotor } outputs = Outputs::kLink;
  void validate() const;  ///< throws InputError: at most a million samples, which begin before the hit
  static constexpr int kMinPulseSamples = 8;  ///< samples in a pulse: fewer bias the fit
};

/// The log that a hit will leave (InputError where width, rate or duration are not above 0), force as sampled; angles,
/// not measured yet, are 0.
Trial blank_log(const Hit& hit, const HitLog& log);

/// How close a hit comes to the budget's largest angle: at the estimate, and over the 95 % ellipsoid about it (its
/// axes' ends, the point where the angle grows fastest, drawn points of its surface).
struct HitSafety {
  enum class Outcome { kSafe, kTooFar, kEscapes } outcome = Outcome::kSafe;  ///< kEscapes: somewhere, or diverges
  double angle = 0;                                                          ///< largest |phi_1| at the estimate [rad]
  double worst_angle = 0;  ///< over the ellipsoid [rad]; over the points so far where not safe
  double torque = 0;       ///< largest |tau'| at the estimate, before the limit [Nm]
  double limited = 0;      ///< duration of the torque limit there [s]
  bool safe() const { return outcome == Outcome::kSafe; }
};
const char* name(HitSafety::Outcome outcome);

struct DesignOptions {
  HitBudget budget;
  HitLog log;
  int hits = 2;  ///< at least 1
  Criterion criterion = Criterion::kWorst;
  int peaks = 30, widths = 11;  ///< of the grid that the search starts from
  int draws = 64;               ///< of the ellipsoid's surface, for safety
  std::uint64_t seed = 1;       ///< of those draws
  int threads = 1;              ///< 0: all cores; results do not depend on it
  void validate() const;        ///< throws InputError
};

/// Whether the hit stays within `budget.angle` wherever the constants may lie. `knowledge` must be determined.
HitSafety safety_of(const Rig& rig, const Knowledge& knowledge, const Hit& hit, const DesignOptions& options);

/// A hit that was assessed.
struct ProposedHit {
  Hit hit;
  HitSafety safety;
  Eigen::MatrixXd information;  ///< where it is safe
};

/// An alternative set and its criterion.
struct RunnerUp {
  std::vector<Hit> hits;
  double size = 0;
};

struct Design {
  enum class Status { kDone, kNotDetermined, kNoSafeHit } status = Status::kDone;
  std::string message;            ///< why it is not kDone
  std::vector<ProposedHit> hits;  ///< as many as requested, or none
  Eigen::MatrixXd information;    ///< of the knowledge and the hits
  Eigen::VectorXd before, after;  ///< relative 95 % half-widths, in the order of Knowledge::constants
  double size_before = 0, size_after = 0;
  std::vector<RunnerUp> runners_up;               ///< best first; one hit of the set replaced by another kind
  int candidates = 0, too_far = 0, escaping = 0;  ///< of the grid
};

/// The set of safe hits that makes `criterion` smallest: candidates on a grid, greedy with exchange, then each hit
/// moved off the grid by a pattern search. Deterministic.
[[nodiscard]] Design design(const Rig& rig, const Knowledge& knowledge, const DesignOptions& options);

/// The predicted errors against simulated experiments.
struct DesignCheck {
  struct Constant {
    double predicted = 0;   ///< relative standard error
    double scatter = 0;     ///< root mean square of the relative errors of the refits
    double half_width = 0;  ///< mean relative 95 % half-width that the refits report
    int covered = 0;        ///< refits whose 95 % interval holds the truth
  };
  std::vector<Constant> constants;  ///< in the order of Knowledge::constants
  int repeats = 0;                  ///< number that converged
  int failed = 0;
  bool agrees = false;  ///< no refit failed; scatter and coverage are what chance allows (at 0.1 %, each constant)
};

/// Simulates `trials` and the hits at the estimate with the log's noise and refits, `repeats` times. Without trials the
/// prior knowledge is drawn as an independent estimate and combined with the fit of the hits, weighted by information.
/// Repeat r draws from the random stream (seed, r).
DesignCheck check(const Rig& rig, const Knowledge& knowledge, const std::vector<Trial>& trials,
                  const std::vector<Hit>& hits, const DesignOptions& options, int repeats);

}  // namespace ukemi::identify
