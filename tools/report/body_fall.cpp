#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "landing/body/places.hpp"
#include "tools/report/body.hpp"
#include "tools/report/fall.hpp"
#include "tools/report/landing.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// Position of a place of a link in the world [m].
std::array<double, 2> position_of(const BodySample& s, int link, const landing::Place& p) {
  const std::size_t k = std::size_t(link);
  const double sine = std::sin(s.theta[k]), cosine = std::cos(s.theta[k]);
  return {s.x[k] + p.along * sine + p.across * cosine, s.y[k] - p.along * cosine + p.across * sine};
}

/// Draws the links of a sample, shifted by (x, y) [m].
void add_links(Panel& panel, const Robot& robot, const BodySample& s, double x, double y = 0) {
  for (int k = 0; k < int(robot.links.size()); ++k) {
    Series line{"", {}, {}, Series::Style::kThick, k == 0 ? Series::kInk : (k - 1) % 6};
    for (const landing::Place& p : outline(robot, k)) {
      const auto [px, py] = position_of(s, k, p);
      line.x.push_back(px + x), line.y.push_back(py + y);
    }
    panel.series.push_back(line);
  }
}

/// Postures at the peaks side by side.
Panel postures_of(const BodyScene& scene, const BodyFall& f) {
  constexpr std::size_t kMaxPostures = 7;
  Panel out;
  out.title = f.name, out.scale = Panel::Scale::kBare;
  const double length = std::max(0.1, reach(scene.robot)), step = 1.5 * length;
  const std::vector<Peak> peaks = contact_peaks(f.landing->peaks);
  for (std::size_t n = 0; n < std::min(kMaxPostures, peaks.size()); ++n) {
    const BodySample& s = row_at(f.landing->trajectory, peaks[n].t);
    const double x = step * double(n);
    add_links(out, scene.robot, s, x - s.x[0]);
    out.marks.push_back({x, 1.15 * length, circled(n + 1)});
    out.marks.push_back({x, -0.45 * length,
                         fmt::format("{} {:.0f} m/s^2", scene.robot.contacts[std::size_t(peaks[n].point)].name,
                                     peaks[n].acceleration)});
    out.marks.push_back({x, -0.25 * length, fmt::format("{:.3f} s", peaks[n].t)});
  }
  out.x_range = {-step / 2, step * (double(std::clamp<std::size_t>(peaks.size(), 3, kMaxPostures)) - 0.5)};
  out.y_range = {-0.6 * length, 1.3 * length};
  if (scene.slope == 0)
    out.series.push_back({"", {out.x_range->at(0), out.x_range->at(1)}, {0, 0}, Series::Style::kLine, Series::kGrey});
  return out;
}

Series curve(const std::string& name, const BodyLanding& l, const std::function<double(const BodySample&)>& value,
             Series::Style style = Series::Style::kLine) {
  Series out{name, {}, {}, style};
  for (const BodySample& s : l.trajectory) out.x.push_back(s.t), out.y.push_back(value(s));
  return out;
}
Figure acceleration(const std::vector<BodyFall>& falls) {
  std::vector<Series> series;
  for (const BodyFall& f : falls)
    series.push_back(curve(
        f.name, *f.landing, [](auto& s) { return s.acc; },
        series.empty() ? Series::Style::kLine : Series::Style::kDashed));
  Figure out = over_time("acceleration", "|a| [m/s^2]", series);
  for (std::size_t i = 0; i < falls.size(); ++i) add_marks(out.panels[0], falls[i].landing->peaks, int(i));
  out.width = Figure::Width::kWhole, out.panel_height = 320;
  out.caption = "Acceleration of the point that counts, its norm; the numbers are those of the postures.";
  return out;
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

}  // namespace

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
  std::erase_if(falls, [](const BodyFall& f) { return f.landing->trajectory.size() < 2; });
  if (falls.empty()) return;
  report.heading("The fall");
  Json landings = Json::array();
  for (const BodyFall& f : falls) landings.push_back(animation(f.name, scene, *f.landing));
  report.player({{"landings", landings}});
  Figure postures;
  postures.name = "postures", postures.width = Figure::Width::kWhole, postures.panel_height = 260;
  for (const BodyFall& f : falls)
    if (!contact_peaks(f.landing->peaks).empty()) postures.panels.push_back(postures_of(scene, f));
  postures.caption = "The robot at the acceleration peaks, with the contact that began each.";
  report.figure(postures);
  report.figure(acceleration(falls));
  if (!contact_peaks(falls[0].landing->peaks).empty())
    report.figure(fall_picture(postures_of(scene, falls[0]), acceleration({falls[0]})));
  const BodyLanding& first = *falls[0].landing;
  Figure joint = per_joint(scene, "joint", "[deg]", [&](std::size_t j) {
    std::vector<Series> out{curve("angle", first, [j](auto& s) { return s.phi[j] * kDegrees; })};
    if (scene.robot.joints[j].driven())
      out.push_back(curve(
          "reference", first, [j](auto& s) { return s.phi_ref[j] * kDegrees; }, Series::Style::kDashed));
    return out;
  });
  joint.caption = "The joints against their references, " + falls[0].name + ".";
  report.figure(joint);
  Figure torque = per_joint(scene, "torque", "[Nm]", [&](std::size_t j) {
    std::vector<Series> out;
    for (const BodyFall& f : falls)
      out.push_back(curve(
          f.name, *f.landing, [j](auto& s) { return s.tau[j]; },
          out.empty() ? Series::Style::kLine : Series::Style::kDashed));
    return out;
  });
  torque.caption = "Torques of the joints on their outer links.";
  report.figure(torque);
  Figure energy = over_time("energy", "energy [J]", {curve("links", first, [](auto& s) { return s.energy; })});
  energy.caption = "Kinetic and gravitational energy of the links, " + falls[0].name + ".";
  report.figure(energy);
  if (!data.empty()) report.paragraph("The numbers of these figures: " + data + ".");
}

}  // namespace ukemi::tools
