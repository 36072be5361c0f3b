#include "landing/body/sensors.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace ukemi::landing {

std::vector<MeasuredColumn> measured_columns(const Robot& robot) {
  std::vector<MeasuredColumn> out;
  for (const Joint& j : robot.joints)
    for (std::size_t q = 0; q < kJointSignals; ++q)
      out.push_back({std::string(kJointSignalNames[q]) + "_" + j.name, kJointSignalUnits[q]});
  for (std::size_t q = 0; q < kBaseSignals && robot.base == Base::kFree; ++q)
    out.push_back({std::string(kBaseSignalNames[q]) + "_" + robot.links[0].name, kBaseSignalUnits[q]});
  for (const char* name : kAccelerationSignalNames) out.push_back({name, "m/s^2"});
  for (const ContactPoint& c : robot.contacts)
    for (const char* part : kForceNames) out.push_back({"f_" + c.name + part, "N"});
  return out;
}

std::vector<MeasuredColumn> push_columns(const Robot& robot) {
  std::vector<MeasuredColumn> out;
  for (const PushPoint& p : robot.pushes)
    for (const char* part : kForceNames) out.push_back({"push_" + p.name + part, "N"});
  return out;
}

namespace {

std::vector<MeasuredColumn> all_columns(const Robot& robot) {
  std::vector<MeasuredColumn> out = measured_columns(robot);
  for (MeasuredColumn& c : push_columns(robot)) out.push_back(std::move(c));
  return out;
}

}  // namespace

Sensor Sensors::of(const std::string& name) const {
  const auto found = column.find(name);
  return found == column.end() ? Sensor{} : found->second;
}

double* sensor_number(Sensors& sensors, const Robot& robot, const std::string& name) {
  if (name == "time_shift") return &sensors.time_shift;
  if (name == "push_smooth") return &sensors.push_smooth;
  const std::size_t dot = name.rfind('.');
  const std::string of = name.substr(0, dot), key = dot == std::string::npos ? "" : name.substr(dot + 1);
  if (key != "gain" && key != "bias") return nullptr;
  const std::vector<MeasuredColumn> columns = all_columns(robot);
  if (std::none_of(columns.begin(), columns.end(), [&](auto& c) { return c.name == of; })) return nullptr;
  return key == "gain" ? &sensors.column[of].gain : &sensors.column[of].bias;
}

Sensors read_sensors(TomlFile& file, const Robot& robot) {
  Sensors out;
  auto s = file.optional("sensor");
  if (!s) return out;
  const Range shift{-kMaxTimeShift, kMaxTimeShift, false, fmt::format("from -{0:g} to {0:g} s", kMaxTimeShift)};
  out.time_shift = s->optional_number("time_shift", shift).value_or(0);
  out.push_smooth = s->optional_number("push_smooth", {0, 1, false, "from 0 to 1"}).value_or(0);
  for (const MeasuredColumn& c : all_columns(robot))
    if (auto own = s->optional_section(c.name)) {
      Sensor& to = out.column[c.name];
      to.gain = own->optional_number("gain", Range::positive()).value_or(1);
      to.bias = own->optional_number("bias", Range::any()).value_or(0);
    }
  return out;
}

}  // namespace ukemi::landing
