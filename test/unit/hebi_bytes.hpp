// Writes the bytes of a .hebilog, for tests: simulated modules, no measurement.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace hebi_bytes {

inline constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

inline std::string big(std::uint64_t value, int bytes) {
  std::string out;
  for (int i = bytes - 1; i >= 0; --i) out += char(value >> (8 * i) & 0xFF);
  return out;
}
inline std::string little(std::uint64_t value, int bytes) {
  std::string out;
  for (int i = 0; i < bytes; ++i) out += char(value >> (8 * i) & 0xFF);
  return out;
}
inline std::string varint(std::uint64_t value) {
  std::string out;
  for (; value >= 128; value >>= 7) out += char((value & 127) | 128);
  return out += char(value);
}
inline std::string number(int field, std::uint64_t value) { return varint(std::uint64_t(field) << 3) + varint(value); }
inline std::string real(int field, float value) {
  return varint(std::uint64_t(field) << 3 | 5) + little(std::bit_cast<std::uint32_t>(value), 4);
}
inline std::string message(int field, const std::string& content) {
  return varint(std::uint64_t(field) << 3 | 2) + varint(content.size()) + content;
}

/// {1: whole turns as zigzag, 2: the rest [rad]}.
inline std::string turns(int field, double angle) {
  const double turn = 6.283185307179586, whole = std::floor(angle / turn);
  const auto n = std::int64_t(whole);
  return message(field, number(1, std::uint64_t(n << 1 ^ n >> 63)) + real(2, float(angle - whole * turn)));
}

struct Sample {
  std::int64_t stamp_us;
  float position;
  float command = kNaN;
  double motor_position = 0;  ///< before the gear [rad]
  int module = 0;             ///< port 100 + module
};

inline constexpr std::int64_t kStart = 1530821160000000;

inline std::string header(int modules) {
  std::string out = big(0x73B1, 2) + big(2, 2) + big(std::uint64_t(modules), 4);
  for (int m = 0; m < modules; ++m) out += big(std::uint64_t(100 + m), 4) + big(0x0A000001, 4);
  return out;
}
/// The record of type 4, whose meaning is not known.
inline std::string unknown() { return big(0x73B1, 2) + big(4, 2) + big(81, 8); }

inline std::string record(const Sample& s, const std::string& payload, int type) {
  return big(0x73B1, 2) + big(std::uint64_t(type), 2) + big(std::uint64_t(100 + s.module), 4) + big(0x0A000001, 4) +
         big(payload.size() + 2, 4) + big(std::uint64_t(kStart + s.stamp_us), 8) + big(payload.size(), 2) + payload;
}
inline std::string payload(const Sample& s) {
  const std::string commands = real(1, s.command) + real(2, kNaN) + real(3, kNaN);
  const std::string feedback = real(1, s.position) + real(2, 0.5f) + real(3, -0.4f) + real(4, 0.01f) + real(5, 30) +
                               turns(12, s.position) + turns(13, s.motor_position);
  return number(1, 238045239259163) + message(8, number(2, 7)) + message(10, message(1, "") + message(9, commands)) +
         message(11, message(9, feedback));
}
inline std::string feedback(const Sample& s) { return record(s, payload(s), 1); }
inline std::string info(const Sample& s, const std::string& name, const std::string& family) {
  const auto gains = [](float k_p) { return real(1, k_p) + real(2, 0) + real(3, 0.001f); };
  return record(
      s,
      payload(s) + message(20, message(1, message(1, name) + message(2, family)) +
                                   message(3, number(1, 3) + message(3, gains(0.5f)) + message(4, gains(0.05f)) +
                                                  message(5, gains(0.25f)) + real(6, 40))),
      5);
}

}  // namespace hebi_bytes
