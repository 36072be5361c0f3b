// HEBI Robotics' logs: the binary `.hebilog` and the vendor's CSV export of it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ukemi::identify {

/// A controller's gains as the module states them, in the vendor's own units: k_p here is NOT K_p in Nm/rad.
struct HebiGains {
  std::optional<double> k_p, k_i, k_d;
};

/// One module of a log. Every column has as many samples as `t`; NaN where a record lacks the value, or the module
/// stated none (commands before the first command).
struct HebiModule {
  std::string name, family;  ///< empty without info records
  std::uint32_t port = 0;
  std::string address;                    ///< IPv4, "10.10.10.195"; empty in a CSV export
  std::optional<double> spring_constant;  ///< [Nm/rad], from the info records
  std::optional<HebiGains> position_gains, velocity_gains, effort_gains;

  std::vector<double> t;               ///< from the log's first stamp [s], as received: may repeat or go back
  std::vector<double> position;        ///< output, after the spring [rad]
  std::vector<double> velocity;        ///< output [rad/s]
  std::vector<double> effort;          ///< computed by the module from its deflection [Nm]
  std::vector<double> deflection;      ///< across the spring [rad]; effort = -spring constant * deflection
  std::vector<double> motor_velocity;  ///< before the gear [rad/s]
  std::vector<double> motor_position;  ///< before the gear, counted from power-up [rad]
  std::vector<double> position_command, velocity_command, effort_command;  ///< [rad], [rad/s], [Nm]
};

struct HebiLog {
  std::string file;
  std::vector<HebiModule> modules;
  std::vector<std::string> notes;  ///< what was left out while reading
};

/// Whether a file is a binary log: by its first two bytes, or by its name where it is shorter.
bool is_hebilog(const std::string& path);

/// Reads a binary log: header, records of feedback and of feedback with info. A file that ends inside its last record
/// keeps the whole ones before it (a note says so). Throws InputError "FILE: byte N: what, rule" on an empty file, a
/// wrong magic number, an unknown record type, lengths that contradict each other, a module that the header does not
/// list, a broken protobuf payload, and where no sample is left.
HebiLog read_hebilog(const std::string& path);

/// Whether a CSV file is the vendor's export: its header has `time` and a `position`, with or without a module's index,
/// and no `t`. Throws InputError like csv_header.
bool is_hebi_csv(const std::string& path);

/// Reads the vendor's CSV export. Columns by the names of the fields (time, position, velocity, effort, deflection,
/// motorVelocity, motorPosition, positionCmd, velocityCmd, effortCmd), whatever their case, with an index after them
/// where the log has several modules: position1, position_1, position(1). t is the file's `time`, unchanged. Throws
/// InputError like read_csv ("nan" is a missing value, no error), and on a column that is given twice.
HebiLog read_hebi_csv(const std::string& path);

}  // namespace ukemi::identify
