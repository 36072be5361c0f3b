#include "tools/report/fall.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "landing/body/places.hpp"
#include "tools/report/landing.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// A fall as the figures of any robot show it.
struct ShownFall {
  std::string name;
  const std::vector<landing::Peak>& peaks;
  Json animation;
  Series acceleration;
  std::function<void(Panel&, double t, double x)> draw;  ///< the robot at time t [s] with its origin at x [m]
};
struct ShownFalls {
  PointName point;
  std::string symbol, of;  ///< the acceleration: "|ddr_0|", "the thigh's centre of mass"
  /// Of postures [m]: distance to the next one; heights of number, peak and time; range. Whether the floor is level.
  struct Posture {
    double step, number, peak, time, low, high;
    bool floor;
  } posture;
  std::string posture_words, data;    ///< end of the postures' caption; name of the CSV with the numbers
  std::optional<double> limit = {};   ///< lower bound of the peak [m/s^2]
  std::size_t ghosts = 0;             ///< in the animation
  std::vector<ShownFall> falls = {};  ///< the first is the requested one
  std::vector<Figure> details = {};   ///< after the acceleration
};
/// A figure over the time from release, with a cursor that all such figures share.
Figure over_time(const std::string& name, const std::string& y_label, std::vector<Series> series) {
  Figure out = lines(name, "time from release [s]", y_label, std::move(series));
  out.cursor = Figure::Cursor::kTime;
  return out;
}

/// The first row at or after a time; rows are sorted by time.
template <class Sample>
const Sample& row_at(const std::vector<Sample>& rows, double t) {
  const auto after = std::lower_bound(rows.begin(), rows.end(), t, [](const Sample& s, double x) { return s.t < x; });
  return after == rows.end() ? rows.back() : *after;
}

/// The curves, all but the first dashed.
std::vector<Series> dashed(std::vector<Series> curves) {
  for (std::size_t i = 1; i < curves.size(); ++i) curves[i].style = Series::Style::kDashed;
  return curves;
}

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

/// Position of a place of a link in the world [m].
std::array<double, 2> position_of(const BodySample& s, int link, const landing::Place& p) {
  const std::size_t k = std::size_t(link);
  const double sine = std::sin(s.theta[k]), cosine = std::cos(s.theta[k]);
  return {s.x[k] + p.along * sine + p.across * cosine, s.y[k] - p.along * cosine + p.across * sine};
}

/// Draws the links of a sample, shifted by x [m].
void add_links(Panel& panel, const Robot& robot, const BodySample& s, double x) {
  for (int k = 0; k < int(robot.links.size()); ++k) {
    Series line{"", {}, {}, Series::Style::kThick, k == 0 ? Series::kInk : (k - 1) % 6};
    for (const landing::Place& p : outline(robot, k)) {
      const auto [px, py] = position_of(s, k, p);
      line.x.push_back(px + x), line.y.push_back(py);
    }
    panel.series.push_back(line);
  }
}

/// One panel per joint that is not locked.
Figure per_joint(const BodyScene& scene, const std::string& name, const std::string& unit,
                 const std::function<std::vector<Series>(std::size_t)>& series) {
  Figure out = over_time(name, "", {});
  out.panels.clear();
  for (std::size_t j = 0; j < scene.robot.joints.size(); ++j) {
    if (scene.robot.joints[j].kind == DriveKind::kLocked) continue;
    Panel p = lines(name, "time from release [s]", scene.robot.joints[j].name + " " + unit, series(j)).panels[0];
    out.panels.push_back(p);
  }
  return out;
}

/// Draws the floor, and the rail through the first link, within `half` of x = `middle` [m].
void add_guides(Panel& panel, const BodyScene& scene, const BodySample& s, double middle, double half) {
  const double floor = 0.99 * half;  // within the drawing, or it is not drawn
  if (scene.floor)
    panel.series.push_back({"floor",
                            {middle - floor, middle + floor},
                            {std::tan(scene.slope) * (middle - floor), std::tan(scene.slope) * (middle + floor)},
                            Series::Style::kLine,
                            Series::kGrey});
  if (scene.robot.base == Base::kRail) {
    const double dx = std::cos(scene.robot.rail_direction), dy = std::sin(scene.robot.rail_direction);
    panel.series.push_back({"rail",
                            {s.x[0] - half * dx, s.x[0] + half * dx},
                            {s.y[0] - half * dy, s.y[0] + half * dy},
                            Series::Style::kDashed,
                            Series::kGrey});
  }
}

/// Removes falls without a trajectory.
template <class Landed>
void remove_unplayed(std::vector<FallOf<Landed>>& falls) {
  const auto unplayed = [](const Landed& l) { return l.trajectory.size() < 2; };
  std::erase_if(falls, [&](const FallOf<Landed>& f) { return unplayed(*f.landing); });
  for (FallOf<Landed>& f : falls) std::erase_if(f.ghosts, unplayed);
}

/// A fall with its animation; draw(panel, row, x) draws a row of it.
template <class Landed, class Draw>
ShownFall shown(const FallOf<Landed>& f, Json animation, Draw draw) {
  const auto& rows = f.landing->trajectory;
  using Row = typename std::decay_t<decltype(rows)>::value_type;
  return {f.name, f.landing->peaks, std::move(animation), curve(f.name, rows, &Row::acc),
          [&rows, draw](Panel& panel, double t, double x) { draw(panel, row_at(rows, t), x); }};
}

}  // namespace

void show(const Falls& given, Report& report) {
  Falls f = given;
  remove_unplayed(f.falls);
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
  for (const Fall& fall : f.falls)
    out.falls.push_back(shown(fall, animation(fall.name, *fall.landing, fall.ghosts, l),
                              [l](Panel& panel, const Sample& row, double x) { add_links(panel, row, l, x); }));
  out.details = {components(f.falls[0]), joint(f.falls[0]),
                 against_rating(f, "torque", "spring torque [Nm]", &Sample::tau_sea, f.actuator.sea.tau_max, "limit"),
                 against_rating(f, "speed", "motor speed [rad/s]", &Sample::dphi_m, f.actuator.speed_max, "rated"),
                 energy(f)};
  show(std::move(out), report);
}

Figure drawing(const BodyScene& given) {
  BodyScene scene = given;
  scene.t_end = 1e-6;
  const BodyLanding l = simulate(scene, held_posture(scene), {}, 1000);
  Figure out;
  out.name = "robot", out.panel_height = 480;
  Panel panel;
  panel.scale = Panel::Scale::kBare;
  if (l.trajectory.empty()) return out;
  const BodySample& s = l.trajectory.front();
  const Robot& robot = scene.robot;
  add_links(panel, robot, s, 0);
  Series joints{"joints", {}, {}, Series::Style::kPoints, Series::kGrey},
      masses{"centres of mass", {}, {}, Series::Style::kPoints, 2},
      contacts{"contacts", {}, {}, Series::Style::kPoints, 1},
      peak{"the point that counts", {}, {}, Series::Style::kPoints, 3};
  const auto add = [&](Series& to, int link, const landing::Place& p) {
    const auto [x, y] = position_of(s, link, p);
    to.x.push_back(x), to.y.push_back(y);
  };
  for (int k = 0; k < int(robot.links.size()); ++k) {
    add(masses, k, robot.links[std::size_t(k)].com);
    if (robot.joint_of(k)) add(joints, k, {});
  }
  double low = scene.floor ? 0 : s.y[0], high = low, left = s.x[0], right = left;
  const auto label = [&](const std::string& text, double x, double y, double offset) {
    panel.marks.push_back({x + offset, y, text});
    low = std::min(low, y), high = std::max(high, y), left = std::min(left, x), right = std::max(right, x);
  };
  const double gap = 0.12 * reach(robot) + 0.02;  // between a label and its point [m]
  for (const ContactPoint& c : robot.contacts) {
    add(contacts, c.link, c.at);
    const bool outside = contacts.x.back() >= masses.x[std::size_t(c.link)];
    label(c.name, contacts.x.back(), contacts.y.back(), outside ? gap : -gap);
  }
  for (int k = 0; k < int(robot.links.size()); ++k)
    label(robot.links[std::size_t(k)].name, masses.x[std::size_t(k)], masses.y[std::size_t(k)] + 0.4 * gap, -gap);
  add(peak, robot.peak_link, robot.peak);
  const double room = 0.1 * (high - low) + 0.03, middle = 0.5 * (left + right),
               half = 1.15 * (0.5 * (high - low) + room);  // the drawing is somewhat wider than it is high
  panel.y_range = {low - room, high + room}, panel.x_range = {middle - half, middle + half};
  add_guides(panel, scene, s, middle, half);
  for (Series* series : {&joints, &contacts, &masses, &peak})
    if (!series->x.empty()) panel.series.push_back(*series);
  out.panels.push_back(panel);
  out.caption = "The robot as it is released.";
  return out;
}

void show(const BodyScene& scene, std::vector<BodyFall> falls, const std::string& data, Report& report) {
  remove_unplayed(falls);
  if (falls.empty()) return;
  const double length = std::max(0.1, reach(scene.robot));
  ShownFalls out{.point = contact_name(scene.robot),
                 .symbol = "|a|",
                 .of = "the point that counts",
                 .posture = {1.5 * length, 1.15 * length, -0.45 * length, -0.25 * length, -0.6 * length, 1.3 * length,
                             scene.slope == 0},
                 .posture_words = "",
                 .data = data};
  for (const BodyFall& f : falls)
    out.falls.push_back(shown(
        f, animation(f.name, scene, *f.landing),
        [&](Panel& panel, const BodySample& row, double x) { add_links(panel, scene.robot, row, x - row.x[0]); }));
  const std::vector<BodySample>& first = falls[0].landing->trajectory;
  Figure joint = per_joint(scene, "joint", "[deg]", [&](std::size_t j) {
    std::vector<Series> series{curve("angle", first, [j](auto& s) { return s.phi[j] * kDegrees; })};
    if (scene.robot.joints[j].driven())
      series.push_back(curve("reference", first, [j](auto& s) { return s.phi_ref[j] * kDegrees; }));
    return dashed(series);
  });
  joint.caption = "The joints against their references, " + falls[0].name + ".";
  Figure torque = per_joint(scene, "torque", "[Nm]", [&](std::size_t j) {
    std::vector<Series> series;
    for (const BodyFall& f : falls)
      series.push_back(curve(f.name, f.landing->trajectory, [j](auto& s) { return s.tau[j]; }));
    return dashed(series);
  });
  torque.caption = "Torques of the joints on their outer links.";
  Figure energy = over_time("energy", "energy [J]", {curve("links", first, &BodySample::energy)});
  energy.caption = "Kinetic and gravitational energy of the links, " + falls[0].name + ".";
  out.details = {joint, torque, energy};
  show(std::move(out), report);
}

std::vector<std::string> fall_figures() {
  return {"fall", "postures", "acceleration", "components", "joint", "torque", "speed", "energy"};
}

}  // namespace ukemi::tools
