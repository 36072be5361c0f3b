#include "identify/logs/drive_command.hpp"

#include <algorithm>
#include <string>

#include "common/error.hpp"

namespace ukemi::identify {

namespace {

void require(const Trial& trial, const std::vector<double>& column, const std::string& name, const std::string& why) {
  if (column.empty()) throw InputError({trial.file}, "no column '" + name + "': " + why + " needs it");
}

}  // namespace

std::vector<double> drive_command(const Trial& trial, const Drive& drive) {
  std::vector<double> out = trial.command;
  if (!drive.known_command()) return out;
  if (drive.kind == Drive::Kind::kCommand) {
    require(trial, out, "command", "--drive command, or a [drive] without command_gain,");
  } else {
    const bool motor = drive.feedback.value_or(Feedback::kOutput) == Feedback::kMotor;
    const std::vector<double>& angle = motor ? trial.phi_motor : trial.phi;
    require(trial, angle, motor ? "phi_motor" : "phi", "[drive] angle = \"logged\"");
    out.resize(trial.samples());
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = drive.gain * ((trial.phi_ref.empty() ? 0 : trial.phi_ref[i]) - angle[i]);
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = std::clamp(out[i], -drive.limit, drive.limit);
    if (i == 0) continue;
    const double max_change = drive.rate * (trial.t[i] - trial.t[i - 1]);
    out[i] = std::clamp(out[i], out[i - 1] - max_change, out[i - 1] + max_change);
  }
  return out;
}

}  // namespace ukemi::identify
