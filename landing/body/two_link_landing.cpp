// Landings of the paper's robot, as one of links.
#include <cmath>

#include "landing/body/body_kernel.hpp"
#include "landing/body/by_links.hpp"
#include "landing/model/release.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

namespace {

/// The row of the paper's robot: r_0 is the centre of mass of the thigh, half a link from its origin.
Sample sample_of(const BodySample& b, const TwoLinkLanding& l, const TwoLink<double>& robot) {
  const double half = 0.5 * robot.link_length, sin = std::sin(b.theta[0]), cos = std::cos(b.theta[0]),
               speed = half * b.omega[0];
  Sample out{.t = b.t,
             .x0 = b.x[0] + half * sin,
             .y0 = b.y[0] - half * cos,
             .phi0 = b.theta[0],
             .phi1 = b.phi[0],
             .phi_m = b.phi_m[0],
             .dx0 = b.vx[0] + speed * cos,
             .dy0 = b.vy[0] + speed * sin,
             .dphi0 = b.omega[0],
             .dphi1 = b.dphi[0],
             .dphi_m = b.dphi_m[0],
             .ddx0 = b.acc_x,
             .ddy0 = b.acc_y,
             .acc = b.acc,
             .tau_sea = b.drive_torque[0],
             .phi_ref = b.phi_ref[0],
             .energy = b.energy,
             .force = {}};
  for (std::size_t i = 0; i < l.scene.robot.contacts.size() && l.scene.floor; ++i)
    out.force[std::size_t(l.point(int(i)))] = {b.force_x[i], b.force_y[i]};
  return out;
}

}  // namespace

LandingPeak peak_acceleration(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                              const SimulateOptions& options) {
  validate(scene, sea, motion), options.validate();
  TwoLinkLanding& l = reused_landing(kReusedLandings - 1);
  l.set_scene(scene), l.set_limits(options.limits), l.set_drive(sea, motion);
  return l.outcome(peak_of_valid(l.scene, l.motion, options));
}

double first_touchdown(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion) {
  if (is_ballistic(scene.drop, motion.release_rate()) && !motion.reposition) {
    validate(scene, sea, motion);
    const double fall = fall_time(scene), latest = scene.robot.gravity > 0 ? fall : Scene::kFollow;
    return fall <= latest && !(scene.t_end && *scene.t_end <= fall) ? fall : std::numeric_limits<double>::infinity();
  }
  return peak_acceleration(scene, sea, motion).contacts.first();
}

Landing simulate(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                 const SimulateOptions& options, double rate) {
  validate(scene, sea, motion);
  const TwoLinkLanding l(scene, sea, motion, options.limits);
  const BodyLanding run = simulate(l.scene, l.motion, options, rate);
  Landing out{l.outcome(run)};
  out.touches = run.touches, out.peaks = run.peaks, out.energy_residual = run.energy_residual;
  for (Touch& t : out.touches) t.point = l.point(t.point);
  for (Peak& p : out.peaks) p.point = l.point(p.point);
  const JointDemands& d = run.demands[0];
  out.demands = {d.motor_speed, d.motor_torque, d.drive_torque, d.phi_min, d.phi_max};
  out.trajectory.reserve(run.trajectory.size());
  for (const BodySample& b : run.trajectory) out.trajectory.push_back(sample_of(b, l, scene.robot));
  return out;
}

}  // namespace ukemi::landing
