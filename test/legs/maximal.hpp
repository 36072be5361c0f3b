// Robots of links simulated apart from the library: each link free, joints and the base as constraints, one linear
// system an evaluation, the classical Runge-Kutta method; friction as the clamp that it is, without modes. A step ends
// where a contact meets its surface, or its pad the floor. For drops that a fit has not made itself.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <vector>

#include "landing/body/body_scene.hpp"

namespace legs {

using namespace ukemi::landing;

class MaximalRobot {
 public:
  struct Row {
    double t;
    Eigen::Vector2d acc;  ///< of the point that counts
    std::vector<Eigen::Vector2d> origin;
    std::vector<double> theta, phi;  ///< of links, of joints
  };

  MaximalRobot(const BodyScene& scene, const BodyMotion& motion) : s_(scene), r_(scene.robot), motion_(motion) {
    n_ = int(r_.links.size()), joints_ = int(r_.joints.size()), contacts_ = int(r_.contacts.size());
    touching_.assign(std::size_t(contacts_), false), below_ = touching_;
    release();
  }

  /// A row at each of `count` times, 1 / rate apart from release on.
  std::vector<Row> run(int count, double rate, double step = 5e-5) {
    std::vector<Row> out;
    for (int k = 0; k < count; ++k) {
      while (t_ < k / rate - 1e-12) advance(std::min(step, k / rate - t_));
      out.push_back(row());
    }
    return out;
  }

 private:
  using Vector = Eigen::VectorXd;
  // State: x, y, theta of each link's centre of mass, motor angles; their rates; slips.
  int positions() const { return 3 * n_ + joints_; }
  static Eigen::Vector2d u(double a) { return {std::sin(a), -std::cos(a)}; }
  static Eigen::Vector2d n(double a) { return {std::cos(a), std::sin(a)}; }
  Eigen::Vector2d arm(int link, const Place& at, double theta) const {
    const Link& l = r_.links[std::size_t(link)];
    return (at.along - l.com.along) * u(theta) + (at.across - l.com.across) * n(theta);
  }
  Eigen::Vector2d point(const Vector& y, int link, const Place& at) const {
    return Eigen::Vector2d(y[3 * link], y[3 * link + 1]) + arm(link, at, y[3 * link + 2]);
  }
  static Eigen::Vector2d turned(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }
  Eigen::Vector2d rate(const Vector& y, int link, const Place& at) const {
    const int v = positions() + 3 * link;
    return Eigen::Vector2d(y[v], y[v + 1]) + y[v + 2] * turned(arm(link, at, y[3 * link + 2]));
  }

  double start_angle(int j) const {
    const Joint& joint = r_.joints[std::size_t(j)];
    return joint.driven() ? motion_[std::size_t(j)].release_phi() : joint.phi;
  }
  void release() {
    y_ = Vector::Zero(2 * positions() + contacts_);
    std::vector<Eigen::Vector2d> origin(std::size_t(n_), Eigen::Vector2d::Zero());
    for (int i = 0; i < n_; ++i) {
      const Link& l = r_.links[std::size_t(i)];
      double theta = s_.drop.pitch;
      for (int j = 0; j < joints_; ++j)
        if (r_.joints[std::size_t(j)].child == i)
          theta = (l.parent < 0 ? 0 : y_[3 * l.parent + 2]) + start_angle(j), y_[3 * n_ + j] = start_angle(j);
      if (l.parent >= 0) {
        const double p = y_[3 * l.parent + 2];
        origin[std::size_t(i)] = origin[std::size_t(l.parent)] + l.at.along * u(p) + l.at.across * n(p);
      }
      const Eigen::Vector2d com = origin[std::size_t(i)] + l.com.along * u(theta) + l.com.across * n(theta);
      y_[3 * i] = com.x(), y_[3 * i + 1] = com.y(), y_[3 * i + 2] = theta;
    }
    double lowest = INFINITY;
    for (int c = 0; c < contacts_; ++c)
      lowest = std::min(lowest,
                        point(y_, r_.contacts[std::size_t(c)].link, r_.contacts[std::size_t(c)].at).y() - thickness(c));
    for (int i = 0; i < n_; ++i) {
      y_[3 * i + 1] += s_.drop.height - lowest;
      if (r_.base == Base::kFree) y_[positions() + 3 * i] = s_.drop.forward_speed;
    }
  }
  double thickness(int c) const {
    const auto& pad = r_.contacts[std::size_t(c)].pad;
    return pad ? pad->thickness : 0;
  }

  /// Normal and tangential force of a contact that touches, and the rate of its slip.
  struct Force {
    double normal = 0, along = 0, slip = 0;
  };
  Force force(const Vector& y, int c) const {
    Force f;
    if (!touching_[std::size_t(c)]) return f;
    const ContactPoint& k = r_.contacts[std::size_t(c)];
    const double h = point(y, k.link, k.at).y();
    const Eigen::Vector2d v = rate(y, k.link, k.at);
    if (below_[std::size_t(c)]) {
      const double depth = std::max(0.0, -h);
      f.normal = k.law.hunt_crossley
                     ? k.law.stiffness * std::pow(depth, k.law.exponent) * (1 - k.law.dissipation * v.y())
                     : -k.law.stiffness * h - k.law.damping_normal * v.y();
      f.normal = std::max(0.0, f.normal);
    }
    if (k.pad) f.normal += std::max(0.0, k.pad->stiffness * (k.pad->thickness - h) - k.pad->damping * v.y());
    const double z = y[2 * positions() + c], held = k.law.stiffness_tangential * z + k.law.damping_tangential * v.x();
    double pull = held;
    if (std::isfinite(k.law.friction)) {
      const double most = k.law.friction * f.normal;
      pull = std::min(std::max(held, -most), most);
      f.slip = (pull - k.law.stiffness_tangential * z) / k.law.damping_tangential;
    } else if (k.law.stiffness_tangential > 0) {
      f.slip = v.x();
    }
    f.along = -pull;
    return f;
  }

  /// phi_ref and its rate of a driven joint.
  std::array<double, 2> reference(int j, double t) const {
    const Motion& m = motion_[std::size_t(j)];
    if (!(t > first_)) return {m.phi_i, 0};
    const double x = std::min(1.0, (t - first_) / m.duration), d = m.phi_f - m.phi_i;
    return {m.phi_i + d * x * x * x * (10 - 15 * x + 6 * x * x), d * 30 * x * x * (1 - x) * (1 - x) / m.duration};
  }

  /// Accelerations of links and motors.
  Vector accelerations(double t, const Vector& y, std::vector<Force>& forces) const {
    const int P = positions();
    int rows = 2 * (n_ - 1) + (r_.base == Base::kFree ? 0 : 2);
    for (const Joint& j : r_.joints) rows += j.kind == DriveKind::kLocked;
    Eigen::MatrixXd k = Eigen::MatrixXd::Zero(3 * n_ + rows, 3 * n_ + rows);
    Vector right = Vector::Zero(3 * n_ + rows), motors = Vector::Zero(joints_);
    for (int i = 0; i < n_; ++i) {
      const Link& l = r_.links[std::size_t(i)];
      k(3 * i, 3 * i) = k(3 * i + 1, 3 * i + 1) = l.mass, k(3 * i + 2, 3 * i + 2) = l.inertia_com;
      right[3 * i + 1] = -l.mass * r_.gravity;
    }
    forces.assign(std::size_t(contacts_), {});
    for (int c = 0; c < contacts_; ++c) {
      const Force f = forces[std::size_t(c)] = force(y, c);
      const ContactPoint& p = r_.contacts[std::size_t(c)];
      const Eigen::Vector2d a = arm(p.link, p.at, y[3 * p.link + 2]);
      right[3 * p.link] += f.along, right[3 * p.link + 1] += f.normal;
      right[3 * p.link + 2] += a.x() * f.normal - a.y() * f.along;
    }
    int row = 3 * n_;
    const auto constrain = [&](int column, double value) { k(row, column) += value, k(column, row) += value; };
    // d/dt of point = v + omega x arm; its acceleration = a + alpha x arm - omega^2 arm.
    const auto constrain_point = [&](int link, const Place& at, const Eigen::Vector2d& e, double sign) {
      const Eigen::Vector2d a = arm(link, at, y[3 * link + 2]);
      const double w = y[P + 3 * link + 2];
      constrain(3 * link, sign * e.x()), constrain(3 * link + 1, sign * e.y());
      constrain(3 * link + 2, sign * e.dot(turned(a)));
      right[row] += sign * w * w * e.dot(a);
    };
    for (int i = 1; i < n_; ++i)
      for (const Eigen::Vector2d& e : {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1)}) {
        constrain_point(i, {}, e, 1),
            constrain_point(r_.links[std::size_t(i)].parent, r_.links[std::size_t(i)].at, e, -1);
        ++row;
      }
    if (r_.base == Base::kRail) {
      const double d = r_.rail_direction;
      constrain_point(0, {}, {-std::sin(d), std::cos(d)}, 1), ++row;
      constrain(2, 1), ++row;
    } else if (r_.base == Base::kPinned) {
      constrain_point(0, {}, {1, 0}, 1), ++row;
      constrain_point(0, {}, {0, 1}, 1), ++row;
    }
    for (int j = 0; j < joints_; ++j) {
      const Joint& joint = r_.joints[std::size_t(j)];
      const int child = 3 * joint.child + 2, above = r_.links[std::size_t(joint.child)].parent;
      const double phi = y[child] - (above < 0 ? 0 : y[3 * above + 2]),
                   dphi = y[P + child] - (above < 0 ? 0 : y[P + 3 * above + 2]);
      double tau = -joint.parallel_stiffness * (phi - joint.parallel_rest);
      const auto [ref, dref] = reference(j, t);
      const auto& sea = joint.sea;
      const auto limited = [&](double x) { return std::min(std::max(x, -sea.tau_max), sea.tau_max); };
      if (joint.kind == DriveKind::kGeared) {
        tau += limited(sea.k_p * (ref - phi) + sea.k_d * (dref - dphi));
        k(child, child) += sea.i_motor;
        if (above >= 0) {
          const int parent = 3 * above + 2;
          k(parent, parent) += sea.i_motor, k(child, parent) -= sea.i_motor, k(parent, child) -= sea.i_motor;
        }
      } else if (joint.kind == DriveKind::kElastic) {
        const double m = y[3 * n_ + j], dm = y[P + 3 * n_ + j],
                     spring = limited(sea.k_sea * (m - phi) + sea.c_sea * (dm - dphi));
        motors[j] = (sea.k_p * (ref - phi) + sea.k_d * (dref - dphi) - spring) / sea.i_motor;
        tau += spring;
      } else if (joint.kind == DriveKind::kPassive) {
        tau -= joint.stiffness * (phi - joint.rest) + joint.damping * dphi;
      } else {
        constrain(child, 1), constrain(3 * above + 2, -1), ++row;
      }
      right[child] += tau;
      if (above >= 0) right[3 * above + 2] -= tau;
    }
    Vector out(3 * n_ + joints_);
    out << k.partialPivLu().solve(right).head(3 * n_), motors;
    return out;
  }
  Vector derivative(double t, const Vector& y) const {
    std::vector<Force> forces;
    Vector dy(y.size());
    const int P = positions();
    const Vector a = accelerations(t, y, forces);
    dy.head(P) = y.segment(P, P), dy.segment(P, P) = a;
    for (int c = 0; c < contacts_; ++c) dy[2 * P + c] = forces[std::size_t(c)].slip;
    return dy;
  }
  Vector stepped(double h) const {
    const Vector a = derivative(t_, y_), b = derivative(t_ + h / 2, y_ + h / 2 * a),
                 c = derivative(t_ + h / 2, y_ + h / 2 * b), d = derivative(t_ + h, y_ + h * c);
    return y_ + h / 6 * (a + 2 * b + 2 * c + d);
  }
  /// What a contact meets in a step: 1 its surface, 2 the floor below its pad; 0 nothing.
  int meets(const Vector& y, int c) const {
    const ContactPoint& k = r_.contacts[std::size_t(c)];
    const double h = point(y, k.link, k.at).y();
    if (touching_[std::size_t(c)] != (h < thickness(c))) return 1;
    if (k.pad && touching_[std::size_t(c)] && below_[std::size_t(c)] != (h < 0)) return 2;
    return 0;
  }
  bool meets_any(const Vector& y) const {
    for (int c = 0; c < contacts_; ++c)
      if (meets(y, c)) return true;
    return false;
  }
  void advance(double h) {
    Vector y = stepped(h);
    if (meets_any(y)) {
      double low = 0, high = h;
      for (int k = 0; k < 40; ++k) {
        const double middle = 0.5 * (low + high);
        (meets_any(stepped(middle)) ? high : low) = middle;
      }
      h = high, y = stepped(h);
    }
    t_ += h, y_ = y;
    for (int c = 0; c < contacts_; ++c) {
      const int what = meets(y_, c);
      const auto at = std::size_t(c);
      if (what == 1) {
        touching_[at] = !touching_[at], below_[at] = touching_[at] && thickness(c) == 0;
        y_[2 * positions() + c] = 0;
        if (touching_[at]) first_ = std::min(first_, t_);
      } else if (what == 2) {
        below_[at] = !below_[at];
      }
    }
  }
  Row row() const {
    Row out;
    out.t = t_;
    std::vector<Force> forces;
    const Vector a = accelerations(t_, y_, forces);
    const int link = r_.peak_link;
    const Eigen::Vector2d at = arm(link, r_.peak, y_[3 * link + 2]);
    const double w = y_[positions() + 3 * link + 2];
    out.acc = Eigen::Vector2d(a[3 * link], a[3 * link + 1]) + a[3 * link + 2] * turned(at) - w * w * at;
    for (int i = 0; i < n_; ++i) out.origin.push_back(point(y_, i, {})), out.theta.push_back(y_[3 * i + 2]);
    for (const Joint& j : r_.joints) {
      const int above = r_.links[std::size_t(j.child)].parent;
      out.phi.push_back(y_[3 * j.child + 2] - (above < 0 ? 0 : y_[3 * above + 2]));
    }
    return out;
  }

  const BodyScene s_;
  const Robot& r_ = s_.robot;
  const BodyMotion motion_;
  int n_, joints_, contacts_;
  double t_ = 0, first_ = INFINITY;
  Vector y_;
  std::vector<bool> touching_, below_;
};

}  // namespace legs
