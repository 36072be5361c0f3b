// One landing of a robot of links in scalars with P derivatives. Private to body_gradient.cpp.
#pragma once

#include <cmath>
#include <span>

#include "common/actuator.hpp"
#include "common/actuator_constants.hpp"
#include "common/integrate/tableaus.hpp"
#include "landing/body/body_course.hpp"
#include "landing/body/body_rest.hpp"
#include "landing/derivatives/body_gradient.hpp"
#include "landing/derivatives/differentiated_run.hpp"

namespace ukemi::landing {

/// Names of the numbers of a drop.
inline constexpr std::array kDropNames = {"height", "forward_speed", "pitch", "pitch_rate", "vertical_speed"};
template <class T>
std::array<T*, kDropNames.size()> drop_numbers(DropOf<T>& d) {
  return std::array{&d.height, &d.forward_speed, &d.pitch, &d.pitch_rate, &d.vertical_speed};
}

/// A Landing of follow_with_derivatives: in Jets and, in the same mode, in doubles and in scalars with time derivative.
template <int P, Capacity kSize>
class DifferentiatedBody {
 public:
  using Jet = ceres::Jet<double, P>;
  using Dual = ceres::Jet<double, 1>;  ///< a value and its time derivative
  using Derivatives = Eigen::Matrix<double, P, 1>;
  using Course = BodyCourse<kSize, false, Jet>;
  using System = typename Course::System;
  using Plain = BodySystem<kSize, false>;
  using State = typename System::State;
  using DualSystem = BodySystem<kSize, false, Dual>;
  using Values = typename Plain::State;
  using Driver = integrate::Integrator<integrate::DormandPrince853, System>;

  /// Derivatives by at most P parameters. Scene, motion and options must outlive it.
  DifferentiatedBody(const BodyScene& scene, const BodyMotion& motion, std::span<const BodyParameter> parameters,
                     const SimulateOptions& options)
      : scene_(scene), options_(options), course_(scene, motion), plain_(scene.robot, scene.slope), dual_(plain_) {
    for (std::size_t k = 0; k < parameters.size(); ++k) seed(parameters[k], int(k));
    course_.system.complete_constants();
  }

  template <class Observer>
  DifferentiatedOutcome run(Observer& observer) {
    typename Course::Fall fall = course_.fall(course_.released());
    if (fall.until > 0 && !stays_still(fall)) fall.until = 0;
    plain_ = Plain(course_.system);
    dual_ = DualSystem(course_.system);
    first_step_ = fall.first_step();
    if constexpr (requires { observer.fall(*this, fall); }) observer.fall(*this, fall);
    return follow_with_derivatives(*this, fall.until, fall.at(fall.until), observer);
  }

  const BodyScene& scene() const { return scene_; }
  const System& system() const { return course_.system; }
  const Plain& plain() const { return plain_; }
  int touchdowns() const { return contacts_.size(); }
  /// Scale of each derivative, which is by parameter / unit; relative for constants, for the error control.
  const Eigen::Array<double, P, 1>& unit() const { return unit_; }

  static Values values(const State& y) {
    Values v;
    for (int k = 0; k < System::kStates; ++k) v[k] = value_of(y[k]);
    return v;
  }
  /// Acceleration of the peak point with its derivatives at a fixed time.
  Vec2<Jet> acceleration(const State& y, const State& dy) const { return of_peak(course_.system, y, dy); }
  /// Acceleration of the peak point with its time derivative.
  Vec2<Dual> acceleration_rate(double t, const Values& y, const Values& dy) const {
    return along_motion(t, y, dy,
                        [](const auto& s, const Dual&, const auto& x, const auto& dx) { return of_peak(s, x, dx); });
  }
  /// f(system, t, y, dy) in scalars with the time derivative; `accelerates`: f needs dy.
  template <class F>
  auto along_motion(double t, const Values& y, const Values& dy, F&& f, bool accelerates = true) const {
    typename DualSystem::State x, dx;
    for (int k = 0; k < System::kStates; ++k) x[k] = Dual(y[k]), x[k].v[0] = dy[k];
    const Dual time(t, 0);
    if (accelerates) dual_.derivative(time, x, dx);
    return f(dual_, time, x, dx);
  }
  const auto& dual() const { return dual_; }

  // The course, as required by follow_with_derivatives.
  const SimulateOptions& options() const { return options_; }
  integrate::Options step_options() const {
    return {
        .accuracy = course_.step_accuracy(options_.accuracy), .first_step = first_step_, .max_step = options_.max_step};
  }
  void open(double, const State&) {}
  double longest_step() const { return course_.longest_step(); }
  double stop() const { return course_.stop(); }
  bool end_moves() const { return course_.limit_moves(); }
  Deadline reached(double t) {
    if (t >= course_.limit())
      return {course_.touched() || !scene_.touches() ? End::kTimeLimit : End::kNoContact, false};
    const bool lands = course_.lands_at(t);
    if (!lands) course_.advance(t), sync_modes();
    return {std::nullopt, lands};
  }
  void land(const Jet& t, State& y) { course_.land(t), course_.advance(t.a), course_.settle(t.a, y), sync_modes(); }
  bool cross(int event, const Jet& t, State& y) {
    const bool first = !course_.touched();
    const typename Course::Crossing crossing = course_.cross(event, t, y);
    if (crossing.touched >= 0)
      contacts_.touchdown(crossing.touched, t.a);
    else if (crossing.surface)
      contacts_.liftoff(event / System::kGuardsPerContact, t.a);
    if (crossing.lands) course_.land(t);
    course_.settle(t.a, y), sync_modes();
    return first && crossing.touched >= 0;
  }
  bool rests(double t, const Values& y, double square) {
    ++steps_;
    return course_.touched() && !course_.detecting() && rest_test_.due(steps_) &&
           rest_test_(steps_, plain_, t, y, RestEnergy(plain_, options_.accuracy)(square));
  }

 private:
  /// Whether links and motors stay at rest in a fall for small changes of the parameters too.
  static bool stays_still(const typename Course::Fall& fall) {
    constexpr double kRounding = 1e-8;
    for (int k = System::kTheta; k < System::kStates; ++k)
      if (k != System::kVx && k != System::kVy && !fall.rate[k].v.isZero(kRounding)) return false;
    return true;
  }
  template <class Any>
  static auto of_peak(const Any& s, const typename Any::State& y, const typename Any::State& dy) {
    return landing::acceleration(s.body.peak, s.pose(y), s.accelerations_of(dy), s.body.bodies);
  }
  void sync_modes() { plain_.copy_mode(course_.system), dual_.copy_mode(course_.system); }

  void set(Jet& x, int slot, bool relative) {
    if (relative && x.a != 0) unit_[slot] = std::abs(x.a);
    x.v[slot] = unit_[slot];
  }
  void seed(const BodyParameter& p, int slot) {
    switch (p.of) {
      case BodyParameter::Of::kMotion:
        for (int i = 0; i < course_.joints(); ++i)
          if (course_.driven(i) && (p.index < 0 || course_.system.body.joint[i].joint == p.index))
            seed_motion(course_.motion[i], p.which, slot);
        break;
      case BodyParameter::Of::kDrop: {
        set(*drop_numbers(course_.drop)[std::size_t(p.which)], slot, false);
        break;
      }
      case BodyParameter::Of::kDrive:
        for (int i = 0; i < course_.joints(); ++i)
          if (course_.system.body.joint[i].joint == p.index) seed_drive(i, p.which, slot);
        break;
      case BodyParameter::Of::kContact: {
        for (int i = 0; i < course_.system.body.contacts; ++i) {
          if (p.index >= 0 && i != p.index) continue;
          ContactConstants<Jet>& c = course_.system.point[std::size_t(i)];
          // In the order of kContactKeys.
          set(*std::array{&c.k, &c.c, &c.c_t, &c.k_t, &c.mu, &c.p, &c.dissipation, &c.k_pad, &c.c_pad,
                          &c.thickness}[std::size_t(p.which)],
              slot, p.index >= 0 || i == 0);  // all contacts together have the unit of the first
        }
      }
    }
  }
  void seed_motion(MotionOf<Jet>& m, int which, int slot) {
    Jet none(0);
    set(*motion_numbers(m, none)[std::size_t(which)], slot, false);
  }
  /// The inertia of a geared motor is also in the mass matrix.
  void seed_drive(int i, int which, int slot) {
    const auto at = actuator_constants()[std::size_t(which)].at;
    auto& drive = course_.system.drive[std::size_t(i)];
    const SeaParameters<double>& plain = course_.joint_of(i).sea;
    drive.extended = true;  // includes derivatives by friction of 0, see complete_constants
    SeaParameters<Jet>::for_each(drive.sea, plain, [&](Jet& x, const double& of) {
      if (&of == &(plain.*at)) set(x, slot, true);
    });
    if (at != &SeaParameters<double>::i_motor || drive.kind != DriveKind::kGeared) return;
    const TreeJoint& joint = course_.system.body.joint[std::size_t(i)];
    auto& n = course_.system.body.n;
    const auto child = std::size_t(joint.child), parent = std::size_t(joint.parent);
    n[child][child].v[slot] += unit_[slot];
    if (joint.parent < 0) return;
    n[parent][parent].v[slot] += unit_[slot];
    n[child][parent].v[slot] -= unit_[slot], n[parent][child].v[slot] -= unit_[slot];
  }

  const BodyScene& scene_;
  const SimulateOptions& options_;
  Course course_;
  Plain plain_;
  DualSystem dual_;
  Eigen::Array<double, P, 1> unit_ = Eigen::Array<double, P, 1>::Ones();
  ContactOrder contacts_;
  double first_step_ = 0;  ///< [s]
  double steps_ = 0;       ///< so far, for the rest test
  RestTest rest_test_;
};

}  // namespace ukemi::landing
