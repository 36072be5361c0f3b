// ukemi simulate, and what other verbs say of a landing.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "common/drive_stability.hpp"
#include "common/error.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/judge/sensitivity.hpp"
#include "tools/program/actuators.hpp"
#include "tools/report/report.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

using namespace landing;

std::string failure(const LandingPeak& p) {
  if (p.end == End::kNoContact) return fmt::format("no point touches the floor within {:.4g} s", p.t_end);
  return fmt::format("{}, at t = {:.6g} s after {} steps", reason(p), p.t_end, p.work.steps);
}

Json motion_json(const Motion& m) {
  return {{"phi_i_deg", m.phi_i * kDegrees}, {"phi_f_deg", m.phi_f * kDegrees}, {"duration", m.duration}};
}
Json contacts_json(const Landing& l) {
  Json j = Json::array();
  for (const Touch& t : l.touches) j.push_back({{"point", kPointNames[t.point]}, {"t", t.t_touchdown}});
  return j;
}
Json peaks_json(const Landing& l) {
  Json j = Json::array();
  int n = 0;
  for (const Peak& p : l.peaks)
    if (p.point >= 0)
      j.push_back(
          {{"n", ++n}, {"t", p.t}, {"acceleration", p.acceleration}, {"contact", kPointNames[std::size_t(p.point)]}});
  return j;
}
std::string order_of(const Landing& l) {
  std::string s;
  for (const Peak& p : l.peaks)
    if (p.point >= 0) s += (s.empty() ? "" : ", ") + std::string(kPointNames[std::size_t(p.point)]);
  return s.empty() ? "none" : s;
}

Json ratings(const Motion& motion, const Landing& l, const Actuator& actuator, Run& run) {
  const double rate = peak_reference_rate(motion);
  const Demands& d = l.demands;
  Json j;
  j["peak_reference_rate"] = rate;
  j["motor_speed"] = d.motor_speed;
  j["speed_max"] = number(actuator.speed_max);
  j["motor_torque"] = d.motor_torque;
  j["sea_torque"] = d.sea_torque;
  j["tau_max"] = number(actuator.sea.tau_max);
  j["phi_1_deg"] = {d.phi_min * kDegrees, d.phi_max * kDegrees};
  if (actuator.speed_max && std::max(rate, d.motor_speed) > *actuator.speed_max)
    run.warn(fmt::format(
        "the robot could not follow: reference rate {:.3g} rad/s, motor speed {:.3g} rad/s; rated {:.3g} rad/s", rate,
        d.motor_speed, *actuator.speed_max));
  if (std::isfinite(actuator.sea.tau_max) && d.motor_torque > actuator.sea.tau_max)
    run.warn(
        fmt::format("the motor is asked for {:.3g} Nm; tau_max is {:.3g} Nm", d.motor_torque, actuator.sea.tau_max));
  return j;
}

void warn_if_unstable(const Scene& scene, const Actuator& actuator, const Motion& motion, Run& run) {
  const TwoLinkDynamics<double> links(scene.robot);
  double fastest = 0, at = 0;
  for (const double phi : {motion.phi_i, motion.phi_f})
    if (const double rate = growth_rate(actuator.sea, joint_inertia(links, phi)); rate > fastest)
      fastest = rate, at = phi;
  if (fastest > 0)
    run.warn(fmt::format(
        "the drive is unstable on this robot: in flight, at {:.4g} deg, a disturbance grows e-fold every {:.2g} s{}",
        at * kDegrees, 1 / fastest,
        std::isfinite(actuator.sea.tau_max) ? ", up to the torque limit" : ", and no torque limit ends it"));
}

Json evidence_json(const Evidence& e) {
  return {{"tolerant_peak", number(e.tolerant.value)},
          {"width_of_5_percent",
           {{"phi_i_deg", {e.width[0][0] * kDegrees, e.width[0][1] * kDegrees}},
            {"phi_f_deg", {e.width[1][0] * kDegrees, e.width[1][1] * kDegrees}},
            {"duration", e.width[2]}}},
          {"one_degree", number(e.one_degree)},
          {"ten_milliseconds", number(e.ten_milliseconds)},
          {"one_centimetre", number(e.one_centimetre)},
          {"pitch_one_degree", number(e.pitch_one_degree)},
          {"damping_ten_percent", number(e.damping_ten_percent)},
          {"complete", e.complete}};
}

namespace {

struct SimulateArguments {
  std::string scene, actuator, motion;
  std::optional<double> hold, rate, accuracy;
};

std::string trajectory_csv(const Run& run, const Landing& l) {
  CsvWriter csv = run.csv();
  csv.comment(
      "t = 0 at release. Two rows with one t: left and right limit of an event. Units: s, m, rad, N, Nm; acc = "
      "|ddr_0|, m/s^2.");
  std::vector<std::string> header = {"t",      "x_0",    "y_0",    "phi_0", "phi_1", "phi_m", "dx_0",    "dy_0",
                                     "dphi_0", "dphi_1", "dphi_m", "ddx_0", "ddy_0", "acc",   "tau_sea", "phi_ref"};
  for (const char* p : kPointNames) header.insert(header.end(), {fmt::format("f_{}_x", p), fmt::format("f_{}_y", p)});
  csv.header(header);
  for (const Sample& s : l.trajectory) {
    std::vector<double> row = {s.t,     s.x0,    s.y0,     s.phi0, s.phi1, s.phi_m, s.dx0,     s.dy0,
                               s.dphi0, s.dphi1, s.dphi_m, s.ddx0, s.ddy0, s.acc,   s.tau_sea, s.phi_ref};
    for (const auto& f : s.force) row.insert(row.end(), {f.x(), f.y()});
    csv.row(row);
  }
  return csv.text();
}

std::string contacts_csv(const Run& run, const Landing& l) {
  CsvWriter csv = run.csv();
  csv.comment("t = 0 at release; t_liftoff: when the point rises through y = 0 again. Units: s, N, m/s^2.");
  csv.header({"point", "t_touchdown", "t_liftoff", "peak_force", "peak_acc"});
  for (const Touch& t : l.touches) {
    csv.cell(kPointNames[t.point]).cell(t.t_touchdown).cell(t.t_liftoff).cell(t.peak_force).cell(t.peak_acc);
    csv.end_row();
  }
  return csv.text();
}

int run_simulate(const SimulateArguments& a, const CommonOptions& common) {
  Run run("simulate", common);
  if (a.motion.empty() == !a.hold) throw InputError("simulate: one of --motion FILE and --hold DEG is needed");
  const Scene scene = read_scene(a.scene);
  run.input(a.scene);
  const Actuator actuator = actuator_of(a.actuator, run);
  Motion motion{};
  if (a.hold) {
    if (!std::isfinite(*a.hold) || std::abs(*a.hold) > 360)
      throw InputError(fmt::format("--hold: {}: degrees from -360 to 360 are needed", *a.hold));
    motion = {*a.hold / kDegrees, *a.hold / kDegrees, 1};
  } else {
    motion = read_motion(a.motion);
    run.input(a.motion);
  }
  const double rate = a.rate.value_or(1000);
  if (!(rate > 0 && rate <= 1e6)) throw InputError(fmt::format("--rate: {}: above 0 to 1e6 Hz is needed", rate));
  SimulateOptions options;
  options.accuracy = a.accuracy.value_or(options.accuracy);
  options.validate();

  warn_if_unstable(scene, actuator, motion, run);
  const Landing l = simulate(scene, actuator.sea, motion, options, rate);
  Json summary;
  if (l.end == End::kFailed) {
    run.warn("refused: " + failure(l) + "; what was computed so far is kept");
    summary["failed"] = failure(l);
  }
  if (l.end == End::kNoContact) run.warn(failure(l) + ": the peak is that of a flight");
  const Sensitivity s = sensitivity(scene, actuator.sea, motion, options, l.peak);
  const bool wrong = s.checked && !s.right && l.end != End::kFailed;
  if (!s.checked && l.end != End::kFailed)
    run.warn("the peak could not be checked: at a hundredth of the tolerance the landing cannot be followed");
  if (l.demands.phi_max - l.demands.phi_min > 4 * std::numbers::pi)
    run.warn(fmt::format("the joint turns from {:.4g} to {:.4g} deg: the drive has lost it",
                         l.demands.phi_min * kDegrees, l.demands.phi_max * kDegrees));
  if (wrong)
    run.warn(
        fmt::format("wrong: the peak moves by {:.2g} with the tolerance and not with the scene; try --accuracy {:g}",
                    s.error_estimate, std::max(1e-14, options.accuracy / 100)));
  if (s.sensitive)
    run.warn(fmt::format("sensitive: a scene moved by 1e-6 moves the peak by {:.2g}: the motion stands beside a cliff",
                         s.change));
  summary["motion"] = motion_json(motion);
  summary["peak_acceleration"] = number(l.peak);
  summary["peak_time"] = number(l.t_peak);
  summary["error_estimate"] = s.checked ? number(s.error_estimate) : Json();
  summary["sensitive"] = s.sensitive;
  summary["sensitivity"] = number(s.change);
  summary["peaks"] = peaks_json(l);
  summary["contacts"] = contacts_json(l);
  summary["end"] = name(l.end);
  summary["t_end"] = l.t_end;
  summary["energy_residual"] = number(l.energy_residual);
  summary["ratings"] = ratings(motion, l, actuator, run);
  summary["steps"] = l.work.steps;
  summary["implicit_steps"] = l.work.implicit;  // of them, where a phase is stiff

  run.say(fmt::format("peak {:.10g} m/s^2 at t = {:.9g} s (estimated relative error {:.1g}{})", l.peak, l.t_peak,
                      s.error_estimate, s.sensitive ? ", sensitive" : ""));
  run.say("contacts: " + order_of(l) + fmt::format("; end: {} at {:.4g} s", name(l.end), l.t_end));

  run.add("trajectory.csv", trajectory_csv(run, l));
  run.add("contacts.csv", contacts_csv(run, l));
  Report report("Landing: " + scene.name);
  report.paragraph(fmt::format(
      "Peak |ddr_0| {:.6g} m/s² at {:.6g} s after release; contacts: {}; ended by {} at {:.4g} s. Energy check: "
      "{:.1e} of the energy turned over.",
      l.peak, l.t_peak, order_of(l), name(l.end), l.t_end, l.energy_residual));
  if (!scene.floor_source.empty()) report.paragraph("Floor constants: " + scene.floor_source + ".");
  report.list(run.warnings());
  Series acc{"|ddr_0|", {}, {}}, phi{"phi_1", {}, {}}, ref{"phi_ref", {}, {}}, tau{"tau_SEA", {}, {}};
  for (const Sample& x : l.trajectory) {
    for (Series* p : {&acc, &phi, &ref, &tau}) p->x.push_back(x.t);
    acc.y.push_back(x.acc), phi.y.push_back(x.phi1 * kDegrees), ref.y.push_back(x.phi_ref * kDegrees),
        tau.y.push_back(x.tau_sea);
  }
  report.plot("t [s]", "|ddr_0| [m/s²]", {acc});
  report.plot("t [s]", "joint [deg]", {phi, ref});
  report.plot("t [s]", "tau_SEA [Nm]", {tau});
  std::vector<std::vector<std::string>> rows;
  for (const Touch& t : l.touches)
    rows.push_back({kPointNames[t.point], fmt::format("{:.6f}", t.t_touchdown),
                    std::isnan(t.t_liftoff) ? "" : fmt::format("{:.6f}", t.t_liftoff),
                    fmt::format("{:.4g}", t.peak_force), fmt::format("{:.4g}", t.peak_acc)});
  report.table({"point", "touchdown [s]", "lift-off [s]", "peak force [N]", "peak |ddr_0| [m/s²]"}, rows);
  run.add("report.html", report.html(run.provenance()));
  return run.finish(summary, l.end == End::kFailed || wrong ? kNumbers : kDone);
}

}  // namespace

void add_simulate(CLI::App& app, Action& chosen) {
  auto args = std::make_shared<SimulateArguments>();
  auto common = std::make_shared<CommonOptions>();
  CLI::App* verb = app.add_subcommand("simulate", "one landing: released, in flight, through its contacts, to rest");
  verb->add_option("SCENE", args->scene, "scene file (TOML)")->required();
  verb->add_option("--actuator", args->actuator, "actuator file (TOML)")->required();
  verb->add_option("--motion", args->motion, "motion file (TOML)");
  verb->add_option("--hold", args->hold, "hold the reference at this angle [deg]; the joint stays compliant");
  verb->add_option("--rate", args->rate, "rows of trajectory.csv a second [1000 Hz]");
  verb->add_option("--accuracy", args->accuracy, "relative tolerance of each step [1e-9]");
  add_common(*verb, *common);
  verb->footer("Example: ukemi simulate scene.toml --actuator actuator.toml --hold -45 -o out");
  verb->callback([args, common, &chosen] { chosen = [args, common] { return run_simulate(*args, *common); }; });
}

}  // namespace ukemi::tools
