// Loads on the parts of a robot of links: [[load]] of its scene. Private to landing and tools.
#pragma once

#include <string>
#include <vector>

#include "common/toml.hpp"
#include "landing/body/body_run.hpp"

namespace ukemi::landing {

const char* name(Load::Kind kind);   ///< "acceleration", as in files
const char* unit(Load::Kind kind);   ///< "m/s^2"
std::string words(Load::Kind kind);  ///< "motor speed"
/// Where a load acts: "knee", "slider [0, 0]".
std::string place_of(const Load& load, const Robot& robot);

/// Reads [[load]] of a scene file; the `stops` of joints are appended. Throws InputError with file:line:column.
std::vector<Load> read_loads(TomlFile& file, const Robot& robot, const std::vector<Load>& stops);
/// A limit named by its place and kind, "knee.motor_speed"; `phi`: range of an angle.
Load limit(const Robot& robot, Load::Kind kind, std::size_t index, double rating,
           const std::array<double, 2>& phi = {});
/// Adds a limit, or replaces the one of the same name.
void set_limit(BodyScene& scene, const Load& limit);
/// Throws InputError for a number or an index outside its range.
void check(const Load& load, const Robot& robot);

/// Whether a load is the acceleration of the peak point.
inline bool is_peak_acceleration(const Load& l, const Robot& robot) {
  return l.kind == Load::Kind::kAcceleration && l.index == robot.peak_link && l.at.along == robot.peak.along &&
         l.at.across == robot.peak.across;
}
/// Whether a run must track more than its peak.
bool observed(const BodyScene& scene);
/// Rating of the peak [m/s^2]: 1 without loads to minimise; infinite if the peak is not one of them.
double peak_rating(const BodyScene& scene);
/// The objective of a plan: the largest value / rating of loads without `limit`; if there are none the peak [m/s^2].
double worth(const BodyScene& scene, const BodyLanding& landing);
/// The same from a run's peak and the values of all its loads.
double worth(const BodyScene& scene, double peak, const std::vector<LoadPeak>& loads);
/// Whether the objective is value / rating, not an acceleration.
bool rated(const BodyScene& scene);
/// Index of the load that gives the worth; -1 without loads to minimise.
int binding(const BodyScene& scene, const BodyLanding& landing);
/// The largest value that keeps a rating, beyond rounding.
constexpr double rating_limit(double rating) { return rating * (1 + 1e-12); }
/// The same of a motor's torque; infinite where it is geared and its tau_max is within its rating: steps, which place
/// that limit's event to their accuracy, may read a little more.
double torque_limit(const Joint& joint, double rating);
/// The same of a load.
double rating_limit(const Load& load, const Robot& robot);
/// The values of all loads, even if the run did not observe them.
std::vector<LoadPeak> loads_of(const BodyScene& scene, const BodyLanding& landing);

}  // namespace ukemi::landing
