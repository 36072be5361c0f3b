// The whole of an identification as plain data: the fit, and how far it can be trusted. No text, no files: a program, a
// script or a robot's control program reads the same.
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
    kRefit,      ///< and the model ladder and each trial left out: several fits each
  } depth = Depth::kResiduals;
  /// The force between its samples (Trial::force_smooth): linear or smooth by what the residuals say, or as it is set.
  enum class Force { kByResiduals, kAsSet } force = Force::kByResiduals;
  std::vector<std::string> profiles = {};  ///< constants whose profile likelihood is wanted
  int threads = 0;                         ///< 0: all cores; without influence on the results
};

/// What the logs say against a fit.
struct Trust {
  ResidualTests tests;
  std::optional<Ladder> ladder;           ///< with Depth::kRefit
  std::vector<LeftOut> left_out;          ///< with Depth::kRefit, of a fit that converged
  std::vector<Rival> rivals;              ///< of the missing term, and of each that was fitted
  std::vector<Profile> profiles;          ///< as asked for
  std::vector<std::string> not_profiled;  ///< asked for, but without a standard error
};

/// Examines a fit as deep as asked for and widens its errors where the tests reject its model: see widen_errors. Of a
/// fit that did not converge only the residuals and the ladder, of an interrupted one only the residuals. Throws
/// InputError where a profile names no constant.
[[nodiscard]] Trust examine(const Experiment& experiment, Fit& fit, const TrustOptions& options = {});

/// An optional term that was to be fitted and is held at its absence, for in these trials others do all that it does.
struct HeldTerm {
  std::string term;
  std::vector<std::string> others;  ///< that cannot be told from it
};

/// Which side the drive feeds back by what the logs say, where the rig does not.
struct FeedbackFound {
  Feedback side;
  double bic;  ///< by which the other side's fit is worse; infinite where that found nothing
  bool clear() const { return bic >= kToldApart; }
};

struct Identification {
  Fit fit;                                ///< errors and verdicts after the examination
  std::vector<HeldTerm> held;             ///< told in Fit::warnings
  std::optional<FeedbackFound> feedback;  ///< where both sides were fitted
  double force_smooth = 0;                ///< of the trials as they were fitted
  std::optional<Trust> trust;             ///< none where no start could be followed: Fit::fitted is empty
};

/// `fit`, then `examine`. An optional term of the actuator that the trials cannot tell from others at all is held at 0,
/// one after the other, and the fit goes on without it. Where the residuals of a fit with a linear force ask for more
/// than half of the smooth curve, and a fit with it leaves less, that is the result (TrustOptions::force); Fit::minima
/// are those of the first fit.
[[nodiscard]] Identification identify(const Experiment& experiment, const std::optional<SeaParameters<double>>& start,
                                      const SeaParameters<double>& base, const TrustOptions& options = {});

}  // namespace ukemi::identify
