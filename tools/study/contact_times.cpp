#include "tools/study/contact_times.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace ukemi::tools {

using namespace landing;

namespace {

constexpr double kPart = 0.05, kOfWeight = 0.2, kNoises = 6, kLeaves = 0.5;  // of the largest force; of the level

/// The force across the floor of a contact: its channel.
struct ForceChannel {
  int contact;
  std::size_t at;
  std::string name;
};
std::vector<ForceChannel> force_channels(const Robot& robot, const std::vector<RobotTrial>& trials) {
  std::vector<ForceChannel> out;
  const std::vector<MeasuredColumn> columns = measured_columns(robot);
  for (std::size_t c = 0; c < robot.contacts.size(); ++c)
    for (std::size_t o = 0; o < columns.size(); ++o)
      if (columns[o].name == "f_" + robot.contacts[c].name + kForceNames[1] &&
          std::any_of(trials.begin(), trials.end(), [o](auto& t) { return !t.log.output[o].empty(); }))
        out.push_back({int(c), o, columns[o].name});
  return out;
}

std::vector<double> actual(std::vector<double> logged, const Sensor& sensor) {
  for (double& x : logged) x = sensor.actual(x);
  return logged;
}

/// How long two stances are one within a trial of that length.
double shared(const Stance& a, const Stance& b, double end) {
  const auto from = [](const Stance& s) { return std::isnan(s.touchdown) ? 0 : s.touchdown; };
  const auto to = [end](const Stance& s) { return std::isnan(s.liftoff) ? end : s.liftoff; };
  return std::min(to(a), to(b)) - std::max(from(a), from(b));
}

/// Of each of `a`, which of `b` it shares most time with; each is taken once. -1: none.
std::vector<int> partners(const std::vector<Stance>& a, const std::vector<Stance>& b, double end) {
  std::vector<int> out(a.size(), -1);
  std::vector<bool> taken(b.size(), false);
  for (;;) {
    double most = 0;
    std::size_t of = 0, with = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      for (std::size_t j = 0; j < b.size(); ++j)
        if (const double time = shared(a[i], b[j], end); out[i] < 0 && !taken[j] && time > most)
          most = time, of = i, with = j;
    if (most == 0) return out;
    out[of] = int(with), taken[with] = true;
  }
}

/// The change of the rollout that a stance of it is read from: the nearest of its kind.
std::optional<std::size_t> change_at(const DropResult& d, int contact, bool touches, double t) {
  std::optional<std::size_t> out;
  for (std::size_t i = 0; i < d.changes.size(); ++i)
    if (const ContactChange& c = d.changes[i]; c.contact == contact && c.touches == touches)
      if (!out || std::abs(c.t - t) < std::abs(d.changes[*out].t - t)) out = i;
  return std::isfinite(t) ? out : std::nullopt;
}
void set_bands(const DropResult& d, const Promise& promise, ComparedStance& s) {
  const Stance& p = s.predicted;
  const auto down = change_at(d, s.contact, true, p.touchdown), up = change_at(d, s.contact, false, p.liftoff),
             left = change_at(d, s.contact, false, p.left);
  if (down) s.touchdown_band = promise.half_band(*down);
  if (down && up) s.duration_band = promise.half_band(*down, *up);
  if (down && left) s.flight_band = promise.half_band(*left, *down);
}

/// The mean of a duration over all stances of the logs of a contact but one; NaN where fewer than two know it.
double mean_of_others(const std::vector<ComparedStance>& all, const ComparedStance& own,
                      double (Stance::*duration)() const) {
  double sum = 0;
  int n = 0;
  for (const ComparedStance& s : all)
    if (const double x = (s.measured.*duration)(); &s != &own && s.contact == own.contact && std::isfinite(x))
      sum += x, ++n;
  return n >= 2 ? sum / n : Stance::kUnknown;
}

class Means {
 public:
  void add(double measured, double predicted, double band, double others) {
    const double off = std::abs(predicted - measured);
    if (!std::isfinite(off)) return;
    ++errors_.count, absolute_ += off, relative_ += off / measured;
    others_ += std::abs(others - measured) / measured, within_ += std::isnan(band) ? band : double(off <= band);
  }
  TimeErrors durations() const {
    TimeErrors out = errors_;
    if (out.count == 0) return out;
    out.absolute = absolute_ / out.count, out.relative = relative_ / out.count;
    out.others = others_ / out.count, out.within = within_ / out.count;
    return out;
  }
  TimeErrors times() const {
    TimeErrors out = durations();
    out.relative = out.others = Stance::kUnknown;
    return out;
  }

 private:
  TimeErrors errors_;
  double absolute_ = 0, relative_ = 0, others_ = 0, within_ = 0;
};

}  // namespace

double stance_level(double largest, double weight, double noise) {
  const double part = kPart * largest, small = weight > 0 ? std::min(part, kOfWeight * weight) : part;
  return noise > small ? noise : small;
}

std::vector<Stance> stances(const std::vector<double>& t, const std::vector<double>& force, double level) {
  std::vector<Stance> out;
  bool stands = false;
  std::optional<std::size_t> before;
  const auto crossing = [&](std::size_t i, double through) {
    if (!before) return Stance::kUnknown;
    return std::lerp(t[*before], t[i], (through - force[*before]) / (force[i] - force[*before]));
  };
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (!std::isfinite(force[i])) continue;
    if (!stands && force[i] > level) {
      stands = true;
      const double touchdown = crossing(i, level), left = out.empty() ? Stance::kUnknown : out.back().liftoff;
      if (touchdown - left < kShortestFlight)
        out.back().liftoff = Stance::kUnknown;
      else
        out.push_back({touchdown, Stance::kUnknown, left});
    } else if (stands && force[i] < kLeaves * level) {
      stands = false, out.back().liftoff = crossing(i, kLeaves * level);
    }
    before = i;
  }
  return out;
}

std::vector<ComparedStance> compared_stances(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                                             const FloorFit& followed) {
  std::vector<ComparedStance> out;
  for (const ForceChannel& channel : force_channels(robot.scene.robot, trials)) {
    const Sensor sensor = robot.sensors.of(channel.name);
    const double noise = kNoises * followed.noise[channel.at] / sensor.gain;
    double largest = 0;
    for (const RobotTrial& t : trials)
      for (const double f : t.log.output[channel.at])
        if (std::isfinite(f)) largest = std::max(largest, sensor.actual(f));
    if (!(largest > 0)) continue;
    const Robot& body = robot.scene.robot;
    const double level = stance_level(largest, body.mass() * body.gravity, noise);
    for (std::size_t m = 0; m < trials.size(); ++m) {
      const DropLog& log = trials[m].log;
      const DropResult& d = followed.drops[m];
      if (!d.simulated || log.output[channel.at].empty()) continue;
      const std::vector<Stance> measured = stances(log.t, actual(log.output[channel.at], sensor), level),
                                predicted = stances(log.t, actual(d.value[channel.at], sensor), level);
      const std::vector<int> partner = partners(measured, predicted, log.t.back());
      for (std::size_t i = 0; i < measured.size(); ++i) {
        ComparedStance s{.trial = m, .contact = channel.contact, .in_log = true, .measured = measured[i]};
        if (partner[i] >= 0) s.in_rollout = true, s.predicted = predicted[std::size_t(partner[i])];
        out.push_back(s);
      }
      for (std::size_t j = 0; j < predicted.size(); ++j)
        if (std::find(partner.begin(), partner.end(), int(j)) == partner.end())
          out.push_back({.trial = m, .contact = channel.contact, .in_rollout = true, .predicted = predicted[j]});
    }
  }
  for (ComparedStance& s : out) {
    if (followed.promises.size() > s.trial && followed.promises[s.trial].known())
      set_bands(followed.drops[s.trial], followed.promises[s.trial], s);
    s.duration_of_others = mean_of_others(out, s, &Stance::duration);
    s.flight_of_others = mean_of_others(out, s, &Stance::flight);
  }
  return out;
}

std::vector<StanceErrors> stance_errors(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                                        const std::vector<ComparedStance>& compared) {
  std::vector<StanceErrors> out;
  for (const ForceChannel& channel : force_channels(robot.scene.robot, trials)) {
    StanceErrors e{.contact = channel.contact};
    Means touchdown, duration, flight;
    for (const ComparedStance& s : compared) {
      if (s.contact != channel.contact) continue;
      e.measured += s.in_log, e.missed += !s.in_rollout, e.added += !s.in_log;
      touchdown.add(s.measured.touchdown, s.predicted.touchdown, s.touchdown_band, Stance::kUnknown);
      duration.add(s.measured.duration(), s.predicted.duration(), s.duration_band, s.duration_of_others);
      flight.add(s.measured.flight(), s.predicted.flight(), s.flight_band, s.flight_of_others);
    }
    e.touchdown = touchdown.times(), e.duration = duration.durations(), e.flight = flight.durations();
    out.push_back(e);
  }
  return out;
}

}  // namespace ukemi::tools
