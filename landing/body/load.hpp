// What the parts of a robot of links bear: [[load]] of its scene. Private to landing and tools.
#pragma once

#include <string>
#include <vector>

#include "common/toml.hpp"
#include "landing/body/body_run.hpp"

namespace ukemi::landing {

const char* name(Load::Kind kind);   ///< "acceleration", as files have it
const char* unit(Load::Kind kind);   ///< "m/s^2"
std::string words(Load::Kind kind);  ///< "motor speed"
/// "knee", "slider [0, 0]": where it acts.
std::string place_of(const Load& load, const Robot& robot);

/// [[load]] of a scene's file, and behind them its joints' `stops`. Throws InputError with file:line:column.
std::vector<Load> read_loads(TomlFile& file, const Robot& robot, const std::vector<Load>& stops);
/// A limit that no file names: its place and kind do, "knee.motor_speed"; `phi`: of an angle.
Load limit(const Robot& robot, Load::Kind kind, std::size_t index, double rating,
           const std::array<double, 2>& phi = {});
/// Adds a limit, or puts it where one of its name is.
void set_limit(BodyScene& scene, const Load& limit);
/// Throws InputError for a number outside its range, and for an index of nothing.
void check(const Load& load, const Robot& robot);

/// Whether it is the acceleration that counts without loads.
inline bool own(const Load& l, const Robot& robot) {
  return l.kind == Load::Kind::kAcceleration && l.index == robot.peak_link && l.at.along == robot.peak.along &&
         l.at.across == robot.peak.across;
}
/// Whether a run must look at more than its peak.
bool observed(const BodyScene& scene);
/// What the peak counts by: without loads to make small 1; infinite where it is none of them [m/s^2].
double own_rating(const BodyScene& scene);
/// What a plan makes small: the largest value / rating over the loads without `limit`; without any the peak [m/s^2].
double worth(const BodyScene& scene, const BodyLanding& landing);
/// The same of a run's peak and of all its loads.
double worth(const BodyScene& scene, double peak, const std::vector<LoadPeak>& loads);
/// Whether that is a part of the ratings, and no acceleration.
bool rated(const BodyScene& scene);
/// The load that gives the worth; -1: without any.
int binding(const BodyScene& scene, const BodyLanding& landing);
/// The values of all loads, of a run that was not observed too.
std::vector<LoadPeak> loads_of(const BodyScene& scene, const BodyLanding& landing);

}  // namespace ukemi::landing
