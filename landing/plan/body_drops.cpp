#include "landing/plan/body_drops.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/actuator_constants.hpp"
#include "common/checks.hpp"
#include "common/eigen.hpp"
#include "landing/body/command_path.hpp"
#include "landing/body/floor_constants.hpp"
#include "landing/body/load.hpp"
#include "landing/lanes/body_batch.hpp"
#include "landing/plan/design_numbers.hpp"
#include "landing/scatter/drop_model.hpp"
#include "landing/scatter/moved.hpp"

namespace ukemi::landing {

namespace {
constexpr const char* kPitch = "pitch";
}

BodyMotion BodyDrop::played(const BodyMotion& planned) const {
  BodyMotion out = planned;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!scene.robot.joints[i].driven()) continue;
    const Joint& offset = joints[i];
    out[i] = released_beside(deviated(planned[i], scene.execution, offset.deviation), offset.phi, offset.rate);
  }
  return out;
}

namespace {

/// Scales the constants of a contact, which are log-normal.
void scale(ContactPoint& c, const Scatter& z) {
  for (const ScatterTerm& t : kScatterTerms)
    if (double* const x = t.kind == ScatterTerm::Kind::kRelative ? contact_constant(c, t.name) : nullptr)
      *x *= std::exp(z.*t.deviation);
}

}  // namespace

BodyDropModel::BodyDropModel(const BodyScene& scene, const Scatter& scatter, const Options& options)
    : scene_(scene), phi_(scatter.phi > 0), rate_(scatter.rate > 0), inexact_(options.inexact) {
  scene.validate(), scatter.validate(), check_not_negative("inflate", options.inflate);
  const Robot& robot = scene.robot;
  for (const auto& [deviation, fixed, what] :
       {std::tuple(scatter.forward_speed, robot.base != Base::kFree, "forward_speed"),
        {scatter.pitch_rate, robot.base == Base::kRail, "pitch_rate"},
        {scatter.height, robot.base == Base::kPinned, "height"}})
    if (deviation > 0 && fixed) throw InputError(std::string("scatter: ") + what + ": a robot on this base has none");
  const auto check = [&](double deviation, const char* what, auto&& has) {
    if (deviation > 0 && std::none_of(robot.contacts.begin(), robot.contacts.end(), has))
      throw InputError(std::string("scatter: ") + what + ": no contact of this robot has any");
  };
  check(scatter.friction, "friction", [](const ContactPoint& c) { return std::isfinite(c.law.friction); });
  check(scatter.stiffness_tangential, "stiffness_tangential", [](auto& c) { return c.law.stiffness_tangential > 0; });
  check(scatter.dissipation, "dissipation", [](auto& c) { return c.law.hunt_crossley && c.law.dissipation > 0; });
  check(std::max({scatter.pad_thickness, scatter.pad_stiffness, scatter.pad_damping}), "pad_...",
        [](auto& c) { return c.pad.has_value(); });
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    if (robot.joints[i].driven()) driven_.push_back(int(i));
  if (scene.identified && options.inflate > 0) scatter_robot(*scene.identified, options.inflate);
  scene_.identified.reset(), scene_.robot_verdicts.clear();
  for (const ScatterTerm& t : kScatterTerms) {
    const bool of_joints = t.deviation == &Scatter::phi || t.deviation == &Scatter::rate;
    if (!(scatter.*t.deviation > 0) || of_joints) continue;
    scatter_terms_.push_back(t.deviation);
    sampler_.normal(t.name, scatter.*t.deviation);
  }
  if (scene.uncertainty) scatter_floor(*scene.uncertainty);
  scene_.uncertainty.reset(), scene_.verdicts.clear();
  if (phi_) sampler_.normal("phi", scatter.phi, int(driven_.size()));
  if (rate_) sampler_.normal("rate", scatter.rate, int(driven_.size()));
  for (const int i : driven_) {
    const Joint& joint = robot.joints[std::size_t(i)];
    const auto of_drive = [&](const std::string& name) { return name.starts_with("drive." + joint.name + "."); };
    if (joint.covariance.size() == 0 || options.inflate == 0 ||
        (scene.identified && std::any_of(scene.identified->order.begin(), scene.identified->order.end(), of_drive)))
      continue;
    fitted_.emplace_back(i, constant_indices(joint.uncertain));
    sampler_.correlated("drive of " + joint.name, joint.covariance, options.inflate);
  }
  if (inexact_) sampler_.uniform("execution", 2 * int(driven_.size()) + 1);
}

/// Constants of the floor are log-normal: their covariance is made relative to their values.
void BodyDropModel::scatter_floor(const Uncertainty& known) {
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(long(known.order.size()));
  floor_names_ = known.order;
  for (std::size_t i = 0; i < floor_names_.size(); ++i) {
    const std::vector<double*> numbers = floor_constants(scene_, floor_names_[i]);
    if (floor_names_[i] == kPitch) continue;
    const double value = numbers.empty() ? 0 : *numbers.front();
    scale[long(i)] = value > 0 && std::isfinite(value) ? 1 / value : 0;
  }
  sampler_.correlated("floor", scale.asDiagonal() * eigen(known.covariance) * scale.asDiagonal());
}

/// Positive constants stay above a hundredth of their values.
void BodyDropModel::scatter_robot(const Uncertainty& known, double inflate) {
  static constexpr double kMinFactor = 0.01;
  for (const std::string& name : known.order) {
    const auto joint = std::find_if(scene_.robot.joints.begin(), scene_.robot.joints.end(),
                                    [&](const Joint& j) { return name == gain_name(j); });
    if (joint != scene_.robot.joints.end()) {
      robot_setters_.emplace_back([i = std::size_t(joint - scene_.robot.joints.begin())](BodyScene& s, double delta) {
        SeaParameters<double>& sea = s.robot.joints[i].sea;
        for (double* const x : {&sea.k_p, &sea.k_d, &sea.tau_max}) *x *= std::max(1 + delta, kMinFactor);
      });
      continue;
    }
    const double value = design_number(scene_, name);
    robot_setters_.emplace_back([value, set = design_setter(scene_, name)](BodyScene& s, double delta) {
      set(s, value > 0 ? std::max(value + delta, kMinFactor * value) : value + delta);
    });
  }
  sampler_.correlated("the robot", eigen(known.covariance), inflate);
}

BodyDrop BodyDropModel::drop(std::span<const double> u) const {
  const std::vector<double> deviations = sampler_.at(u);
  auto next = deviations.begin();
  BodyDrop out{scene_, std::vector<BodyDrop::Joint>(scene_.robot.joints.size())};
  for (const auto& set : robot_setters_) set(out.scene, *next++);  // before the floor's terms, which scale it
  Scatter z;
  for (double Scatter::*const term : scatter_terms_) z.*term = *next++;
  out.from_floor = move_drop(out.scene.drop, z);
  out.scene.detection_delay = std::max(0.0, scene_.detection_delay + z.delay);
  constexpr double kSteepest = 1.5;  // within a right angle [rad]
  out.scene.slope = std::clamp(scene_.slope + z.slope, -kSteepest, kSteepest);
  for (ContactPoint& c : out.scene.robot.contacts) scale(c, z);
  for (const std::string& name : floor_names_) {
    const double delta = *next++;
    for (double* const x : floor_constants(out.scene, name)) *x = name == kPitch ? *x + delta : *x * std::exp(delta);
  }
  for (ContactPoint& c : out.scene.robot.contacts) c.law.exponent = std::max(1.0, c.law.exponent);
  const auto joint = [&](int i) -> BodyDrop::Joint& { return out.joints[std::size_t(i)]; };
  for (const int i : driven_)
    if (phi_) joint(i).phi = *next++;
  for (const int i : driven_)
    if (rate_) joint(i).rate = *next++;
  for (const auto& [i, constants] : fitted_) {
    std::array<double, kActuatorConstants> moves{};
    for (const int k : constants) moves[std::size_t(k)] = *next++;
    SeaParameters<double>& sea = out.scene.robot.joints[std::size_t(i)].sea;
    sea = moved(sea, moves);
  }
  if (!inexact_) return out;
  const double duration = *next++;
  for (const int i : driven_) {
    const double a = *next++, b = *next++;
    joint(i).deviation = {a, b, duration};
  }
  return out;
}

BodyDropModel BodyDropModel::measured(const BodyScene& scene, std::vector<BodyDrop> drops) {
  BodyScene exact = scene;
  exact.uncertainty.reset(), exact.identified.reset();
  BodyDropModel out(exact, Scatter{}, {.inflate = 0});
  out.measured_ = std::move(drops);
  return out;
}

std::vector<BodyDrop> BodyDropModel::even(long count, std::uint64_t seed, long first) const {
  if (measured_.empty()) return drops(sampler_.even(count, seed, first), count);
  const std::size_t n = std::min(measured_.size(), std::size_t(count));
  std::vector<BodyDrop> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(measured_[i * measured_.size() / n]);
  return out;
}

std::vector<BodyDrop> BodyDropModel::drops(const std::vector<double>& points, long count) const {
  const auto d = std::size_t(sampler_.dimension());
  std::vector<BodyDrop> out;
  out.reserve(std::size_t(count));
  for (std::size_t n = 0; n < std::size_t(count); ++n) out.push_back(drop(std::span(points).subspan(n * d, d)));
  return out;
}

Scatter assumed_scatter(const Robot& robot) {
  Scatter out = Scatter::assumed();
  if (robot.base != Base::kFree) out.forward_speed = 0;
  if (robot.base == Base::kPinned) out.height = 0;
  return out;
}

Scatter scatter_for(const std::optional<Scatter>& requested, const BodyScene& scene) {
  return requested ? *requested : scene.scatter.value_or(assumed_scatter(scene.robot));
}

std::vector<BodyDrop> execution_drops(const BodyScene& scene) {
  const std::size_t joints = scene.robot.joints.size();
  const BodyDrop nominal{scene, std::vector<BodyDrop::Joint>(joints)};
  std::vector<BodyDrop> out = {nominal};
  const auto add = [&](std::size_t from, std::size_t to, const Deviation& d) {
    out.push_back(nominal);
    for (std::size_t i = from; i < to; ++i) out.back().joints[i].deviation = d;
  };
  for (const double s : {-1.0, 1.0}) {
    add(0, joints, {0, 0, s});
    for (std::size_t i = 0; i < joints; ++i)
      if (scene.robot.joints[i].driven()) add(i, i + 1, {s, 0, 0}), add(i, i + 1, {0, s, 0});
  }
  for (int k = 7; k < kExecutionPoints; ++k) add(0, joints, execution_deviation(k));
  return out;
}

PeaksOver peaks_over(std::span<const BodyDrop> drops, const BodyMotion& motion, double accuracy, int threads,
                     const std::function<bool()>* over) {
  PeaksOver out{.peaks = std::vector<double>(drops.size(), std::numeric_limits<double>::infinity())};
  std::vector<BodyMotion> played;
  std::vector<BodyBatchCase> cases;
  played.reserve(drops.size());
  for (const BodyDrop& d : drops) cases.push_back({&d.scene, &played.emplace_back(d.played(motion))});
  std::vector<BodyLanding> landings(drops.size());
  body_batch_peaks(cases, landings, {.accuracy = accuracy, .over = over}, threads);
  for (std::size_t k = 0; k < landings.size(); ++k) {
    const BodyLanding& l = landings[k];
    out.broken += bool(l.broken);
    if (no_landing(l.end) || l.end == End::kStopped) continue;
    const BodyScene& scene = drops[k].scene;
    const std::vector<LoadPeak> loads = loads_of(scene, l);
    out.peaks[k] = worth(scene, l.peak, loads);
    out.exceeded.resize(loads.size());
    for (std::size_t i = 0; i < loads.size(); ++i)
      out.exceeded[i] += loads[i].value > rating_limit(scene.loads[i], scene.robot);
  }
  return out;
}

}  // namespace ukemi::landing
