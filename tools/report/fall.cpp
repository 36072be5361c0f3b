#include "tools/report/fall.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/report/landing.hpp"

namespace ukemi::tools {

using namespace landing;

Figure over_time(const std::string& name, const std::string& y_label, std::vector<Series> series) {
  Figure out = lines(name, "time from release [s]", y_label, std::move(series));
  out.cursor = Figure::Cursor::kTime;
  return out;
}

std::vector<Series> dashed(std::vector<Series> curves) {
  for (std::size_t i = 1; i < curves.size(); ++i) curves[i].style = Series::Style::kDashed;
  return curves;
}

namespace {

/// "①", as fall.js has it.
std::string circled(std::size_t n) {
  if (n > 20) return fmt::format("({})", n);
  return std::string("\xE2\x91") + char(0x9F + n);  // U+2460 and on
}
/// Marks the peaks with their numbers.
void add_marks(Panel& panel, const std::vector<Peak>& all, int colour) {
  const std::vector<Peak> peaks = contact_peaks(all);
  for (std::size_t n = 0; n < peaks.size(); ++n)
    panel.marks.push_back({peaks[n].t, peaks[n].acceleration, circled(n + 1), colour});
}

/// Postures at the peaks side by side.
Panel postures_of(const ShownFalls& all, const ShownFall& f) {
  constexpr std::size_t kMaxPostures = 7;
  Panel out;
  out.title = f.name, out.scale = Panel::Scale::kBare;
  const ShownFalls::Posture& at = all.posture;
  const std::vector<Peak> peaks = contact_peaks(f.peaks);
  for (std::size_t n = 0; n < std::min(kMaxPostures, peaks.size()); ++n) {
    const double x = at.step * double(n);
    f.draw(out, peaks[n].t, x);
    out.marks.push_back({x, at.number, circled(n + 1)});
    out.marks.push_back({x, at.peak, fmt::format("{} {:.0f} m/s^2", all.point(peaks[n].point), peaks[n].acceleration)});
    out.marks.push_back({x, at.time, fmt::format("{:.3f} s", peaks[n].t)});
  }
  out.x_range = {-at.step / 2, at.step * (double(std::clamp<std::size_t>(peaks.size(), 3, kMaxPostures)) - 0.5)};
  out.y_range = {at.low, at.high};
  if (at.floor)
    out.series.push_back({"", {out.x_range->at(0), out.x_range->at(1)}, {0, 0}, Series::Style::kLine, Series::kGrey});
  return out;
}

/// The acceleration in the first falls.
Figure acceleration(const ShownFalls& all, std::size_t count) {
  std::vector<Series> series;
  for (std::size_t i = 0; i < count; ++i) series.push_back(all.falls[i].acceleration);
  Figure out = over_time("acceleration", all.symbol + " [m/s^2]", dashed(series));
  for (std::size_t i = 0; i < count; ++i) add_marks(out.panels[0], all.falls[i].peaks, int(i));
  if (all.limit) out.panels[0].levels.push_back({*all.limit, fmt::format("no motion is below {:.1f}", *all.limit)});
  out.width = Figure::Width::kWhole, out.panel_height = 320;
  out.caption = fmt::format("Acceleration of {}, its norm; the numbers are those of the postures.", all.of);
  return out;
}

/// Fig. 6 and 7 of [1] in one figure, for a file: the postures at the peaks above the acceleration.
Figure fall_picture(Panel postures, Figure acceleration) {
  Figure out = std::move(acceleration);
  out.name = "fall", out.target = Figure::Target::kFile, out.panel_height = 240, out.cursor = Figure::Cursor::kNone;
  out.panels.insert(out.panels.begin(), std::move(postures));
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
                         dashed({curve("phi_1", f.landing->trajectory, &Sample::phi1, kDegrees),
                                 curve("reference", f.landing->trajectory, &Sample::phi_ref, kDegrees)}));
  out.caption = "The joint against its reference, " + f.name + ".";
  return out;
}

/// A quantity of the drive in every fall, with lines at +- its rating.
Figure against_rating(const Falls& f, const std::string& name, const std::string& y_label, double Sample::*column,
                      std::optional<double> rating, const std::string& rating_words) {
  std::vector<Series> series;
  for (const Fall& fall : f.falls) series.push_back(curve(fall.name, fall.landing->trajectory, column));
  Figure out = over_time(name, y_label, dashed(series));
  if (rating && std::isfinite(*rating))
    for (const double sign : {1.0, -1.0})
      out.panels[0].levels.push_back({sign * *rating, fmt::format("{} {:g}", rating_words, sign * *rating)});
  return out;
}

Figure energy(const Falls& f) {
  const std::vector<Sample>& rows = f.falls[0].landing->trajectory;
  Series motor{"motor", {}, {}};
  for (const Sample& s : rows)
    motor.x.push_back(s.t), motor.y.push_back(0.5 * f.actuator.sea.i_motor * s.dphi_m * s.dphi_m);
  Figure out = over_time("energy", "energy [J]", {curve("both links", rows, &Sample::energy), motor});
  out.caption = "Kinetic and gravitational energy of the links (the floor is zero) and the motor's kinetic energy, " +
                f.falls[0].name + ".";
  return out;
}

/// Draws thigh and shank.
void add_links(Panel& panel, const Sample& s, double length, double x) {
  const double theta[] = {s.phi0, s.phi0 + s.phi1}, half = length / 2;
  const double hip_x = x - half * std::sin(theta[0]), hip_y = s.y0 + half * std::cos(theta[0]),
               knee_x = x + half * std::sin(theta[0]), knee_y = s.y0 - half * std::cos(theta[0]);
  panel.series.push_back({"", {hip_x, knee_x}, {hip_y, knee_y}, Series::Style::kThick, Series::kInk});
  panel.series.push_back({"",
                          {knee_x, knee_x + length * std::sin(theta[1])},
                          {knee_y, knee_y - length * std::cos(theta[1])},
                          Series::Style::kThick,
                          0});
}

}  // namespace

void show(ShownFalls all, Report& report) {
  report.heading("The fall");
  Json landings = Json::array();
  for (ShownFall& f : all.falls) landings.push_back(std::move(f.animation));
  report.player({{"landings", landings}});
  if (all.ghosts > 0) report.paragraph(fmt::format("Thin: the same motion in {} scattered drops.", all.ghosts));
  Figure postures;
  postures.name = "postures", postures.width = Figure::Width::kWhole, postures.panel_height = 260;
  for (const ShownFall& f : all.falls)
    if (!contact_peaks(f.peaks).empty()) postures.panels.push_back(postures_of(all, f));
  postures.caption = "The robot at the acceleration peaks, with the contact that began each" + all.posture_words + ".";
  report.figure(postures);
  report.figure(acceleration(all, all.falls.size()));
  if (!contact_peaks(all.falls[0].peaks).empty())
    report.figure(fall_picture(postures_of(all, all.falls[0]), acceleration(all, 1)));
  for (Figure& detail : all.details) report.figure(std::move(detail));
  if (!all.data.empty()) report.paragraph("The numbers of these figures: " + all.data + ".");
}

void show(const Falls& given, Report& report) {
  Falls f = given;
  const auto without_trajectory = [](const Landing& l) { return l.trajectory.size() < 2; };
  std::erase_if(f.falls, [&](const Fall& fall) { return without_trajectory(*fall.landing); });
  for (Fall& fall : f.falls) std::erase_if(fall.ghosts, without_trajectory);
  if (f.falls.empty()) return;
  const double l = f.scene.robot.link_length;
  ShownFalls out{.point = point_name,
                 .symbol = "|ddr_0|",
                 .of = "the thigh's centre of mass",
                 .posture = {2.6 * l, 2.0 * l, -0.8 * l, -0.4 * l, -1.0 * l, 2.2 * l, true},
                 .posture_words = "; thigh dark, shank blue",
                 .data = f.data,
                 .limit = f.limit,
                 .ghosts = f.falls[0].ghosts.size()};
  for (const Fall& fall : f.falls) {
    const std::vector<Sample>& rows = fall.landing->trajectory;
    out.falls.push_back({fall.name, fall.landing->peaks, animation(fall.name, *fall.landing, fall.ghosts, l),
                         curve(fall.name, rows, &Sample::acc),
                         [&rows, l](Panel& panel, double t, double x) { add_links(panel, row_at(rows, t), l, x); }});
  }
  out.details = {components(f.falls[0]), joint(f.falls[0]),
                 against_rating(f, "torque", "spring torque [Nm]", &Sample::tau_sea, f.actuator.sea.tau_max, "limit"),
                 against_rating(f, "speed", "motor speed [rad/s]", &Sample::dphi_m, f.actuator.speed_max, "rated"),
                 energy(f)};
  show(std::move(out), report);
}

std::vector<std::string> fall_figures() {
  return {"fall", "postures", "acceleration", "components", "joint", "torque", "speed", "energy"};
}

}  // namespace ukemi::tools
