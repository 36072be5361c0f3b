#include "landing/simulate.hpp"

#include <cmath>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/rest.hpp"

namespace ukemi::landing {

const char* name(End end) {
  switch (end) {
    case End::kRest:
      return "rest";
    case End::kTimeLimit:
      return "t_end";
    case End::kAbandoned:
      return "abandoned";
    case End::kFailed:
      return "failed";
  }
  return "?";
}

void SimulateOptions::validate() const {
  if (!(accuracy >= 1e-14 && accuracy <= 1e-2))
    throw InputError("accuracy: " + shortest(accuracy) + ": a relative tolerance from 1e-14 to 1e-2 is needed");
  if (max_steps < 1) throw InputError("max_steps: " + std::to_string(max_steps) + ": at least 1 is needed");
}

namespace {

using Method = integrate::DormandPrince853;

/// Keeps the largest |ddr_0|^2 of what it is shown.
class PeakTracker {
 public:
  double square = 0, t = 0;

  void consider(double q, double time) {
    if (q > square) square = q, t = time;
  }
  void reset() { square = 0; }

  template <class System>
  static double at_state(const System& system, const typename System::State& y, const typename System::State& dy) {
    const auto p = system.pose(y);
    return thigh_acceleration(system.link, p, {dy[kVx], dy[kVy], dy[kOmega0], dy[kOmega1]}).squaredNorm();
  }

  /// Both ends of the step (their limits from inside it) and its interior where that could hold a larger value.
  template <class System, class Integrator>
  void step(const System& system, Integrator& integrator) {
    const auto& step = integrator.step();
    const double q0 = at_state(system, step.y, step.slope()), q1 = at_state(system, step.y_end, step.slope_end());
    consider(q0, step.t);
    consider(q1, step.t + step.h);
    if (kDoubles * kDoubles * std::max(q0, q1) < square || step.h <= 0) return;
    const auto f = [&](double s) {
      const auto y = integrator.dense().at(s);
      const double time = step.t + s * step.h;
      const double q = at_state(system, y, system.derivative(time, y));
      consider(q, time);
      return q;
    };
    std::array<Node, 6> node{{{0, q0}, {0.125, 0}, {0.25, 0}, {0.5, 0}, {0.75, 0}, {1, q1}}};
    for (int i = 1; i < 5; ++i) node[i].q = f(node[i].s);
    for (int i = 0; i + 2 < 6; ++i) {
      const double top = vertex(node[i], node[i + 1], node[i + 2]);
      if (top > node[i].s && top < node[i + 2].s &&
          std::max({node[i].q, node[i + 1].q, node[i + 2].q}) > kNear * square)
        polish(node[i], node[i + 1], node[i + 2], f);
    }
  }

 private:
  static constexpr double kDoubles = 4;  ///< a resolved step that holds a new peak ends above a quarter of the old one
  static constexpr double kNear = 0.9;   ///< and its nodes come this near, as squares

  struct Node {
    double s, q;
  };
  /// Where the parabola through three nodes has its top; NaN or outside where it has none.
  static double vertex(const Node& a, const Node& b, const Node& c) {
    const double u = (b.q - a.q) / (b.s - a.s), v = (c.q - b.q) / (c.s - b.s), bend = (v - u) / (c.s - a.s);
    return bend < 0 ? 0.5 * (a.s + b.s - u / bend) : -1;
  }
  /// Successive parabolas: the value at the top is exact to the square of the last move.
  template <class F>
  static void polish(Node a, Node b, Node c, F&& f) {
    for (int i = 0; i < 8; ++i) {
      const double s = vertex(a, b, c);
      if (!(s > a.s && s < c.s) || std::abs(s - b.s) < 1e-6) return;
      const Node n{s, f(s)};
      if (std::abs(n.q - b.q) < 1e-13 * b.q) return;
      if (s < b.s) {
        if (n.q > b.q)
          c = b, b = n;
        else
          a = n;
      } else {
        if (n.q > b.q)
          a = b, b = n;
        else
          c = n;
      }
    }
  }
};

/// Collects touches, peaks, demands, work and the trajectory; the fast path has none of it.
template <class System>
class Recorder {
 public:
  Recorder(Landing& out, double rate) : out_(out), rate_(rate) {}

  void start(const System& system, double t, const typename System::State& y) {
    energy_start_ = system.link_energy(y), motor_start_ = system.motor_energy(y);
    turned_ = kinetic_energy(system.link, system.pose(y));
    work_.setZero();
    out_.demands.phi_min = out_.demands.phi_max = y[kTheta1] - y[kTheta0];
    interval_.t = t;
  }

  void row(const System& system, double t, const typename System::State& y) {
    if (rate_ > 0) out_.trajectory.push_back(sample(system, t, y));
  }

  /// Rows before `until` of a ballistic flight from release, in closed form; the integrated run starts where it ends.
  void ballistic(const System& system, const Drop& drop, typename System::State y, double until) {
    const double y0 = y[kY], x0 = y[kX], vx = y[kVx];
    for (; rate_ > 0 && next_row() < until; ++rows_) {
      const double t = next_row();
      y[kX] = x0 + vx * t, y[kY] = y0 - 0.5 * system.link.gravity * t * t;
      y[kVy] = -system.link.gravity * t;
      row(system, t, y);
    }
    turned_ += system.link.total_mass * system.link.gravity * drop.height;
    interval_.consider(system.link.gravity * system.link.gravity, 0);
  }

  template <class Integrator>
  void step(const System& system, Integrator& integrator) {
    interval_.step(system, integrator);
    const auto& step = integrator.step();
    for (const double s : {0.0, 0.25, 0.5, 0.75, 1.0})
      observe(system.evaluate(step.t + s * step.h, integrator.dense().at(s)), system);
    for (; rate_ > 0 && next_row() <= step.t + step.h; ++rows_)
      if (next_row() >= step.t)
        row(system, next_row(), integrator.dense().at(step.h > 0 ? (next_row() - step.t) / step.h : 0));
    for (int i = kWorkJoint; i < kWithAccounts; ++i) turned_ += std::abs(step.y_end[i] - work_[i - kWorkJoint]);
    work_ = step.y_end.template tail<3>();
    const double links =
        system.link_energy(step.y_end) - energy_start_ - step.y_end[kWorkJoint] - step.y_end[kWorkFloor];
    const double motor = system.motor_energy(step.y_end) - motor_start_ - step.y_end[kWorkMotor];
    mismatch_ = std::max({mismatch_, std::abs(links), std::abs(motor)});
  }

  void touchdown(Point point, double t) {
    bool chatter = false;
    for (auto it = out_.touches.rbegin(); it != out_.touches.rend(); ++it)
      if (it->point == point) {
        chatter = t - it->t_liftoff < kChatter;
        break;
      }
    if (!out_.touches.empty()) close_touch();
    out_.touches.push_back({point, t, std::numeric_limits<double>::quiet_NaN()});
    open_[point] = int(out_.touches.size()) - 1;
    if (!chatter) close_interval(point);
  }
  void liftoff(Point point, double t) {
    if (open_[point] >= 0) out_.touches[open_[point]].t_liftoff = t;
    open_[point] = -1;
  }

  void finish() {
    if (!out_.touches.empty()) close_touch();
    close_interval(-1);
    out_.energy_residual = turned_ > 0 ? mismatch_ / turned_ : 0;
  }

 private:
  Landing& out_;
  double rate_;
  long rows_ = 0;
  double energy_start_ = 0, motor_start_ = 0, turned_ = 0, mismatch_ = 0;
  Eigen::Vector3d work_;
  std::array<int, kPoints> open_{-1, -1, -1};
  PeakTracker interval_;
  double since_touch_ = 0;
  int interval_point_ = -1;

  double next_row() const { return double(rows_) / rate_; }

  void close_touch() { out_.touches.back().peak_acc = std::sqrt(std::max(since_touch_, interval_.square)); }
  void close_interval(int next) {
    if (interval_.square > 0) out_.peaks.push_back({interval_.t, std::sqrt(interval_.square), interval_point_});
    interval_.reset();
    interval_point_ = next;
  }

  void observe(const typename System::Field& f, const System& system) {
    for (int j = 0; j < kPoints; ++j)
      if (open_[j] >= 0) {
        double& peak = out_.touches[open_[j]].peak_force;
        peak = std::max(peak, f.force[j].norm());
      }
    Demands& d = out_.demands;
    d.motor_speed = std::max(d.motor_speed, std::abs(f.sea.dphi_m));
    d.motor_torque = std::max(d.motor_torque, std::abs(system.motor_torque_of(f)));
    d.sea_torque = std::max(d.sea_torque, std::abs(f.tau_sea));
    d.phi_min = std::min(d.phi_min, f.sea.phi), d.phi_max = std::max(d.phi_max, f.sea.phi);
  }

  static Sample sample(const System& system, double t, const typename System::State& y) {
    const auto f = system.evaluate(t, y);
    const Vec2<double> r = thigh_position(system.link, f.pose), v = thigh_velocity(system.link, f.pose),
                       a = thigh_acceleration(system.link, f.pose, f.acc);
    return {t,          r.x(),      r.y(), y[kTheta0], f.sea.phi, f.sea.phi_m, v.x(),           v.y(),  y[kOmega0],
            f.sea.dphi, y[kOmegaM], a.x(), a.y(),      a.norm(),  f.tau_sea,   f.reference.phi, f.force};
  }
};

/// State at release, x_0 = 0, the lowest contact point at the drop's height.
template <class System>
typename System::State released(const System& system, const Scene& scene, const Motion& motion) {
  typename System::State y = System::State::Zero();
  y[kTheta0] = scene.drop.pitch, y[kTheta1] = scene.drop.pitch + motion.phi_i, y[kPhiM] = motion.phi_i;
  y[kVx] = scene.drop.forward_speed;
  y[kOmega0] = y[kOmega1] = scene.drop.pitch_rate;
  const Pose<double> p = system.pose(y);
  const double k = system.link.k1 * system.link.a;
  y[kX] = k * (p.s0 + p.s1);  // r_0 = (0, .)
  y[kVx] += k * (p.omega0 * p.c0 + p.omega1 * p.c1);
  y[kVy] = k * (p.omega0 * p.s0 + p.omega1 * p.s1);
  double lowest = std::numeric_limits<double>::infinity();
  for (int j = 0; j < kPoints; ++j)
    if (scene.contacts[j] || !scene.touches()) lowest = std::min(lowest, height(system.link, p, j));
  y[kY] = scene.drop.height - lowest;
  return y;
}

template <SeaTerms kTerms, bool kReport>
void run(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion, const SimulateOptions& options,
         LandingPeak& out, Landing* landing, double rate) {
  using System = LandingSystem<kTerms, kReport>;
  System system(scene, sea, motion);
  Recorder<System> recorder(*landing, rate);
  typename System::State y = released(system, scene, motion);
  const double g = system.link.gravity;
  double t = 0, limit = scene.t_end.value_or(Scene::kFollow);
  PeakTracker peak;
  if constexpr (kReport) recorder.start(system, t, y);

  // 1) With no pitch rate nothing moves relative to anything else: ballistic, in closed form, peak g.
  const bool ballistic = scene.drop.pitch_rate == 0;
  if (ballistic) {
    const bool lands = scene.touches() && (g > 0 || scene.drop.height == 0);
    const double fall =
        lands ? std::sqrt(g > 0 ? 2 * scene.drop.height / g : 0) : std::numeric_limits<double>::infinity();
    t = std::min(fall, limit);
    peak.consider(g * g, 0);
    if constexpr (kReport) recorder.ballistic(system, scene.drop, y, t);
    y[kX] += y[kVx] * t, y[kVy] = -g * t;
    y[kY] = lands && t == fall ? y[kY] - scene.drop.height : y[kY] - 0.5 * g * t * t;
    if (t < fall) {
      if constexpr (kReport) recorder.row(system, t, y), recorder.finish();
      out.t_end = t, out.end = End::kTimeLimit, out.peak = g, out.t_peak = 0;
      return;
    }
  }

  // 2), 3) From event to event.
  integrate::Integrator<Method, System> integrator(
      system, t, y, {.accuracy = options.accuracy, .first_step = ballistic ? 1e-3 : 1e-2, .max_step = 0.1});
  double motion_end = std::numeric_limits<double>::infinity();
  bool touched = false;
  for (long n = 0;; ++n) {
    const integrate::Outcome outcome = integrator.step(std::min(limit, motion_end));
    t = integrator.time();
    out.status = outcome.status;
    if (outcome.status > integrate::Status::kEvent || n >= options.max_steps) {
      out.end = End::kFailed;
      break;
    }
    if (!outcome.immediate && integrator.step().h > 0) {
      peak.step(system, integrator);
      if constexpr (kReport) recorder.step(system, integrator);
    }
    if (peak.square > options.abandon_above * options.abandon_above) {
      out.end = End::kAbandoned;
      break;
    }
    if (outcome.event >= 0) {
      if constexpr (kReport) recorder.row(system, t, integrator.state());
      const bool touchdown = outcome.event < kPoints && system.contact[outcome.event] == Contact::kClear;
      if (touchdown && !touched) {
        touched = true;
        system.motion_start = t;
        const bool moves = motion.phi_i != motion.phi_f;
        system.phase = moves ? Phase::kMoving : Phase::kAfter;
        if (moves) motion_end = t + motion.duration;
        if (!scene.t_end) limit = t + Scene::kFollow;
      }
      system.cross(outcome.event);
      integrator.refresh();
      if constexpr (kReport) {
        if (touchdown)
          recorder.touchdown(Point(outcome.event), t);
        else if (outcome.event < kPoints)
          recorder.liftoff(Point(outcome.event), t);
        recorder.row(system, t, integrator.state());
      }
      continue;
    }
    if (outcome.status == integrate::Status::kReached) {
      if (t >= motion_end - 1e-14) {
        system.phase = Phase::kAfter;
        motion_end = std::numeric_limits<double>::infinity();
      }
      if (t >= limit - 1e-14) {
        out.end = End::kTimeLimit;
        break;
      }
    }
    if (options.rest == SimulateOptions::Rest::kStop &&
        at_rest(system, t, integrator.state(), integrator.slope(), std::sqrt(peak.square))) {
      out.end = End::kRest;
      break;
    }
  }
  if constexpr (kReport) recorder.finish();
  out.t_end = t;
  out.peak = std::sqrt(peak.square), out.t_peak = peak.t;
  out.work = integrator.counters();
}

template <bool kReport>
void dispatch(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
              const SimulateOptions& options, LandingPeak& out, Landing* landing, double rate) {
  const bool limited = std::isfinite(sea.tau_max), extended = is_extended(sea);
  const auto with = [&]<SeaTerms kTerms>() { run<kTerms, kReport>(scene, sea, motion, options, out, landing, rate); };
  if (extended)
    limited ? with.template operator()<SeaTerms{true, true}>() : with.template operator()<SeaTerms{false, true}>();
  else
    limited ? with.template operator()<SeaTerms{true, false}>() : with.template operator()<SeaTerms{false, false}>();
}

}  // namespace

LandingPeak peak_acceleration(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                              const SimulateOptions& options) {
  LandingPeak out;
  static thread_local Landing unused;
  dispatch<false>(scene, sea, motion, options, out, &unused, 0);
  return out;
}

Landing simulate(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                 const SimulateOptions& options, double rate) {
  Landing out;
  dispatch<true>(scene, sea, motion, options, out, &out, rate);
  return out;
}

}  // namespace ukemi::landing
