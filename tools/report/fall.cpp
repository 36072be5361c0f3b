#include "tools/report/fall.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tools/report/landing.hpp"

namespace ukemi::tools {

using namespace landing;

std::string circled(std::size_t n) {
  if (n > 20) return fmt::format("({})", n);
  return std::string("\xE2\x91") + char(0x9F + n);  // U+2460 and on
}
Figure over_time(const std::string& name, const std::string& y_label, std::vector<Series> series) {
  Figure out = lines(name, "time from release [s]", y_label, std::move(series));
  out.cursor = Figure::Cursor::kTime;
  return out;
}
void add_marks(Panel& panel, const std::vector<Peak>& all, int colour) {
  const std::vector<Peak> peaks = contact_peaks(all);
  for (std::size_t n = 0; n < peaks.size(); ++n)
    panel.marks.push_back({peaks[n].t, peaks[n].acceleration, circled(n + 1), colour});
}

Figure fall_picture(Panel postures, Figure acceleration) {
  Figure out = std::move(acceleration);
  out.name = "fall", out.target = Figure::Target::kFile, out.panel_height = 240, out.cursor = Figure::Cursor::kNone;
  out.panels.insert(out.panels.begin(), std::move(postures));
  return out;
}

namespace {

/// Postures at the peaks side by side.
Panel postures_of(const Fall& f, double length) {
  constexpr std::size_t kMaxPostures = 7;
  Panel out;
  out.title = f.name, out.scale = Panel::Scale::kBare;
  const double step = 2.6 * length, half = length / 2;
  const std::vector<Peak> peaks = contact_peaks(f.landing->peaks);
  for (std::size_t n = 0; n < std::min(kMaxPostures, peaks.size()); ++n) {
    const Sample& s = row_at(f.landing->trajectory, peaks[n].t);
    const double theta[] = {s.phi0, s.phi0 + s.phi1}, x = step * double(n);
    const double hip_x = x - half * std::sin(theta[0]), hip_y = s.y0 + half * std::cos(theta[0]),
                 knee_x = x + half * std::sin(theta[0]), knee_y = s.y0 - half * std::cos(theta[0]);
    out.series.push_back({"", {hip_x, knee_x}, {hip_y, knee_y}, Series::Style::kThick, Series::kInk});
    out.series.push_back({"",
                          {knee_x, knee_x + length * std::sin(theta[1])},
                          {knee_y, knee_y - length * std::cos(theta[1])},
                          Series::Style::kThick,
                          0});
    out.marks.push_back({x, 2.0 * length, circled(n + 1)});
    out.marks.push_back(
        {x, -0.8 * length,
         fmt::format("{} {:.0f} m/s^2", kPointNames[std::size_t(peaks[n].point)], peaks[n].acceleration)});
    out.marks.push_back({x, -0.4 * length, fmt::format("{:.3f} s", peaks[n].t)});
  }
  out.x_range = {-step / 2, step * (double(std::clamp<std::size_t>(peaks.size(), 3, kMaxPostures)) - 0.5)};
  out.y_range = {-1.0 * length, 2.2 * length};
  out.series.push_back({"", {out.x_range->at(0), out.x_range->at(1)}, {0, 0}, Series::Style::kLine, Series::kGrey});
  return out;
}

Figure acceleration(const Falls& f) {
  std::vector<Series> series;
  for (const Fall& fall : f.falls) series.push_back(curve(fall.name, fall.landing->trajectory, &Sample::acc));
  if (series.size() > 1) series[1].style = Series::Style::kDashed;
  Figure out = over_time("acceleration", "|ddr_0| [m/s^2]", series);
  for (std::size_t i = 0; i < f.falls.size(); ++i) add_marks(out.panels[0], f.falls[i].landing->peaks, int(i));
  if (f.limit) out.panels[0].levels.push_back({*f.limit, fmt::format("no motion is below {:.1f}", *f.limit)});
  out.width = Figure::Width::kWhole, out.panel_height = 320;
  out.caption = "Acceleration of the thigh's centre of mass, its norm; the numbers are those of the postures.";
  return out;
}

Figure components(const Fall& f) {
  Figure out =
      over_time("components", "ddr_0 [m/s^2]",
                {curve("x", f.landing->trajectory, &Sample::ddx0), curve("y", f.landing->trajectory, &Sample::ddy0),
                 curve("norm", f.landing->trajectory, &Sample::acc)});
  out.panels[0].series[2].style = Series::Style::kDashed;
  add_marks(out.panels[0], f.landing->peaks, Series::kInk);
  out.caption = "The same of \"" + f.name + "\" in x (forward), y (up) and as a norm.";
  return out;
}

Figure joint(const Fall& f) {
  Figure out = over_time("joint", "joint [deg]",
                         {curve("phi_1", f.landing->trajectory, &Sample::phi1, kDegrees),
                          curve("reference", f.landing->trajectory, &Sample::phi_ref, kDegrees)});
  out.panels[0].series[1].style = Series::Style::kDashed;
  out.caption = "The joint against its reference, " + f.name + ".";
  return out;
}

/// A quantity of the drive in every fall, with lines at +- its rating.
Figure against_rating(const Falls& f, const std::string& name, const std::string& y_label, double Sample::*column,
                      std::optional<double> rating, const std::string& rating_words) {
  std::vector<Series> series;
  for (const Fall& fall : f.falls) series.push_back(curve(fall.name, fall.landing->trajectory, column));
  if (series.size() > 1) series[1].style = Series::Style::kDashed;
  Figure out = over_time(name, y_label, series);
  if (rating && std::isfinite(*rating))
    for (const double sign : {1.0, -1.0})
      out.panels[0].levels.push_back({sign * *rating, fmt::format("{} {:g}", rating_words, sign * *rating)});
  return out;
}

Figure energy(const Falls& f) {
  const std::vector<Sample>& rows = f.falls[0].landing->trajectory;
  Series links{"both links", {}, {}}, motor{"motor", {}, {}};
  for (const Sample& s : rows) {
    links.x.push_back(s.t), links.y.push_back(link_energy(f.scene, s));
    motor.x.push_back(s.t), motor.y.push_back(0.5 * f.actuator.sea.i_motor * s.dphi_m * s.dphi_m);
  }
  Figure out = over_time("energy", "energy [J]", {links, motor});
  out.caption = "Kinetic and gravitational energy of the links (the floor is zero) and the motor's kinetic energy, " +
                f.falls[0].name + ".";
  return out;
}

}  // namespace

double link_energy(const Scene& scene, const Sample& s) {
  const TwoLinkDynamics<double> d(scene.robot);
  const double theta1 = s.phi0 + s.phi1, k = d.k1 * d.a;
  Pose<double> p{};
  p.s0 = std::sin(s.phi0), p.c0 = std::cos(s.phi0), p.s1 = std::sin(theta1), p.c1 = std::cos(theta1);
  p.omega0 = s.dphi0, p.omega1 = s.dphi0 + s.dphi1;
  // r_0 = r + k (-(s0 + s1), c0 + c1) with the common centre of mass r, see thigh_position.
  p.x = s.x0 + k * (p.s0 + p.s1), p.y = s.y0 - k * (p.c0 + p.c1);
  p.vx = s.dx0 + k * (p.omega0 * p.c0 + p.omega1 * p.c1), p.vy = s.dy0 + k * (p.omega0 * p.s0 + p.omega1 * p.s1);
  return kinetic_energy(d, p) + d.total_mass * d.gravity * p.y;
}

void show(const Falls& given, Report& report) {
  Falls f = given;
  const auto without_trajectory = [](const Landing& l) { return l.trajectory.size() < 2; };
  std::erase_if(f.falls, [&](const Fall& fall) { return without_trajectory(*fall.landing); });
  for (Fall& fall : f.falls) std::erase_if(fall.ghosts, without_trajectory);
  if (f.falls.empty() || f.figures == Falls::Figures::kLeaveOut) return;
  const double length = f.scene.robot.link_length;
  report.heading("The fall");
  Json landings = Json::array();
  for (const Fall& fall : f.falls) landings.push_back(animation(fall.name, *fall.landing, fall.ghosts, length));
  report.player({{"landings", landings}});
  if (const std::size_t ghosts = f.falls[0].ghosts.size(); ghosts > 0)
    report.paragraph(fmt::format("Thin: the same motion in {} scattered drops.", ghosts));
  Figure postures;
  postures.name = "postures", postures.width = Figure::Width::kWhole, postures.panel_height = 260;
  for (const Fall& fall : f.falls)
    if (!contact_peaks(fall.landing->peaks).empty()) postures.panels.push_back(postures_of(fall, length));
  postures.caption = "The robot at the acceleration peaks, with the contact that began each; thigh dark, shank blue.";
  report.figure(postures);
  report.figure(acceleration(f));
  Falls first_only = f;
  first_only.falls.resize(1, f.falls[0]);
  if (!contact_peaks(f.falls[0].landing->peaks).empty())
    report.figure(fall_picture(postures_of(f.falls[0], length), acceleration(first_only)));
  report.figure(components(f.falls[0]));
  report.figure(joint(f.falls[0]));
  report.figure(against_rating(f, "torque", "spring torque [Nm]", &Sample::tau_sea, f.actuator.sea.tau_max, "limit"));
  report.figure(against_rating(f, "speed", "motor speed [rad/s]", &Sample::dphi_m, f.actuator.speed_max, "rated"));
  report.figure(energy(f));
  if (!f.data.empty()) report.paragraph("The numbers of these figures: " + f.data + ".");
}

std::vector<std::string> fall_figures() {
  return {"fall", "postures", "acceleration", "components", "joint", "torque", "speed", "energy"};
}

}  // namespace ukemi::tools
