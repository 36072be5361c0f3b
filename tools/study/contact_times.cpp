#include "tools/study/contact_times.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace ukemi::tools {

using namespace landing;

namespace {

constexpr double kOfLargest = 0.05, kOfWeight = 0.2, kNoises = 6, kLiftoff = 0.5;  // kLiftoff: of the threshold

/// The channel of a contact's normal force.
struct ForceChannel {
  int contact;
  std::size_t index;
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

/// Overlap of two stances within a trial of length `end` [s]; negative: the gap between them.
double overlap(const Stance& a, const Stance& b, double end) {
  const auto from = [](const Stance& s) { return std::isnan(s.touchdown) ? 0 : s.touchdown; };
  const auto to = [end](const Stance& s) { return std::isnan(s.liftoff) ? end : s.liftoff; };
  return std::min(to(a), to(b)) - std::max(from(a), from(b));
}

/// Greedy matching by longest overlap: the index into `b` of each of `a`; -1: none.
std::vector<int> partners(const std::vector<Stance>& a, const std::vector<Stance>& b, double end) {
  std::vector<int> out(a.size(), -1);
  std::vector<bool> taken(b.size(), false);
  for (;;) {
    double longest = 0;
    std::size_t best_a = 0, best_b = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      for (std::size_t j = 0; j < b.size(); ++j)
        if (const double time = overlap(a[i], b[j], end); out[i] < 0 && !taken[j] && time > longest)
          longest = time, best_a = i, best_b = j;
    if (longest == 0) return out;
    out[best_a] = int(best_b), taken[best_b] = true;
  }
}

/// Index of the rollout's touchdown or lift-off of a contact that is closest to t.
std::optional<std::size_t> change_at(const DropResult& d, int contact, bool touches, double t) {
  std::optional<std::size_t> out;
  for (std::size_t i = 0; i < d.changes.size(); ++i)
    if (const ContactChange& c = d.changes[i]; c.contact == contact && c.touches == touches)
      if (!out || std::abs(c.t - t) < std::abs(d.changes[*out].t - t)) out = i;
  return std::isfinite(t) ? out : std::nullopt;
}
void set_bands(const DropResult& d, const PredictionBands& bands, ComparedStance& s) {
  const Stance& p = s.predicted;
  const auto touchdown = change_at(d, s.contact, true, p.touchdown),
             liftoff = change_at(d, s.contact, false, p.liftoff),
             previous = change_at(d, s.contact, false, p.previous_liftoff);
  if (touchdown) s.touchdown_band = bands.half_band(*touchdown);
  if (touchdown && liftoff) s.duration_band = bands.half_band(*touchdown, *liftoff);
  if (touchdown && previous) s.flight_band = bands.half_band(*previous, *touchdown);
}

/// The mean of a duration over all other logged stances of a contact; NaN where fewer than two have it.
double mean_of_others(const std::vector<ComparedStance>& all, const ComparedStance& excluded,
                      double (Stance::*duration)() const) {
  double sum = 0;
  int n = 0;
  for (const ComparedStance& s : all)
    if (const double x = (s.measured.*duration)(); &s != &excluded && s.contact == excluded.contact && std::isfinite(x))
      sum += x, ++n;
  return n >= 2 ? sum / n : Stance::kUnknown;
}

class MeanErrors {
 public:
  void add(double measured, double predicted, double band, double others) {
    const double error = std::abs(predicted - measured);
    if (!std::isfinite(error)) return;
    ++errors_.count, absolute_ += error, relative_ += error / measured;
    others_ += std::abs(others - measured) / measured, within_ += std::isnan(band) ? band : double(error <= band);
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

double stance_threshold(double largest, double weight, double noise) {
  const double part = kOfLargest * largest, small = weight > 0 ? std::min(part, kOfWeight * weight) : part;
  return noise > small ? noise : small;
}

std::vector<Stance> stances(const std::vector<double>& t, const std::vector<double>& force, double threshold) {
  std::vector<Stance> out;
  bool in_stance = false;
  std::optional<std::size_t> previous;
  const auto crossing = [&](std::size_t i, double value) {
    if (!previous) return Stance::kUnknown;
    return std::lerp(t[*previous], t[i], (value - force[*previous]) / (force[i] - force[*previous]));
  };
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (!std::isfinite(force[i])) continue;
    if (!in_stance && force[i] > threshold) {
      in_stance = true;
      const double touchdown = crossing(i, threshold), liftoff = out.empty() ? Stance::kUnknown : out.back().liftoff;
      if (touchdown - liftoff < kShortestFlight)
        out.back().liftoff = Stance::kUnknown;
      else
        out.push_back({touchdown, Stance::kUnknown, liftoff});
    } else if (in_stance && force[i] < kLiftoff * threshold) {
      in_stance = false, out.back().liftoff = crossing(i, kLiftoff * threshold);
    }
    previous = i;
  }
  return out;
}

std::vector<ComparedStance> compared_stances(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                                             const FloorFit& followed) {
  std::vector<ComparedStance> out;
  for (const ForceChannel& channel : force_channels(robot.scene.robot, trials)) {
    const Sensor sensor = robot.sensors.of(channel.name);
    const double noise = kNoises * followed.noise[channel.index] / sensor.gain;
    double largest = 0;
    for (const RobotTrial& t : trials)
      for (const double f : t.log.output[channel.index])
        if (std::isfinite(f)) largest = std::max(largest, sensor.actual(f));
    if (!(largest > 0)) continue;
    const Robot& body = robot.scene.robot;
    const double threshold = stance_threshold(largest, body.mass() * body.gravity, noise);
    for (std::size_t m = 0; m < trials.size(); ++m) {
      const DropLog& log = trials[m].log;
      const DropResult& d = followed.drops[m];
      if (!d.simulated || log.output[channel.index].empty()) continue;
      const std::vector<Stance> measured = stances(log.t, actual(log.output[channel.index], sensor), threshold),
                                predicted = stances(log.t, actual(d.value[channel.index], sensor), threshold);
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
    if (followed.bands.size() > s.trial && followed.bands[s.trial].known())
      set_bands(followed.drops[s.trial], followed.bands[s.trial], s);
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
    MeanErrors touchdown, duration, flight;
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
