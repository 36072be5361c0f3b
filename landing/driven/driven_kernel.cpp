// Compiled once for each kernel, UKEMI_KERNEL (see CMakeLists.txt).
#include "landing/driven/driven_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/force_curve.hpp"
#include "landing/body/body_system.hpp"
#include "landing/body/load_value.hpp"

namespace ukemi::landing {

namespace {

constexpr double kFarthest = 1e4;  ///< of any state in SI units: beyond it a run is lost

template <Capacity kSize>
class DrivenRun {
 public:
  using System = BodySystem<kSize>;
  using State = typename System::State;

  DrivenRun(const Robot& robot, const CommandPath& path, const Commands& commands, const Sensors* sensors = nullptr)
      : system_(robot, 0),
        path_(path),
        commands_(commands),
        peak_axis_(shifted(system_.body, Arms<double, System::kB>{}, robot.peak_link, Place{1, 0})),
        now_(std::size_t(system_.body.joints)) {
    if (robot.base == Base::kPinned) system_.base[1] = robot.pin_height;
    const std::vector<MeasuredColumn> columns = push_columns(robot);
    for (std::size_t i = 0; i < commands.push.size(); ++i) {
      const PushPoint& p = robot.pushes[i];
      pushed_.push_back({.at = shifted(system_.body, system_.body.origin[std::size_t(p.link)], p.link, p.at)});
      Pushed& to = pushed_.back();
      for (const std::size_t q : {0, 1}) {
        if (sensors) to.sensor[q] = sensors->of(columns[2 * i + q].name);
        const std::vector<double>& f = commands.push[i][q];
        if (f.empty()) continue;
        to.curve[q].emplace(ForceSamples{commands.t, f, f.front(), sensors ? sensors->push_smooth : 0});
        for (std::size_t k = 0; k <= to.curve[q]->pieces(); ++k) push_edges_.push_back(to.curve[q]->begin(k));
      }
    }
    std::sort(push_edges_.begin(), push_edges_.end());
    push_edges_.erase(std::unique(push_edges_.begin(), push_edges_.end()), push_edges_.end());
    if (sensors) time_shift_ = sensors->time_shift;
  }

  void start(const DrivenStart& from, double t, DrivenRollout* out = nullptr) {
    t_ = t, y_ = State::Zero();
    const bool free = system_.body.base == Base::kFree;
    if (free) y_[System::kTheta] = from.pitch - system_.body.offset[0], y_[System::kOmega] = from.pitch_rate;
    for (int i = 0; i < system_.body.joints; ++i) {
      const JointPlace& at = system_.body.joint[i];
      const JointStart& s = from.joint[std::size_t(at.joint)];
      const bool ground = at.parent < 0;
      const double phi = s.phi - of(i).offset;
      y_[System::kTheta + at.child] = phi - at.offset + (ground ? 0 : y_[System::kTheta + at.parent]);
      y_[System::kOmega + at.child] = s.dphi + (ground ? 0 : y_[System::kOmega + at.parent]);
      if (system_.drive[i].kind == DriveKind::kElastic)
        y_[System::kPhiM + i] = phi + s.spring, y_[System::kOmegaM + i] = s.dphi;
    }
    if (system_.body.base != Base::kPinned) stand(from);
    for (int i = 0; i < system_.body.contacts; ++i)
      if (gap(i) < 0) cross(System::kOfContact * i + System::kSurface, out);
    for (int i = system_.body.stops_begin; i < system_.body.stops_end; ++i)
      if (system_.stop_at(i, system_.pose(y_), y_).y < 0) cross(System::kOfContact * i + System::kSurface, out);
    const auto until = [](const std::vector<double>& times, double time) {
      return std::size_t(std::upper_bound(times.begin(), times.end(), time) - times.begin());
    };
    row_ = until(commands_.t, t - path_.delay);
    asked_ = row_ > 0 ? row_ - 1 : 0;
    ask(asked_++);
    push_by(pushes_ = until(push_edges_, t - time_shift_));
    read_row(row_ > 0 ? row_ - 1 : 0);
    settle_lags();
    system_.settle_by([this](const State& y) { return holds(t_, y); }, y_);
  }
  /// To `until`, in steps that end at the commands' edges; their number is that of the whole way, wherever it is cut.
  bool advance(double until, const DrivenOptions& options, DrivenRollout& out) {
    const long n = long(std::ceil((until - t_) / options.step - 1e-9));
    while (true) {
      constexpr double kNever = std::numeric_limits<double>::infinity();
      const auto time_of = [](const std::vector<double>& t, std::size_t row) {
        return row < t.size() ? t[row] : kNever;
      };
      const double edge = time_of(commands_.t, row_) + path_.delay;
      const double asks = commands_.controller ? time_of(commands_.t, asked_) : kNever;
      const double forces = time_of(push_edges_, pushes_) + time_shift_;
      const double to = std::min({until, edge, asks, forces});
      if (const double length = to - t_; length > 0) {
        if ((out.steps += n) > options.most) return false;
        steps(length / double(n), n, out);
        t_ = to;
      }
      if (to >= until) break;
      if (forces <= to)
        push_by(++pushes_);
      else if (asks <= to)
        ask(asked_++);
      else
        read_row(row_++);
      hold_or_slip();
    }
    return y_.array().isFinite().all() && y_.cwiseAbs().maxCoeff() < kFarthest;
  }
  void sample(DrivenRollout& out) const {
    for (int i = 0; i < system_.body.joints; ++i) {
      auto& to = out.joint[std::size_t(system_.body.joint[i].joint)];
      const SeaState<double> s = system_.joint_state(i, y_);
      to[kAngle].push_back(s.phi + of(i).offset), to[kRate].push_back(s.dphi);
      to[kTorque].push_back(given(i, s, y_));
    }
    if (system_.body.base != Base::kFree) return;
    const Vec2<double> origin = position(system_.body.first, system_.pose(y_), system_.body.bodies);
    const double base[kBaseSensed] = {origin.x(), origin.y(), y_[System::kTheta] + system_.body.offset[0],
                                      y_[System::kOmega]};
    for (int q = 0; q < kBaseSensed; ++q) out.base[std::size_t(q)].push_back(base[q]);
  }
  void sample_loads(DrivenRollout& out) {
    const auto pose = system_.pose(y_);
    const auto a =
        acceleration(system_.body.peak, pose, system_.accelerations_of(derivative(t_, y_)), system_.body.bodies);
    const Vec2<double> along = position(peak_axis_, pose, system_.body.bodies) - Vec2<double>(pose.x, pose.y);
    const Vec2<double> across(-along.y(), along.x()), specific = a - Vec2<double>(system_.gravity.data());
    const double parts[kBodySensed] = {a.norm(), a.x(), a.y(), specific.dot(along), specific.dot(across)};
    for (int q = 0; q < kBodySensed; ++q) out.acceleration[std::size_t(q)].push_back(parts[q]);
    for (int i = 0; i < system_.body.contacts; ++i) {
      const Vec2<double> f = contact_force(system_, i, pose, y_);
      for (int q : {0, 1}) out.force[std::size_t(i)][std::size_t(q)].push_back(f[q]);
    }
  }
  /// See stable_step.
  double stable() const {
    double fastest = 1, falls = 0, lag = 0;  // [1/s]
    for (int i = 0; i < system_.body.joints; ++i) {
      const JointConstants<double>& d = system_.drive[i];
      State still = State::Zero(), dy;
      for (int j = 0; j < system_.body.bodies; ++j) still[System::kTheta + j] = y_[System::kTheta + j];
      std::array<double, 2> acc{};
      for (const double torque : {0.0, 1.0}) {
        HeldStill<double, kSize> none;
        system_.derivative_under(
            still, dy, [&](int k, double*) { return k == i ? torque : 0.0; }, {}, &none);
        const JointPlace& at = system_.body.joint[i];
        acc[torque > 0] = dy[System::kOmega + at.child] - (at.parent < 0 ? 0 : dy[System::kOmega + at.parent]);
      }
      double inverse = acc[1] - acc[0], dry = d.sea.friction, viscous = d.sea.viscous + d.damping;
      double stiff = d.stiffness + d.parallel_stiffness;
      if (d.kind == DriveKind::kElastic) {
        inverse += 1 / d.sea.i_motor, dry += d.sea.output_friction, viscous += d.sea.output_viscous + d.sea.c_sea;
        stiff += d.sea.k_sea;
        if constexpr (kSize.late) lag = std::max(lag, DriveLag<double>(d.sea).fastest());
      }
      const auto& columns = commands_.joint[std::size_t(system_.body.joint[i].joint)];
      const auto most = [&](CommandColumn what, double otherwise) {
        return columns[what].empty() ? otherwise : *std::max_element(columns[what].begin(), columns[what].end());
      };
      viscous += of(i).torque_gain * most(kKd, d.sea.k_d), stiff += of(i).torque_gain * most(kKp, d.sea.k_p);
      fastest = std::max({fastest, inverse * viscous, std::sqrt(inverse * stiff)});
      if (d.sea.breakaway > 0) falls = std::max(falls, inverse * dry * d.sea.breakaway / d.sea.stribeck_speed);
    }
    if (system_.body.base == Base::kRail) fastest = std::max(fastest, system_.rail_viscous / system_.body.mass);
    // Of a decay: the method holds up to 2.78, and is exact enough up to kExact; [s].
    constexpr double kHolds = 2, kExact = 0.2, kLongest = 1e-3, kInContact = 2e-4;
    const double longest = pushes() ? kInContact : kLongest;
    return std::min({longest, kExact / fastest, kHolds / std::max(lag, falls)});
  }

 private:
  double gap(int i) const { return system_.point_at(i, system_.pose(y_)).y - system_.point[i].thickness; }
  bool pushes() const { return system_.body.contacts > 0 || system_.has_stops(); }
  int lowest_contact() const {
    int out = -1;
    for (int i = 0; i < system_.body.contacts; ++i)
      if (out < 0 || gap(i) < gap(out)) out = i;
    return out;
  }
  /// The base, which is at 0 and at rest, moved to where it starts; a free one is the centre of mass.
  void stand(const DrivenStart& from) {
    const auto pose = system_.pose(y_);
    const bool free = system_.body.base == Base::kFree;
    const Vec2<double> origin = position(system_.body.first, pose, system_.body.bodies),
                       rate = velocity(system_.body.first, pose, system_.body.bodies);
    if (free) y_[System::kX] = from.x - origin.x(), y_[System::kVx] = from.forward_speed - rate.x();
    double height = from.height, speed = from.speed;
    if (from.y)
      height += (*from.y)[0] - origin.y(), speed += (*from.y)[1] - rate.y();
    else if (const int lowest = lowest_contact(); lowest >= 0)
      height -= gap(lowest), speed -= system_.point_at(lowest, pose).v;
    const double up = free ? 1 : system_.body.rail[1];
    y_[free ? System::kY : System::kX] = height / up, y_[free ? System::kVy : System::kVx] = speed / up;
  }
  /// A drive under one row's command.
  struct Now {
    double k_p = 0, k_d = 0, phi_ref = 0, dphi_ref = 0, ff = 0, on = 1;
  };
  const CommandPath::Joint& of(int i) const { return path_.joints[std::size_t(system_.body.joint[i].joint)]; }

  /// From the last of so many edges of the forces' pieces on.
  void push_by(std::size_t edges) {
    if (push_edges_.empty()) return;
    constexpr double kBefore = -std::numeric_limits<double>::infinity();
    pushed_from_ = push_edges_[edges > 0 ? edges - 1 : 0] + time_shift_;
    for (Pushed& p : pushed_)
      for (const std::size_t q : {0, 1}) {
        if (!p.curve[q]) continue;
        const Sensor& sensor = p.sensor[q];
        p.force[q] = p.curve[q]->from(edges > 0 ? push_edges_[edges - 1] : kBefore);
        p.force[q][0] = sensor.actual(p.force[q][0]);
        for (const std::size_t power : {1, 2, 3}) p.force[q][power] /= sensor.gain;
      }
  }
  /// What the controller asks for by the state now, in the row that is logged now.
  void ask(std::size_t row) {
    if (!commands_.controller) return;
    std::array<double, kMostJoints> phi{}, dphi{};
    for (int i = 0; i < system_.body.joints; ++i) {
      const SeaState<double> s = system_.joint_state(i, y_);
      const auto joint = std::size_t(system_.body.joint[i].joint);
      phi[joint] = s.phi + of(i).offset, dphi[joint] = s.dphi;
    }
    const std::size_t joints = commands_.joint.size();
    told_.resize(std::max(told_.size(), row + 1));
    told_[row] = {};
    commands_.controller(commands_.t[row], std::span(phi).first(joints), std::span(dphi).first(joints),
                         std::span(told_[row]).first(joints));
  }
  void read_row(std::size_t row) {
    row -= std::min(row, std::size_t(path_.rows));
    for (int i = 0; i < system_.body.joints; ++i) {
      const auto& columns = commands_.joint[std::size_t(system_.body.joint[i].joint)];
      const auto at = [&](CommandColumn what, double otherwise) {
        return columns[what].empty() ? otherwise : columns[what][row];
      };
      const auto& sea = system_.drive[i].sea;
      const bool referred = !columns[kPhiRef].empty() || !columns[kDphiRef].empty();
      now_[std::size_t(i)] = {at(kKp, columns[kPhiRef].empty() ? 0 : sea.k_p),
                              at(kKd, referred ? sea.k_d : 0),
                              at(kPhiRef, 0),
                              at(kDphiRef, 0),
                              at(kTorqueFf, 0),
                              at(kOn, 1)};
      if (row < told_.size()) now_[std::size_t(i)].ff += told_[row][std::size_t(system_.body.joint[i].joint)];
    }
  }
  double asked(int i, const SeaState<double>& s) const {
    const Now& c = now_[std::size_t(i)];
    const bool motor =
        system_.drive[i].kind == DriveKind::kElastic && system_.drive[i].sea.feedback == Feedback::kMotor;
    const double phi = (motor ? s.phi_m : s.phi) + of(i).offset, dphi = motor ? s.dphi_m : s.dphi;
    return c.on * std::clamp(c.k_p * (c.phi_ref - phi) + c.k_d * (c.dphi_ref - dphi) + c.ff, of(i).torque_low,
                             of(i).torque_high);
  }
  /// The same as late as the drive is; in `dy` the rates of what is on its way.
  double given(int i, const SeaState<double>& s, const State& y, [[maybe_unused]] State* dy = nullptr) const {
    if constexpr (kSize.late)
      if (system_.drive[i].kind == DriveKind::kElastic) {
        const DriveLag<double> lag(system_.drive[i].sea);
        const auto x = y.template segment<System::kLags>(System::kLag + System::kLags * i);
        const double ask = asked(i, lag.seen(s, x));
        if (dy) dy->template segment<System::kLags>(System::kLag + System::kLags * i) = lag.derivative(ask, s, x);
        return lag.torque(ask, x);
      }
    return asked(i, s);
  }
  /// Sets drives that are late as if what is asked for at the start had been for ever.
  void settle_lags() {
    if constexpr (kSize.late)
      for (int i = 0; i < system_.body.joints; ++i) {
        const SeaState<double> s = system_.joint_state(i, y_);
        y_.template segment<System::kLags>(System::kLag + System::kLags * i) =
            DriveLag<double>(system_.drive[i].sea).steady(asked(i, s), s);
      }
  }
  /// What turns joint i in the state y; in `dy` the rates of what is on its way.
  auto torque_of(const State& y, State* dy) {
    return [this, &y, dy](int i, double* motor) {
      const SeaState<double> s = system_.joint_state(i, y);
      if (system_.drive[i].kind == DriveKind::kElastic) {
        const auto& sea = system_.drive[i].sea;
        const double spring = spring_torque<System::kSea>(sea, s);
        system_.joint[i].saturation = spring > sea.tau_max ? 1 : spring < -sea.tau_max ? -1 : 0;
      }
      return system_.joint_torque(i, s, motor, [&] { return of(i).torque_gain * given(i, s, y, dy); });
    };
  }
  auto push(double t) const {
    return [this, after = t - pushed_from_](auto& load, const auto& pose) {
      for (const Pushed& p : pushed_)
        load.add(p.at, pose, system_.body.bodies, value(p.force[0], after), value(p.force[1], after));
    };
  }
  State derivative(double t, const State& y) {
    State dy;
    if constexpr (kSize.late) dy.template segment<System::kWork - System::kLag>(System::kLag).setZero();
    system_.derivative_under(y, dy, torque_of(y, &dy), push(t));
    return dy;
  }
  auto holds(double t, const State& y) {
    const auto driving = [&](int i, const SeaState<double>& s) { return of(i).torque_gain * given(i, s, y); };
    return system_.holds_under(y, torque_of(y, nullptr), driving, push(t));
  }
  /// What friction no longer holds slips.
  void hold_or_slip() {
    system_.hold_or_slip_by([this](const State& y) { return holds(t_, y); }, y_);
  }
  /// y after h, from y_ with its derivative there.
  State after(const State& dy, double h) {
    const double middle = t_ + 0.5 * h;
    const State b = derivative(middle, y_ + 0.5 * h * dy), c = derivative(middle, y_ + 0.5 * h * b),
                d = derivative(t_ + h, y_ + h * c);
    return y_ + h / 6 * (dy + 2 * b + 2 * c + d);
  }
  using Guards = integrate::Guards<System::kGuards, double>;
  /// The derivative and the guards where a step starts.
  struct Here {
    State dy;
    Guards guard;
  };
  Here here(double t, const State& y) {
    Here out;
    out.dy = derivative(t, y);
    const auto pose = system_.pose(y);
    const auto acc = system_.accelerations_of(out.dy);
    system_.contact_guards(pose, acc, y, out.dy, out.guard);
    if (!system_.rubs) return out;
    typename System::PlaceHolds hold;
    if (system_.some_stuck()) hold = holds(t, y);
    system_.guard_places(System::kFrictionGuards, y, out.dy, hold, hold, out.guard);
    return out;
  }
  /// n steps; where the mode of a contact or of dry friction ends within one, it goes on from there in the next mode.
  void steps(double h, long n, DrivenRollout& out) {
    if (!pushes() && !system_.rubs) {
      for (long k = 0; k < n; ++k) y_ = after(derivative(t_, y_), h), t_ += h;
      return;
    }
    Here from = here(t_, y_);
    for (long k = 0; k < n; ++k) step(h, from, out);
  }
  void step(double h, Here& from, DrivenRollout& out) {
    constexpr int kMostParts = 24;  // beyond: what chatters keeps its mode to the step's end
    const int guards = system_.guards_used();
    for (int part = 0;; ++part) {
      const State end = after(from.dy, h);
      Here there = here(t_ + h, end);
      int first = -1;
      double at = 1;
      for (int g = 0; g < guards && part < kMostParts; ++g) {
        const auto value = [&](const Here& of) { return of.guard.value[std::size_t(g)]; };
        if (value(there) >= 0) continue;
        const auto within = [&](double x) { return value(here(t_ + x * h, after(from.dy, x * h))); };
        const double place = value(from) > 0 ? integrate::root(0, value(from), 1, value(there), within) : 0;
        if (first < 0 || place < at) first = g, at = place;
      }
      if (first < 0) return y_ = end, t_ += h, void(from = std::move(there));
      y_ = after(from.dy, at * h), t_ += at * h, h *= 1 - at;
      cross(first, &out), hold_or_slip();
      from = here(t_, y_);
      if (h <= 0) return;
    }
  }
  /// Beyond guard g, into the next mode.
  void cross(int g, DrivenRollout* out) {
    (void)system_.cross(g, y_);
    if (g >= System::kJointGuards) return;
    const int contact = g / System::kOfContact;
    if (out && g % System::kOfContact == System::kSurface && !system_.is_stop(contact))
      out->changes.push_back({t_, contact, system_.contact[std::size_t(contact)].touching});
  }
  System system_;
  const CommandPath& path_;
  const Commands& commands_;
  struct Pushed {
    Arms<double, System::kB> at;
    std::array<Sensor, 2> sensor = {};
    std::array<std::optional<ForceCurve>, 2> curve = {};  ///< as logged; none: no force
    std::array<Cubic, 2> force = {};                      ///< from pushed_from_ on
  };
  Arms<double, System::kB> peak_axis_;  ///< a metre along the link of the point that counts
  std::vector<Pushed> pushed_;
  std::vector<double> push_edges_;           ///< where any force's piece begins, by the log's clock [s]
  double pushed_from_ = 0, time_shift_ = 0;  ///< [s]
  std::vector<Now> now_;
  State y_;
  double t_ = 0;
  /// Of the commands: whose is the next, at which the controller is asked next; and how many edges have passed.
  std::size_t row_ = 0, asked_ = 0, pushes_ = 0;
  std::vector<std::array<double, kMostJoints>> told_;  ///< by the controller, row by row [Nm]
};

}  // namespace

template <Capacity kSize>
double stable_in_kernel(const Robot& robot, const CommandPath& path, const Commands& commands,
                        const DrivenStart& start) {
  DrivenRun<kSize> run(robot, path, commands);
  run.start(start, commands.t.front());
  return run.stable();
}

template <Capacity kSize>
DrivenRollout roll_in_kernel(const Robot& robot, const CommandPath& path, const Commands& commands,
                             const DrivenStart& start, const std::vector<double>& times, const DrivenOptions& options) {
  DrivenRollout out;
  out.joint.resize(robot.joints.size());
  if (options.loads) out.force.resize(robot.contacts.size());
  DrivenRun<kSize> run(robot, path, commands, options.sensors);
  run.start(start, times.front(), &out);
  for (const double t : times) {
    if (!run.advance(t, options, out)) return out;
    run.sample(out);
    if (options.loads) run.sample_loads(out);
  }
  out.complete = true;
  return out;
}

template double stable_in_kernel<UKEMI_KERNEL>(const Robot&, const CommandPath&, const Commands&, const DrivenStart&);
template DrivenRollout roll_in_kernel<UKEMI_KERNEL>(const Robot&, const CommandPath&, const Commands&,
                                                    const DrivenStart&, const std::vector<double>&,
                                                    const DrivenOptions&);

}  // namespace ukemi::landing
