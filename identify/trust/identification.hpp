// A complete identification as plain data: the fit, and how far it can be trusted. No text and no files: for programs,
// scripts and robots' control programs alike.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/trust/equivalents.hpp"
#include "identify/trust/ladder.hpp"
#include "identify/trust/profile.hpp"

namespace ukemi::identify {

struct TrustOptions {
  enum class Depth {
    kResiduals,  ///< whiteness, normality, score tests: a fraction of the fit's own time
    kRefit,      ///< also the model ladder and leave-one-out: several fits each
  } depth = Depth::kResiduals;
  /// The force between its samples (Trial::force_smooth): linear or smooth as the residuals suggest, or as it is set.
  enum class Force { kByResiduals, kAsSet } force = Force::kByResiduals;
  std::vector<std::string> profiles = {};  ///< constants of which to compute the profile likelihood
  int threads = 0;                         ///< 0: all cores; without influence on the results
};

/// The tests of a fit against its logs.
struct Trust {
  ResidualTests tests;
  std::optional<Ladder> ladder;           ///< with Depth::kRefit
  std::vector<LeftOut> left_out;          ///< with Depth::kRefit, of a fit that converged
  std::vector<Rival> rivals;              ///< of the missing term and of each fitted one
  std::vector<Profile> profiles;          ///< as requested
  std::vector<std::string> not_profiled;  ///< requested, but without a standard error
};

/// An optional term that was to be fitted and is held absent, because others have the same effect in these trials.
struct HeldTerm {
  std::string term;
  std::vector<std::string> others;  ///< the indistinguishable ones
};

/// The side that the drive feeds back according to the logs, where the rig does not state it.
struct FeedbackFound {
  Feedback side;
  double bic;  ///< by which the other side's fit is worse; infinite where that failed
  bool clear() const { return bic >= kToldApart; }
};

struct Identification {
  Fit fit;                                ///< errors and verdicts after the examination
  std::vector<HeldTerm> held;             ///< also in Fit::warnings
  std::vector<std::string> stated;        ///< terms fitted along, within the errors that the rig states
  std::optional<FeedbackFound> feedback;  ///< where both sides were fitted
  double force_smooth = 0;                ///< of the trials as they were fitted
  std::optional<Trust> trust;             ///< none where no start could be followed: Fit::fitted is empty
};

/// `fit`, then the tests to the requested depth; where these reject its model they widen its errors, see widen_errors.
/// Of a fit that did not converge only the residuals and the ladder are tested, of an interrupted one only the
/// residuals. Throws InputError where a profile names no constant. Optional terms of the actuator that the trials
/// cannot distinguish from others are held at 0, one after the other, and the fit is repeated without them. Where the
/// residuals of a fit with a linear force suggest more than half of the smooth curve, and a fit with it is likelier,
/// that is the result (TrustOptions::force). Where they ask for terms within the errors that the rig states, those are
/// fitted along, if that explains the logs. Fit::minima are those of the first fit.
[[nodiscard]] Identification identify(const Experiment& experiment, const std::optional<SeaParameters<double>>& start,
                                      const SeaParameters<double>& base, const TrustOptions& options = {});

}  // namespace ukemi::identify
