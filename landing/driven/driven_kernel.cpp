// Compiled once for each kernel, UKEMI_KERNEL (see CMakeLists.txt).
#include "landing/driven/driven_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "common/force_curve.hpp"
#include "landing/body/body_system.hpp"
#include "landing/body/load_value.hpp"

namespace ukemi::landing {

namespace {

constexpr double kDiverged = 1e4;  ///< a state beyond this, in SI units, has diverged

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
        active_(std::size_t(system_.body.joints)) {
    if (robot.base == Base::kPinned) system_.base[1] = robot.pin_height;
    const std::vector<MeasuredColumn> columns = push_columns(robot);
    for (std::size_t i = 0; i < commands.push.size(); ++i) {
      const PushPoint& p = robot.pushes[i];
      push_states_.push_back({.at = shifted(system_.body, system_.body.origin[std::size_t(p.link)], p.link, p.at)});
      PushState& to = push_states_.back();
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
      const TreeJoint& at = system_.body.joint[i];
      const JointStart& s = from.joint[std::size_t(at.joint)];
      const bool ground = at.parent < 0;
      const double phi = s.phi - path_of(i).offset;
      y_[System::kTheta + at.child] = phi - at.offset + (ground ? 0 : y_[System::kTheta + at.parent]);
      y_[System::kOmega + at.child] = s.dphi + (ground ? 0 : y_[System::kOmega + at.parent]);
      if (system_.drive[i].kind == DriveKind::kElastic)
        y_[System::kPhiM + i] = phi + s.spring, y_[System::kOmegaM + i] = s.dphi;
    }
    if (system_.body.base != Base::kPinned) place_base(from);
    for (int i = 0; i < system_.body.contacts; ++i)
      if (gap(i) < 0) cross(System::kGuardsPerContact * i + System::kSurface, out);
    for (int i = system_.body.stops_begin; i < system_.body.stops_end; ++i)
      if (system_.stop_at(i, system_.pose(y_), y_).y < 0) cross(System::kGuardsPerContact * i + System::kSurface, out);
    const auto until = [](const std::vector<double>& times, double time) {
      return std::size_t(std::upper_bound(times.begin(), times.end(), time) - times.begin());
    };
    next_row_ = until(commands_.t, t - path_.delay);
    next_controller_row_ = next_row_ > 0 ? next_row_ - 1 : 0;
    run_controller(next_controller_row_++);
    set_push_pieces(passed_push_edges_ = until(push_edges_, t - time_shift_));
    read_row(next_row_ > 0 ? next_row_ - 1 : 0);
    system_.settle_lags(y_, [this](int i, const SeaState<double>& s) { return requested_torque(i, s); });
    system_.settle_with([this](const State& y) { return holds(t_, y); }, y_);
  }
  /// Advances to `until`; steps end at the edges of commands, and each part takes as many as the whole interval would.
  bool advance(double until, const DrivenOptions& options, DrivenRollout& out) {
    const long n = long(std::ceil((until - t_) / options.step - 1e-9));
    while (true) {
      constexpr double kNever = std::numeric_limits<double>::infinity();
      const auto time_of = [](const std::vector<double>& t, std::size_t row) {
        return row < t.size() ? t[row] : kNever;
      };
      const double edge = time_of(commands_.t, next_row_) + path_.delay;
      const double controller_time = commands_.controller ? time_of(commands_.t, next_controller_row_) : kNever;
      const double push_time = time_of(push_edges_, passed_push_edges_) + time_shift_;
      const double to = std::min({until, edge, controller_time, push_time});
      if (const double length = to - t_; length > 0) {
        if ((out.steps += n) > options.max_steps) return false;
        steps(length / double(n), n, out);
        t_ = to;
      }
      if (to >= until) break;
      if (push_time <= to)
        set_push_pieces(++passed_push_edges_);
      else if (controller_time <= to)
        run_controller(next_controller_row_++);
      else
        read_row(next_row_++);
      hold_or_slip();
    }
    return y_.array().isFinite().all() && y_.cwiseAbs().maxCoeff() < kDiverged;
  }
  void sample(DrivenRollout& out) const {
    for (int i = 0; i < system_.body.joints; ++i) {
      auto& to = out.joint[std::size_t(system_.body.joint[i].joint)];
      const SeaState<double> s = system_.joint_state(i, y_);
      to[kAngle].push_back(s.phi + path_of(i).offset), to[kRate].push_back(s.dphi);
      to[kTorque].push_back(delayed_torque(i, s, y_));
    }
    if (system_.body.base != Base::kFree) return;
    const Vec2<double> origin = position(system_.body.first, system_.pose(y_), system_.body.bodies);
    const double base[kBaseSignals] = {origin.x(), origin.y(), y_[System::kTheta] + system_.body.offset[0],
                                       y_[System::kOmega]};
    for (int q = 0; q < kBaseSignals; ++q) out.base[std::size_t(q)].push_back(base[q]);
  }
  void sample_loads(DrivenRollout& out) {
    const auto pose = system_.pose(y_);
    const auto a =
        acceleration(system_.body.peak, pose, system_.accelerations_of(derivative(t_, y_)), system_.body.bodies);
    const Vec2<double> along = position(peak_axis_, pose, system_.body.bodies) - Vec2<double>(pose.x, pose.y);
    const Vec2<double> across(-along.y(), along.x()), specific = a - Vec2<double>(system_.gravity.data());
    const double parts[kAccelerationSignals] = {a.norm(), a.x(), a.y(), specific.dot(along), specific.dot(across)};
    for (int q = 0; q < kAccelerationSignals; ++q) out.acceleration[std::size_t(q)].push_back(parts[q]);
    for (int i = 0; i < system_.body.contacts; ++i) {
      const Vec2<double> f = contact_force(system_, i, pose, y_);
      for (int q : {0, 1}) out.force[std::size_t(i)][std::size_t(q)].push_back(f[q]);
    }
  }
  /// See stable_step.
  double stable_step() const {
    double fastest = 1, stribeck = 0, lag = 0;  // [1/s]
    for (int i = 0; i < system_.body.joints; ++i) {
      const JointConstants<double>& d = system_.drive[i];
      State still = State::Zero(), dy;
      for (int j = 0; j < system_.body.bodies; ++j) still[System::kTheta + j] = y_[System::kTheta + j];
      std::array<double, 2> acc{};
      for (const double torque : {0.0, 1.0}) {
        StickConstraints<double, kSize> no_constraints;
        system_.derivative_under(
            still, dy, [&](int k, double*) { return k == i ? torque : 0.0; }, {}, &no_constraints);
        const TreeJoint& at = system_.body.joint[i];
        acc[torque > 0] = dy[System::kOmega + at.child] - (at.parent < 0 ? 0 : dy[System::kOmega + at.parent]);
      }
      double inverse = acc[1] - acc[0], dry = d.sea.friction, viscous = d.sea.viscous + d.damping;
      double stiff = d.stiffness + d.parallel_stiffness;
      if (d.kind == DriveKind::kElastic) {
        inverse += 1 / d.sea.i_motor, dry += d.sea.output_friction, viscous += d.sea.output_viscous + d.sea.c_sea;
        stiff += d.sea.k_sea;
        if constexpr (kSize.late) lag = std::max(lag, DriveLag<double>(d.sea).fastest_pole());
      }
      const auto& columns = commands_.joint[std::size_t(system_.body.joint[i].joint)];
      const auto largest = [&](CommandColumn column, double absent) {
        return columns[column].empty() ? absent : *std::max_element(columns[column].begin(), columns[column].end());
      };
      viscous += path_of(i).torque_gain * largest(kKd, d.sea.k_d),
          stiff += path_of(i).torque_gain * largest(kKp, d.sea.k_p);
      fastest = std::max({fastest, inverse * viscous, std::sqrt(inverse * stiff)});
      if (d.sea.breakaway > 0) stribeck = std::max(stribeck, inverse * dry * d.sea.breakaway / d.sea.stribeck_speed);
    }
    if (system_.body.base == Base::kRail) fastest = std::max(fastest, system_.rail_viscous / system_.body.mass);
    // rate * step: the method is stable up to 2.78 and accurate up to kAccurate; others [s].
    constexpr double kStable = 2, kAccurate = 0.2, kLongest = 1e-3, kInContact = 2e-4;
    const double longest = has_contacts() ? kInContact : kLongest;
    return std::min({longest, kAccurate / fastest, kStable / std::max(lag, stribeck)});
  }

 private:
  double gap(int i) const { return system_.point_at(i, system_.pose(y_)).y - system_.point[i].thickness; }
  bool has_contacts() const { return system_.body.contacts > 0 || system_.has_stops(); }
  int lowest_contact() const {
    int out = -1;
    for (int i = 0; i < system_.body.contacts; ++i)
      if (out < 0 || gap(i) < gap(out)) out = i;
    return out;
  }
  /// Places the base, which is at 0 and at rest; that of a free robot is its centre of mass.
  void place_base(const DrivenStart& from) {
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
  /// The command in force for a drive.
  struct ActiveCommand {
    double k_p = 0, k_d = 0, phi_ref = 0, dphi_ref = 0, ff = 0, on = 1;
  };
  const CommandPath::Joint& path_of(int i) const { return path_.joints[std::size_t(system_.body.joint[i].joint)]; }

  /// Sets the forces' polynomials after the first `edges` edges of their pieces.
  void set_push_pieces(std::size_t edges) {
    if (push_edges_.empty()) return;
    constexpr double kBefore = -std::numeric_limits<double>::infinity();
    push_piece_begin_ = push_edges_[edges > 0 ? edges - 1 : 0] + time_shift_;
    for (PushState& p : push_states_)
      for (const std::size_t q : {0, 1}) {
        if (!p.curve[q]) continue;
        const Sensor& sensor = p.sensor[q];
        p.force[q] = p.curve[q]->from(edges > 0 ? push_edges_[edges - 1] : kBefore);
        p.force[q][0] = sensor.actual(p.force[q][0]);
        for (const std::size_t power : {1, 2, 3}) p.force[q][power] /= sensor.gain;
      }
  }
  /// Calls the controller with the present state, for the row that is logged now.
  void run_controller(std::size_t row) {
    if (!commands_.controller) return;
    std::array<double, kMaxJoints> phi{}, dphi{};
    for (int i = 0; i < system_.body.joints; ++i) {
      const SeaState<double> s = system_.joint_state(i, y_);
      const auto joint = std::size_t(system_.body.joint[i].joint);
      phi[joint] = s.phi + path_of(i).offset, dphi[joint] = s.dphi;
    }
    const std::size_t joints = commands_.joint.size();
    controller_torques_.resize(std::max(controller_torques_.size(), row + 1));
    controller_torques_[row] = {};
    commands_.controller(commands_.t[row], std::span(phi).first(joints), std::span(dphi).first(joints),
                         std::span(controller_torques_[row]).first(joints));
  }
  void read_row(std::size_t row) {
    row -= std::min(row, std::size_t(path_.rows));
    for (int i = 0; i < system_.body.joints; ++i) {
      const auto& columns = commands_.joint[std::size_t(system_.body.joint[i].joint)];
      const auto at = [&](CommandColumn column, double absent) {
        return columns[column].empty() ? absent : columns[column][row];
      };
      const auto& sea = system_.drive[i].sea;
      const bool referred = !columns[kPhiRef].empty() || !columns[kDphiRef].empty();
      active_[std::size_t(i)] = {at(kKp, columns[kPhiRef].empty() ? 0 : sea.k_p),
                                 at(kKd, referred ? sea.k_d : 0),
                                 at(kPhiRef, 0),
                                 at(kDphiRef, 0),
                                 at(kTorqueFf, 0),
                                 at(kOn, 1)};
      if (row < controller_torques_.size())
        active_[std::size_t(i)].ff += controller_torques_[row][std::size_t(system_.body.joint[i].joint)];
    }
  }
  double requested_torque(int i, const SeaState<double>& s) const {
    const ActiveCommand& c = active_[std::size_t(i)];
    const bool motor =
        system_.drive[i].kind == DriveKind::kElastic && system_.drive[i].sea.feedback == Feedback::kMotor;
    const double phi = (motor ? s.phi_m : s.phi) + path_of(i).offset, dphi = motor ? s.dphi_m : s.dphi;
    return c.on * std::clamp(c.k_p * (c.phi_ref - phi) + c.k_d * (c.dphi_ref - dphi) + c.ff, path_of(i).torque_low,
                             path_of(i).torque_high);
  }
  /// The requested torque after the lag of a late drive; in `dy` the rates of the lag.
  double delayed_torque(int i, const SeaState<double>& s, const State& y, [[maybe_unused]] State* dy = nullptr) const {
    if constexpr (kSize.late)
      if (system_.drive[i].kind == DriveKind::kElastic) {
        const DriveLag<double> lag(system_.drive[i].sea);
        const auto x = y.template segment<System::kLags>(System::kLag + System::kLags * i);
        const double requested = requested_torque(i, lag.filtered(s, x));
        if (dy) dy->template segment<System::kLags>(System::kLag + System::kLags * i) = lag.derivative(requested, s, x);
        return lag.torque(requested, x);
      }
    return requested_torque(i, s);
  }
  /// The torque of joint i in the state y, as torque_of for derivative_under; in `dy` the rates of lags.
  auto torque_of(const State& y, State* dy) {
    return [this, &y, dy](int i, double* motor) {
      const SeaState<double> s = system_.joint_state(i, y);
      if (system_.drive[i].kind == DriveKind::kElastic) {
        const auto& sea = system_.drive[i].sea;
        const double spring = spring_torque<System::kSea>(sea, s);
        system_.joint[i].saturation = spring > sea.tau_max ? 1 : spring < -sea.tau_max ? -1 : 0;
      }
      return system_.joint_torque(i, s, motor, [&] { return path_of(i).torque_gain * delayed_torque(i, s, y, dy); });
    };
  }
  auto push(double t) const {
    return [this, elapsed = t - push_piece_begin_](auto& load, const auto& pose) {
      for (const PushState& p : push_states_)
        load.add(p.at, pose, system_.body.bodies, value(p.force[0], elapsed), value(p.force[1], elapsed));
    };
  }
  State derivative(double t, const State& y) {
    State dy;
    if constexpr (kSize.late) dy.template segment<System::kWork - System::kLag>(System::kLag).setZero();
    system_.derivative_under(y, dy, torque_of(y, &dy), push(t));
    return dy;
  }
  auto holds(double t, const State& y) {
    const auto motor_torque = [&](int i, const SeaState<double>& s) {
      return path_of(i).torque_gain * delayed_torque(i, s, y);
    };
    return system_.holds_under(y, torque_of(y, nullptr), motor_torque, push(t));
  }
  /// Places that friction no longer holds start to slip.
  void hold_or_slip() {
    system_.hold_or_slip_with([this](const State& y) { return holds(t_, y); }, y_);
  }
  /// y_ after a step of h; dy: its derivative.
  State runge_kutta_step(const State& dy, double h) {
    const double middle = t_ + 0.5 * h;
    const State b = derivative(middle, y_ + 0.5 * h * dy), c = derivative(middle, y_ + 0.5 * h * b),
                d = derivative(t_ + h, y_ + h * c);
    return y_ + h / 6 * (dy + 2 * b + 2 * c + d);
  }
  using Guards = integrate::Guards<System::kGuards, double>;
  /// Derivative and guards at an end of a step.
  struct StepNode {
    State dy;
    Guards guard;
  };
  StepNode evaluate(double t, const State& y) {
    StepNode out;
    out.dy = derivative(t, y);
    const auto pose = system_.pose(y);
    const auto acc = system_.accelerations_of(out.dy);
    system_.contact_guards(pose, acc, y, out.dy, out.guard);
    if (!system_.has_friction) return out;
    typename System::PlaceHolds hold;
    if (system_.any_stuck()) hold = holds(t, y);
    system_.guard_places(System::kFrictionGuards, y, out.dy, hold, hold, out.guard);
    return out;
  }
  /// Takes n steps of h; a step in which a mode ends is continued in the next mode.
  void steps(double h, long n, DrivenRollout& out) {
    if (!has_contacts() && !system_.has_friction) {
      for (long k = 0; k < n; ++k) y_ = runge_kutta_step(derivative(t_, y_), h), t_ += h;
      return;
    }
    StepNode from = evaluate(t_, y_);
    for (long k = 0; k < n; ++k) step(h, from, out);
  }
  void step(double h, StepNode& from, DrivenRollout& out) {
    constexpr int kMaxParts = 24;  // then the mode is kept to the end of the step
    const int guards = system_.guards_used();
    for (int part = 0;; ++part) {
      const State end = runge_kutta_step(from.dy, h);
      StepNode next = evaluate(t_ + h, end);
      int first = -1;
      double at = 1;
      for (int g = 0; g < guards && part < kMaxParts; ++g) {
        const auto value = [&](const StepNode& node) { return node.guard.value[std::size_t(g)]; };
        if (value(next) >= 0) continue;
        const auto within = [&](double x) { return value(evaluate(t_ + x * h, runge_kutta_step(from.dy, x * h))); };
        const double place = value(from) > 0 ? integrate::root(0, value(from), 1, value(next), within) : 0;
        if (first < 0 || place < at) first = g, at = place;
      }
      if (first < 0) return y_ = end, t_ += h, void(from = std::move(next));
      y_ = runge_kutta_step(from.dy, at * h), t_ += at * h, h *= 1 - at;
      cross(first, &out), hold_or_slip();
      from = evaluate(t_, y_);
      if (h <= 0) return;
    }
  }
  /// Changes the mode at guard g.
  void cross(int g, DrivenRollout* out) {
    (void)system_.cross(g, y_);
    if (g >= System::kJointGuards) return;
    const int contact = g / System::kGuardsPerContact;
    if (out && g % System::kGuardsPerContact == System::kSurface && !system_.is_stop(contact))
      out->changes.push_back({t_, contact, system_.contact[std::size_t(contact)].touching});
  }
  System system_;
  const CommandPath& path_;
  const Commands& commands_;
  struct PushState {
    Arms<double, System::kB> at;
    std::array<Sensor, 2> sensor = {};
    std::array<std::optional<ForceCurve>, 2> curve = {};  ///< as logged; absent: no force
    std::array<Cubic, 2> force = {};                      ///< from push_piece_begin_ on
  };
  Arms<double, System::kB> peak_axis_;  ///< 1 m along the link of the peak point
  std::vector<PushState> push_states_;
  std::vector<double> push_edges_;                ///< where pieces of any force begin, log's clock [s]
  double push_piece_begin_ = 0, time_shift_ = 0;  ///< [s]
  std::vector<ActiveCommand> active_;
  State y_;
  double t_ = 0;
  /// Next row of commands; next row of the controller; number of push edges passed.
  std::size_t next_row_ = 0, next_controller_row_ = 0, passed_push_edges_ = 0;
  std::vector<std::array<double, kMaxJoints>> controller_torques_;  ///< of each row [Nm]
};

}  // namespace

template <Capacity kSize>
double stable_in_kernel(const Robot& robot, const CommandPath& path, const Commands& commands,
                        const DrivenStart& start) {
  DrivenRun<kSize> run(robot, path, commands);
  run.start(start, commands.t.front());
  return run.stable_step();
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
