// Calibration of a robot of links: the constants of its contacts' laws and the pitch from logs of drops
// (floor_fit.hpp), derivatives by finite differences of the simulation (landing/drops/drop_rollout.hpp); and selection
// of the contact law that the drops support best.
//
// The search for a law is greedy: from the scene's, it fits each law that differs in one part (linear or Hunt and
// Crossley, viscous or Coulomb, with or without pads), started at the fitted constants; it goes on from the best while
// that improves. A law is better where its BIC,
//
//     sum_o N_o log(rms_o^2) + k log N,    N_o samples of output o, k fitted numbers,
//
// is lower by kDecisive and, with at least two drops, its leave-one-out error (median over drops) is no larger.
//
// No printing, no files: tools/verbs/calibrate_body.cpp is the verb. Tests: test/legs/calibrate.cpp.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "landing/body/body_scene.hpp"
#include "tools/study/floor_fit.hpp"

namespace ukemi::tools {

/// A drop of a robot of links; its log is of landing::body_channels.
using BodyLoggedDrop = LoggedDropOf<landing::BodyMotion>;

/// Which contact law a robot has.
struct FloorLaw {
  bool hunt_crossley = false;  ///< else linear
  bool coulomb = false;        ///< else viscous
  bool pads = false;
  bool operator==(const FloorLaw&) const = default;
};
FloorLaw law_of(const landing::Robot& robot);
/// "linear, with Coulomb's friction, without pads".
std::string words(const FloorLaw& law);
/// The scene under another law, with constants that give a similar force and damping over a drop.
landing::BodyScene with_law(landing::BodyScene scene, const FloorLaw& law);

/// The terms of a scene: constants of the contacts by their keys, KEY for all contacts that take it from [floor],
/// CONTACT.KEY for one; pad_stiffness, pad_damping, pad_thickness; the pitch; then the nuisance terms. Free by default:
/// every constant of the scene's law, those that contacts share as one term.
identify::Terms<DropTerm> drop_choice(const landing::BodyScene& scene);

struct BodyCalibrationOptions : CalibrationOptions {
  BodyCalibrationOptions() { restarts = 4, believed = 1.15; }
  enum class Rivals {
    kTried,
    kNone,
  } rivals = Rivals::kTried;  ///< whether other laws are tried
  int threads = 0;            ///< of the differences; 0: all cores; results do not depend on it
};

/// Difference of BIC from which a law counts as better (Kass, Raftery 1995: "very strong").
inline constexpr double kDecisive = 10;

/// A law that was fitted, and its quality of fit.
struct TriedLaw {
  FloorLaw law;
  bool converged = false;
  double rms = 0;                                        ///< of the residuals, each in units of its output's noise
  int fitted = 0;                                        ///< number of fitted values
  double bic = std::numeric_limits<double>::infinity();  ///< minus that of the scene's law
  double held_out = std::numeric_limits<double>::quiet_NaN();  ///< leave-one-out rms, see held_out; NaN: one drop
  bool rejected = false;                                       ///< by the tests of its residuals
  landing::BodyScene scene;                                    ///< with the fitted constants
};

struct BodyCalibration : FloorFit {
  landing::BodyScene scene;    ///< the given one with the fitted constants, their covariance and verdicts
  std::vector<TriedLaw> laws;  ///< the scene's first; empty where no drop could be simulated
  std::size_t best_law = 0;    ///< index into `laws`: the law that the drops support best
  std::size_t scene_law = 0;   ///< index into `laws`: the law of `scene`

  /// Whether the drops reject the law of `scene`: by its residuals, or because another law is better by kDecisive.
  bool law_rejected() const { return best_law != scene_law || tests.model_rejected(); }
};

/// Drops and their calibration.
struct BodyCalibratedDrops {
  std::vector<BodyLoggedDrop> drops;
  BodyCalibration result;
};

/// Throws InputError "NAME: ..." where a height or a forward speed is given that the base does not have; the arguments
/// are the names of those that are given, else null.
void check_drop_arguments(const landing::Robot& robot, const char* height, const char* forward_speed);

/// Throws InputError where the scene has no floor or no contacts, and as check_logs does.
void check_drops(const landing::BodyScene& scene, const std::vector<BodyLoggedDrop>& drops);

/// Fits the constants of `scene` to the drops, see fit_floor, and tries other laws. Where the drops reject the scene's
/// law no constant is trusted. Throws InputError as check_drops does.
[[nodiscard]] BodyCalibration calibrate(const landing::BodyScene& scene, const std::vector<BodyLoggedDrop>& drops,
                                        const BodyCalibrationOptions& options);

/// Replaces the scene's law by the best one, refitted with errors and verdicts; with the options of `calibrate`.
void adopt_best_law(BodyCalibration& calibration, const std::vector<BodyLoggedDrop>& drops,
                    const BodyCalibrationOptions& options);

/// Simulates the drops with the scene's constants, see validate_floor.
[[nodiscard]] BodyCalibration validate(const landing::BodyScene& scene, const std::vector<BodyLoggedDrop>& drops,
                                       const BodyCalibrationOptions& options);

}  // namespace ukemi::tools
