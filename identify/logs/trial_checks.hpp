// Properties of logs: whether anything moves the rig, noise.
#pragma once

#include <vector>

#include "common/noise.hpp"
#include "identify/logs/trial.hpp"

namespace ukemi::identify {

/// Weight of a logged torque's residuals relative to angles': noise of the angles over noise of the torque [rad/Nm];
/// 0 where no torque is logged.
double angle_per_torque(const Trial& trial);
/// Number of measured samples of all trials.
long measurements(const std::vector<Trial>& trials);

/// Throws InputError, naming the file and the rule, where nothing moves the rig: no force or all of it zero, and a
/// reference that stays where it is. Such a trial holds no information about the actuator.
void require_excitation(const Trial& trial);

/// Whether two trials hold the same numbers, whatever their files are called.
bool same_content(const Trial& a, const Trial& b);

/// The force at the times of `t`, linear between its own samples and 0 outside of them [N]; empty without force.
std::vector<double> force_at_samples(const Trial& trial);

using ukemi::noise_level;
/// The noise of every measured angle of several trials, root mean square [rad]; 0 where nothing is measured.
double noise_level(const std::vector<const Trial*>& trials);
double noise_level(const std::vector<Trial>& trials);

}  // namespace ukemi::identify
