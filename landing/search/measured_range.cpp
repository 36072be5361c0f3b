#include "landing/search/measured_range.hpp"

#include <initializer_list>
#include <limits>

namespace ukemi::landing {

namespace {

struct Number {
  double value, lower, upper;
  const char* rule;
};
const char* first_fault(std::initializer_list<Number> numbers) {
  for (const Number& n : numbers)
    if (!(n.value >= n.lower && n.value <= n.upper)) return n.rule;
  return nullptr;
}
constexpr double kHigh = 1e4, kFast = 1e3, kTurn = 6.283185307179586, kLong = 1e3;  // [m], [m/s, rad/s], [rad], [s]

}  // namespace

const char* fault_of(const Drop& d) {
  return first_fault({{d.height, 0, kHigh, "height: 0 to 1e4 m is needed"},
                      {d.forward_speed, -kFast, kFast, "forward_speed: at most 1e3 m/s either way is needed"},
                      {d.pitch, -kTurn, kTurn, "pitch: radians, at most 2 pi either way, are needed"},
                      {d.pitch_rate, -kFast, kFast, "pitch_rate: at most 1e3 rad/s either way is needed"},
                      {d.vertical_speed, -kFast, kFast, "vertical_speed: at most 1e3 m/s either way is needed"}});
}
const char* fault_of_deadline(double deadline) {
  return first_fault({{deadline, std::numeric_limits<double>::min(), kLong, "deadline: above 0 to 1e3 s is needed"}});
}
const char* fault_of_joint(double phi, double rate) {
  return first_fault({{phi, -kTurn, kTurn, "phi: radians, at most 2 pi either way, are needed"},
                      {rate, -kFast, kFast, "rate: at most 1e3 rad/s either way is needed"}});
}
const char* fault_of_elapsed(double elapsed) {
  return first_fault({{elapsed, 0, kLong, "elapsed: 0 to 1e3 s is needed"}});
}

}  // namespace ukemi::landing
