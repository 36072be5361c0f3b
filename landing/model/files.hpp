// Files of scenes and motions, and the rows of a motion over time.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "landing/model/motion_data.hpp"
#include "landing/model/scene.hpp"

namespace ukemi::landing {

/// Reads scene.toml: [robot] and [drop] are required, [floor], [search], [execution], [run], [motion],
/// [release], [joint], [detection], [uncertainty], [verdict], [scatter] optional; an omitted table or key switches its
/// effect off. Throws InputError with file:line:column.
Scene read_scene(const std::string& path);

/// The text of a scene.toml that `read_scene` reads back; `comments` goes in front, each line after "# ".
std::string to_toml(const Scene& scene, const std::string& comments);

/// Reads motion.toml: [motion] phi_i_deg, phi_f_deg (or phi_i, phi_f in rad), duration; optional bumps_deg, gain_p,
/// gain_d, and [reposition] phi_deg, rate_deg, from, to. A path that ends in .csv: see read_motion_csv.
Motion read_motion(const std::string& path);
/// The text of a motion.toml; `comments` goes in front, each line after "# ".
std::string to_toml(const Motion& motion, const std::string& comments);
/// The reference over time. t = 0 at the start of the landing motion, which is the detected first touchdown; rows with
/// t < 0 are the move in the air.
struct MotionRows {
  std::vector<double> t;     ///< [s], increases
  std::vector<double> phi;   ///< phi_ref [rad]
  std::vector<double> dphi;  ///< dphi_ref [rad/s]
  /// When the landing motion is expected to start, from release [s]; needed where rows have t < 0.
  double start = std::numeric_limits<double>::infinity();
  double gain_p = 1, gain_d = 1;  ///< factors of K_p and K_d from t = 0 on, >= 0
  double release_rate = 0;        ///< of the joint at release [rad/s]

  bool moves_in_air() const { return !t.empty() && t.front() < 0; }
};

/// The rows of a motion whose landing motion is expected at `start` from release [s]; infinite: after the move in the
/// air. `rate`: rows per second [Hz], > 0; the last row is the motion's end.
MotionRows rows_of(const Motion& motion, double start, double rate);
/// The text of a motion.csv; `comments` goes in front, each line after "# ".
std::string to_csv(const MotionRows& rows, const std::string& comments);

/// Reads a motion.csv as `ukemi optimize` writes it, and recovers the motion: the end angles and the duration are the
/// rows' own, the shape terms their least-squares fit (linear in b_k), phi_I and the end of the move in the air the
/// least-squares fit of its quintic. Throws InputError, with file:line:column, on rows that are not of such a motion.
/// `joint`: name of one joint in a file of several, with columns phi_ref_JOINT and so on.
/// Tests: test/unit/motion_csv.cpp.
Motion read_motion_csv(const std::string& path, const std::string& joint = "");

}  // namespace ukemi::landing
