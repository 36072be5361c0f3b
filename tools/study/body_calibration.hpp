// Calibration of a robot of links: the constants of its contacts' laws and the pitch from logs of drops
// (floor_fit.hpp), derivatives by differences of the simulation (landing/drops/body_rollout.hpp); and which law the
// drops ask for.
//
// Laws are tried by turns: the scene's, then each with one part changed, linear or Hunt and Crossley, viscous or
// Coulomb, with or without pads, started from what was fitted; where one is better, its neighbours too. A law is
// better where its BIC,
//
//     sum_o N_o log(rms_o^2) + k log N,    N_o samples of output o, k fitted numbers,
//
// is lower by kDecisive and, with two drops at least, a drop (in the median) is no worse predicted by the others.
//
// No printing, no files: tools/verbs/calibrate_body.cpp is the verb. Tests: test/legs/calibrate.cpp.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "landing/body/body_scene.hpp"
#include "tools/study/floor_fit.hpp"

namespace ukemi::tools {

/// One drop of a robot of links: its log and how it was played and thrown.
struct BodyLoggedDrop {
  landing::DropLog log;  ///< of landing::body_channels
  landing::BodyMotion motion;
  landing::Drop thrown;  ///< its pitch is the scene's, whatever is given here
};

/// The laws of a robot's contacts.
struct FloorLaw {
  bool hunt_crossley = false;  ///< else linear
  bool coulomb = false;        ///< else viscous
  bool pads = false;
  bool operator==(const FloorLaw&) const = default;
};
FloorLaw law_of(const landing::Robot& robot);
/// "linear, with Coulomb's friction, without pads".
std::string words(const FloorLaw& law);
/// The scene under another law, its constants such that the floor takes up a drop about as before.
landing::BodyScene with_law(landing::BodyScene scene, const FloorLaw& law);

/// What can be fitted of a scene: constants of the contacts by their keys, of all contacts that have them from
/// [floor], CONTACT.KEY of one; pad_stiffness, pad_damping, pad_thickness; the pitch; then the nuisance terms. Chosen:
/// every constant of the scene's law, those that all contacts share as one.
identify::Terms<DropTerm> drop_choice(const landing::BodyScene& scene);

struct BodyCalibrationOptions : CalibrationOptions {
  BodyCalibrationOptions() { restarts = 4, believed = 1.15; }
  enum class Rivals {
    kTried,
    kNone,
  } rivals = Rivals::kTried;  ///< other laws
  int threads = 0;            ///< of the differences; 0: all cores; without influence on the results
};

/// A difference of BIC by which a law is better beyond doubt (Kass, Raftery 1995: "very strong").
inline constexpr double kDecisive = 10;

/// A law and how it met the drops.
struct TriedLaw {
  FloorLaw law;
  bool converged = false;
  double rms = 0;                                        ///< of the residuals, each in units of its output's noise
  int fitted = 0;                                        ///< numbers
  double bic = std::numeric_limits<double>::infinity();  ///< less that of the scene's law
  double held_out = std::numeric_limits<double>::quiet_NaN();  ///< rms of a drop left out, see held_out; NaN: one drop
  bool rejected = false;                                       ///< by the tests of its own residuals
  landing::BodyScene scene;                                    ///< with its constants
};

struct BodyCalibration : FloorFit {
  landing::BodyScene scene;    ///< the given one with the fitted constants, their covariance and verdicts
  std::vector<TriedLaw> laws;  ///< the scene's first; empty where nothing could be followed
  std::size_t asked = 0;       ///< of `laws`: the law that the drops support best
  std::size_t own = 0;         ///< of `laws`: the one of `scene`

  /// Whether the drops speak against that law: its residuals do, or another law is better beyond doubt.
  bool law_rejected() const { return asked != own || tests.model_rejected(); }
};

/// Drops and what became of them.
struct BodyCalibratedDrops {
  std::vector<BodyLoggedDrop> drops;
  BodyCalibration result;
};

/// Throws InputError "NAME: ..." where a height or a forward speed, null where there is none, is given that the base
/// does not have.
void check_thrown(const landing::Robot& robot, const char* height, const char* forward_speed);

/// Throws InputError where the scene lacks a floor or contacts, and as check_logs.
void check_drops(const landing::BodyScene& scene, const std::vector<BodyLoggedDrop>& drops);

/// Fits the constants of `scene` to the drops, see fit_floor, and tries other laws. Where the drops speak against the
/// scene's law nothing is trusted. Throws InputError as check_drops.
[[nodiscard]] BodyCalibration calibrate(const landing::BodyScene& scene, const std::vector<BodyLoggedDrop>& drops,
                                        const BodyCalibrationOptions& options);

/// Makes the law that the drops ask for the scene's, fitted with its errors and verdicts; of the options as
/// `calibrate`.
void take_asked_law(BodyCalibration& calibration, const std::vector<BodyLoggedDrop>& drops,
                    const BodyCalibrationOptions& options);

/// The drops for given constants, see validate_floor.
[[nodiscard]] BodyCalibration validate(const landing::BodyScene& scene, const std::vector<BodyLoggedDrop>& drops,
                                       const BodyCalibrationOptions& options);

}  // namespace ukemi::tools
