#include "identify/fit/rig_terms.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/actuator.hpp"
#include "common/actuator_constants.hpp"
#include "common/error.hpp"

namespace ukemi::identify {

bool RigTerm::applies_to(const std::vector<Trial>& trials) const {
  return !needs || std::any_of(trials.begin(), trials.end(), [&](const Trial& t) { return !(t.*needs->at).empty(); });
}

double RigTerm::value_in(const SeaParameters<double>& sea) const {
  RolloutInputs<double> in{sea};
  return field ? field.of(in) : absent;
}

void RigTerm::set_in(SeaParameters<double>& sea, double value) const {
  if (!field) return;
  RolloutInputs<double> in{sea};
  field.of(in) = std::clamp(value, lower, upper);
  sea = in.sea;
}

Parameter RigTerm::column(const SeaParameters<double>& start, const SeaParameters<double>& suggested,
                          const Choice& choice) const {
  constexpr double kOffBound = 0.1;  // of a constant's size, where it starts at 0
  const double at = value_in(start), of = relative_to ? start.*relative_to : 0;
  if (is_constant()) {
    const double typical = at > 0 ? at : value_in(suggested);
    return parameter_of(*this, std::max(at, kOffBound * typical), typical, choice);
  }
  if (!std::isfinite(at)) throw InputError(name + ": it is fitted from a value to start with, and there is none");
  const double typical = of > 0 ? part * of : size;
  return parameter_of(*this, one_sided() && !(at > absent) ? absent + typical : at, typical, choice);
}

namespace {

using Sea = SeaParameters<double>;

/// One of the five constants, bounded below by 0.
template <class F>
RigTerm constant(std::size_t i, const char* words, double size, double smallest_part, F field) {
  RigTerm t{{.name = kConstantNames[i], .unit = kConstantUnits[i], .words = words, .size = size}, input_field(field)};
  t.role = Term::Role::kConstant, t.lower = 0, t.smallest_part = smallest_part, t.key = t.name;
  return t;
}
/// A nuisance term of the rig or its sensors.
template <class F>
RigTerm nuisance(const char* name, const char* unit, const char* words, Scope scope, double size, F field) {
  return {{.name = name, .unit = unit, .words = words, .scope = scope, .size = size}, input_field(field)};
}
RigTerm bounded(RigTerm t, double lower, double upper, double absent) {
  t.lower = lower, t.upper = upper, t.absent = absent;
  return t;
}
/// An optional term of the actuator, absent at its lower bound 0; typical size: `part` of one of the five constants.
RigTerm optional(RigTerm t, double part, double Sea::*of, const char* key) {
  t.lower = 0, t.part = part, t.relative_to = of, t.key = key;
  return t;
}
RigTerm with_alias(const char* alias, RigTerm t) {
  t.alias = alias;
  return t;
}
RigTerm only_with(RigTerm t, std::vector<double Sea::*> constants) {
  t.only_with = std::move(constants);
  return t;
}
/// A constant of the actuator's file, under the term's own name.
RigTerm stored(RigTerm t) {
  t.key = t.name;
  return t;
}
/// The asymmetry of a Coulomb friction, bounded so that both levels stay above 0.
template <class F>
RigTerm asymmetry(const char* name, const char* words, F field, double Sea::*friction) {
  RigTerm t = stored(bounded(nuisance(name, "1", words, Scope::kShared, 0.2, field), -0.95, 0.95, 0));
  t.judged_size = 1;
  return only_with(std::move(t), {friction});
}
/// Change of Trial::force_smooth from the log's own value.
RigTerm force_interpolation() {
  RigTerm t{{.name = kForceSmooth, .unit = "1", .words = "the force between its samples: 0 as read, 1 smoother"}};
  t.size = 1, t.lower = -1, t.upper = 1;
  t.change = [](double value, Rig&, Sea&, Trial& log) { log.force_smooth += value; };
  return t;
}
RigTerm needs_torque(RigTerm t) {
  t.needs = {"torque", &Trial::torque};
  return t;
}
/// The rig file states its error under this key.
RigTerm with_error(const char* key, RigTerm t) {
  const std::vector<RigErrorKey>& keys = rig_error_keys();
  t.error = &*std::find_if(keys.begin(), keys.end(), [&](const RigErrorKey& k) { return k.key == std::string(key); });
  return t;
}
/// A delay or a filter of the drive.
template <class F>
RigTerm lag(const char* name, const char* error, const char* words, F field) {
  return with_error(error, stored(bounded(nuisance(name, "s", words, Scope::kShared, 1e-3, field), 0, kMaxDelay, 0)));
}
/// A factor on a number of the rig file.
RigTerm of_rig(const char* name, const char* words, double Rig::*at) {
  RigTerm t{{.name = name, .unit = "1", .words = words}};
  t.change = [at](double value, Rig& rig, Sea&, Trial& log) {
    Rig& trial_rig = log.rig ? *log.rig : rig;  // by name: GCC 12 multiplies a copy where both stand in one expression
    trial_rig.*at *= value;
  };
  return bounded(t, 0.01, 100, 1);
}
/// Not tested, because force_gain has almost the same effect.
RigTerm not_tested(RigTerm t) {
  t.tested = false;
  return t;
}
RigTerm in_ladder(RigTerm t) {
  t.in_ladder = true;
  return t;
}

/// The five constants of the paper.
std::vector<RigTerm> five_constants() {
  return {
      constant(0, "proportional gain of the motor", 1, 0, [](auto& in) { return &in.sea.k_p; }),
      constant(1, "derivative gain of the motor", 0.1, 0, [](auto& in) { return &in.sea.k_d; }),
      constant(2, "stiffness of the spring", 10, 0, [](auto& in) { return &in.sea.k_sea; }),
      constant(3, "damping of the spring", 0.1, 0, [](auto& in) { return &in.sea.c_sea; }),
      // It divides Eq. 4.
      constant(4, "reflected inertia of the motor", 1e-3, 1e-6, [](auto& in) { return &in.sea.i_motor; }),
  };
}
/// Dry and viscous friction on either side.
std::vector<RigTerm> friction_terms() {
  constexpr auto kShared = Scope::kShared;
  return {
      in_ladder(optional(nuisance("friction", "Nm", "dry friction on the motor", kShared, 0.1,
                                  [](auto& in) { return &in.sea.friction; }),
                         0.01, &Sea::k_p, "friction")),
      with_alias("viscous", optional(nuisance("viscous_friction", "Nm/(rad/s)", "viscous friction on the motor",
                                              kShared, 0.01, [](auto& in) { return &in.sea.viscous; }),
                                     0.1, &Sea::k_d, "viscous_friction")),
      asymmetry(
          "friction_asymmetry", "of friction: half the difference of both directions' levels over their mean",
          [](auto& in) { return &in.sea.friction_asymmetry; }, &Sea::friction),
      in_ladder(optional(nuisance("output_friction", "Nm", "dry friction on the output", kShared, 0.1,
                                  [](auto& in) { return &in.sea.output_friction; }),
                         0.01, &Sea::k_p, "output_friction")),
      with_alias("output_viscous_friction",
                 optional(nuisance("output_viscous", "Nm/(rad/s)", "viscous friction on the output", kShared, 0.01,
                                   [](auto& in) { return &in.sea.output_viscous; }),
                          0.1, &Sea::k_d, "output_viscous")),
      asymmetry(
          "output_friction_asymmetry", "the same of output_friction",
          [](auto& in) { return &in.sea.output_friction_asymmetry; }, &Sea::output_friction),
  };
}
/// Optional terms of the motor and the spring, friction apart.
std::vector<RigTerm> drive_terms() {
  constexpr auto kShared = Scope::kShared;
  return {
      // Only for drives whose command is known: without one nothing depends on it.
      only_with(optional(nuisance("k_t", "Nm/unit", "the motor's torque for a unit of its command", kShared, 1,
                                  [](auto& in) { return &in.sea.k_t; }),
                         1, &Sea::k_t, "k_t"),
                {&Sea::k_t}),
      // What the spring loads also rubs without load: constant friction is tested first.
      only_with(stored(bounded(nuisance("spring_loss", "1", "dry friction on the motor over the spring's torque",
                                        kShared, 0.05, [](auto& in) { return &in.sea.spring_loss; }),
                               0, 1, 0)),
                {&Sea::friction}),
      // Typical size: as much torque as the linear part at a deflection of 1 rad.
      in_ladder(
          bounded(optional(nuisance("stiffening", "Nm/rad^3", "cubic stiffness of the spring; below 0: it softens",
                                    kShared, 10, [](auto& in) { return &in.sea.k_sea_cubic; }),
                           1, &Sea::k_sea, "k_sea_cubic"),
                  -Term::kInfinity, Term::kInfinity, 0)),
      // Starts at the rig's or the start's value; no effect where no trial reaches the limit.
      stored(bounded(nuisance("tau_max", "Nm", "limit of the spring's torque", kShared, 10,
                              [](auto& in) { return &in.sea.tau_max; }),
                     0, Term::kInfinity, Term::kInfinity)),
  };
}
/// Scale errors that all trials share: numbers of the rig, gains of its sensors.
std::vector<RigTerm> rig_scale_terms() {
  constexpr auto kShared = Scope::kShared;
  return {
      with_error("force_gain", bounded(nuisance("force_gain", "1", "the force over the load cell's", kShared, 1,
                                                [](auto& in) { return &in.nuisance.force_gain; }),
                                       0.01, 100, 1)),
      with_error("inertia", not_tested(of_rig("inertia", "the link's inertia over the rig file's", &Rig::inertia))),
      with_error("length", not_tested(of_rig("length", "the lever arm over the rig file's", &Rig::length))),
      with_error("encoder_gain",
                 not_tested(bounded(nuisance("encoder_gain", "1", "the measured angle over the link's", kShared, 1,
                                             [](auto& in) { return &in.nuisance.encoder_gain; }),
                                    0.01, 100, 1))),
  };
}
/// Terms that each trial has for itself.
std::vector<RigTerm> trial_terms() {
  constexpr auto kEach = Scope::kEach;
  return {
      nuisance("initial_angle", "rad", "angle at the start", kEach, 0.01, [](auto& in) { return &in.nuisance.angle; }),
      nuisance("initial_rate", "rad/s", "rate at the start", kEach, 0.1, [](auto& in) { return &in.nuisance.rate; }),
      nuisance("encoder_offset", "rad", "the measured angle minus the link's", kEach, 0.01,
               [](auto& in) { return &in.nuisance.encoder_offset; }),
      nuisance("force_bias", "N", "the force minus the load cell's", kEach, 1,
               [](auto& in) { return &in.nuisance.force_bias; }),
      with_error("time_shift", bounded(nuisance("time_shift", "s", "by which the hit came later than logged", kEach,
                                                1e-3, [](auto& in) { return &in.nuisance.time_shift; }),
                                       -0.1, 0.1, 0)),
      force_interpolation(),
  };
}
/// Sensor errors of a log of the spring's torque.
std::vector<RigTerm> torque_terms() {
  constexpr auto kShared = Scope::kShared;
  return {
      needs_torque(bounded(nuisance("torque_gain", "1", "the logged torque over the spring's", kShared, 1,
                                    [](auto& in) { return &in.nuisance.torque_gain; }),
                           0.01, 100, 1)),
      needs_torque(nuisance("torque_bias", "Nm", "the logged torque minus the spring's", kShared, 0.1,
                            [](auto& in) { return &in.nuisance.torque_bias; })),
  };
}
/// Delay and filter of the drive.
std::vector<RigTerm> lag_terms() {
  return {
      lag("control_delay", "delay", "from what the drive measures, or is told, to its torque",
          [](auto& in) { return &in.sea.control_delay; }),
      only_with(lag("velocity_filter", "filter", "time constant of the low-pass of the rate that K_d sees",
                    [](auto& in) { return &in.sea.velocity_filter; }),
                {&Sea::k_d}),
  };
}
/// The Stribeck effect, on the dry friction of either side.
std::vector<RigTerm> stribeck_terms() {
  constexpr auto kShared = Scope::kShared;
  return {
      only_with(stored(bounded(nuisance("breakaway", "1",
                                        "of dry friction: what it breaks away with over what it slides with, less 1",
                                        kShared, 0.3, [](auto& in) { return &in.sea.breakaway; }),
                               0, Term::kInfinity, 0)),
                {&Sea::friction, &Sea::output_friction}),
      only_with(stored(bounded(nuisance("stribeck_speed", "rad/s", "by which breakaway falls to 1/e", kShared, 0.05,
                                        [](auto& in) { return &in.sea.stribeck_speed; }),
                               1e-4, 100, Sea{}.stribeck_speed)),
                {&Sea::breakaway}),
  };
}
/// All terms, in the order of reports.
std::vector<RigTerm> table() {
  std::vector<RigTerm> out;
  for (const auto part : {five_constants, friction_terms, drive_terms, rig_scale_terms, trial_terms, torque_terms,
                          lag_terms, stribeck_terms})
    for (RigTerm& t : part()) out.push_back(std::move(t));
  return out;
}

/// An experiment that measures a term where logs of hits cannot.
struct Measure {
  const char *term, *experiment;
};
constexpr Measure kMeasures[] = {
    {"force_gain", "hang a known weight on the load cell"},
    {"inertia", "weigh the link and time its swing as a pendulum"},
    {"length", "measure the lever arm of the force"},
    {"encoder_gain", "turn the joint by a known angle"},
    {"time_shift", "log force and angle by one clock"},
    {"control_delay", "log the drive's command beside the angle, or ask its maker for the delay of its loop"},
    {"velocity_filter", "ask the drive's maker for the filter of its velocity"},
    {"friction", "turn the motor slowly, without load, and log its torque"},
    {"viscous_friction", "turn the motor at several constant speeds, without load, and log its torque"},
    {"output_friction", "turn the output slowly, off its spring, and log the torque that it takes"},
    {"output_viscous", "let the output swing free, off its spring, and log how it dies away"},
    {"stiffening", "load the joint with weights, the motor held, and log its deflection"},
};

}  // namespace

const std::vector<RigTerm>& rig_terms() {
  static const std::vector<RigTerm> terms = [] {
    std::vector<RigTerm> out = table();
    for (RigTerm& t : out)
      for (const Measure& m : kMeasures)
        if (t.name == m.term) t.measure = m.experiment;
    return out;
  }();
  return terms;
}

Terms<RigTerm> rig_choice() { return all_constants(rig_terms()); }

}  // namespace ukemi::identify
