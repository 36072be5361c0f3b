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
  const double length = std::max(0.1, reach(scene.robot));
  ShownFalls out{.point = contact_name(scene.robot),
                 .symbol = "|a|",
                 .of = "the point that counts",
                 .posture = {1.5 * length, 1.15 * length, -0.45 * length, -0.25 * length, -0.6 * length, 1.3 * length,
                             scene.slope == 0},
                 .posture_words = "",
                 .data = data};
  for (const BodyFall& f : falls) {
    const std::vector<BodySample>& rows = f.landing->trajectory;
    const auto draw = [&](Panel& panel, double t, double x) {
      const BodySample& s = row_at(rows, t);
      add_links(panel, scene.robot, s, x - s.x[0]);
    };
    out.falls.push_back(
        {f.name, f.landing->peaks, animation(f.name, scene, *f.landing), curve(f.name, rows, &BodySample::acc), draw});
  }
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

}  // namespace ukemi::tools
