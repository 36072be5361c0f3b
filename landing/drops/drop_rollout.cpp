#include "landing/drops/drop_rollout.hpp"

#include <cmath>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/body/by_links.hpp"
#include "landing/derivatives/differentiated_body.hpp"
#include "landing/derivatives/paper_parameters.hpp"

namespace ukemi::landing {

namespace {

/// Samples the landing at given times.
template <class Landing>
class SampleObserver {
  using Jet = typename Landing::Jet;
  using State = typename Landing::State;
  using Values = typename Landing::Values;
  using System = typename Landing::System;

 public:
  explicit SampleObserver(const std::vector<double>& times) : times_(times) { out.samples.reserve(times.size()); }

  template <class Fall>
  void fall(const Landing& l, const Fall& f) {
    while (waiting() && next() < f.until) sample(l, f.at(next()));
  }
  void begin(const Landing&, double, const State&) {}
  void step(const Landing& l, typename Landing::Driver& driver) {
    const auto& step = driver.step();
    for (; waiting() && next() <= step.t + step.h;)
      sample(l, driver.dense().at(step.place_of(std::max(next(), step.t))));
  }
  void before_event(const Landing&, double, const State&, const State&, const typename Landing::Derivatives&) {}
  void after_event(const Landing&, double t, const State&, const typename Landing::Derivatives&, int event) {
    if (event < System::kJointGuards && event % System::kGuardsPerContact == System::kSurface) out.jumps.push_back(t);
  }
  void time_limit(const Landing& l, double, const State& y, const State&, const typename Landing::Derivatives&) {
    while (waiting()) sample(l, y);  // the last time, if it exceeds the time limit by rounding
  }
  void finish(const Landing&) {}
  double running() const { return 0; }  // no rest test: a drop is followed to its last time

  DropRollout out;  ///< derivatives by scaled parameters, see unit()

 private:
  bool waiting() const { return out.samples.size() < times_.size(); }
  double next() const { return times_[out.samples.size()]; }

  void sample(const Landing& l, const State& y) {
    using std::sqrt;
    const double t = next();
    const Values v = Landing::values(y), dv = l.plain().derivative(t, v);
    const Vec2<Jet> a = l.acceleration(y, l.system().derivative(t, y));
    const auto da = l.acceleration_rate(t, v, dv);
    const auto pose = l.system().pose(y);
    const auto& body = l.system().body;
    const Vec2<Jet> r = position(body.peak, pose, body.bodies), dr = velocity(body.peak, pose, body.bodies);
    DropSample s;
    const auto set = [&](DropOutput o, const Jet& value, double rate) {
      s.value[o] = value.a, s.rate[o] = rate, s.slope[o] = value.v.template head<kDropParameters>();
    };
    set(kAccX, a.x(), da.x().v[0]), set(kAccY, a.y(), da.y().v[0]);
    set(kThighX, r.x(), dr.x().a), set(kThighY, r.y(), dr.y().a);
    set(kThighAngle, y[System::kTheta], v[System::kOmega]);
    const Jet square = a.x() * a.x() + a.y() * a.y();
    if (square.a > 0)
      set(kAcc, sqrt(square), (a.x().a * s.rate[kAccX] + a.y().a * s.rate[kAccY]) / sqrt(square.a));
    else
      set(kAcc, Jet(0), 0);  // weightless: |ddr_0| has no derivative there
    out.samples.push_back(s);
  }

  const std::vector<double>& times_;
};

template <Capacity kSize>
DropRollout roll(const TwoLinkLanding& drop, const std::vector<double>& times, const SimulateOptions& options) {
  constexpr int kJets = 8;  // as many registers as for the parameters
  using Landing = DifferentiatedBody<kJets, kSize>;
  std::array<BodyParameter, kDropParameters> parameters;
  for (int i = 0; i < kDropParameters; ++i)
    parameters[std::size_t(i)] = body_parameter(Parameter(int(Parameter::kHeight) + i));
  Landing landing(drop.scene, drop.motion, parameters, options);
  SampleObserver<Landing> observer(times);
  const auto outcome = landing.run(observer);
  DropRollout out = std::move(observer.out);
  out.status = outcome.status;
  out.steps = outcome.work.steps + outcome.work.rejected;
  out.complete = out.samples.size() == times.size();
  for (DropSample& s : out.samples)
    for (DropDerivatives& d : s.slope) d.array() /= landing.unit().template head<kDropParameters>();
  return out;
}

}  // namespace

void check_drop_times(const std::vector<double>& times) {
  for (std::size_t i = 0; i < times.size(); ++i)
    if (!(std::isfinite(times[i]) && times[i] >= (i > 0 ? times[i - 1] : 0)))
      throw InputError("times: " + shortest(times[i]) + " s: finite times that do not decrease, from 0 on, are needed");
}

DropRollout roll_drop(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                      const std::vector<double>& times, const SimulateOptions& options) {
  validate(scene, sea, motion), options.validate();
  if (times.empty()) return {.complete = true};
  check_drop_times(times);
  TwoLinkLanding drop(scene, sea, motion);
  drop.scene.t_end = times.back();
  SimulateOptions drop_options = options;
  drop_options.rest = SimulateOptions::Rest::kIgnore;
  return in_kernel<kPlainPair, kPair, kLateLeg>(
      drop.scene.robot, [&]<Capacity kSize>() { return roll<kSize>(drop, times, drop_options); });
}

}  // namespace ukemi::landing
