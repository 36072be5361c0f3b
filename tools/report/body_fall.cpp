#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tools/report/body.hpp"
#include "tools/report/fall.hpp"
#include "tools/report/landing.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// A link as it is drawn: through its places, closed where they are not in a line; a body of no length as a small
/// square.
std::vector<landing::Place> outline(const Robot& robot, int link) {
  constexpr double kSquare = 0.02, kFlat = 1e-6;  // [m], [m^2]
  std::vector<landing::Place> all = places(robot, link);
  if (all.size() == 1)
    return {{-kSquare, -kSquare}, {-kSquare, kSquare}, {kSquare, kSquare}, {kSquare, -kSquare}, {-kSquare, -kSquare}};
  double area = 0;
  landing::Place middle;
  for (const landing::Place& p : all)
    middle.along += p.along / double(all.size()), middle.across += p.across / double(all.size());
  for (const landing::Place& p : all)
    for (const landing::Place& q : all)
      area = std::max(area, std::abs((p.along - middle.along) * (q.across - middle.across) -
                                     (p.across - middle.across) * (q.along - middle.along)));
  const auto angle = [&](const landing::Place& p) {
    return std::atan2(p.across - middle.across, p.along - middle.along);
  };
  const auto along = [&](const landing::Place& p) {
    const landing::Place &a = all.front(), &b = all.back();
    return (p.along - a.along) * (b.along - a.along) + (p.across - a.across) * (b.across - a.across);
  };
  if (area < kFlat) {
    std::vector<std::pair<double, landing::Place>> order;
    for (const landing::Place& p : all) order.push_back({along(p), p});
    std::sort(order.begin(), order.end(), [](auto& a, auto& b) { return a.first < b.first; });
    all.clear();
    for (const auto& [at, p] : order) all.push_back(p);
    return all;
  }
  std::sort(all.begin(), all.end(),
            [&](const landing::Place& a, const landing::Place& b) { return angle(a) < angle(b); });
  all.push_back(all.front());
  return all;
}

/// Where a place of a link is.
std::array<double, 2> at(const BodySample& s, int link, const landing::Place& p) {
  const std::size_t k = std::size_t(link);
  const double sine = std::sin(s.theta[k]), cosine = std::cos(s.theta[k]);
  return {s.x[k] + p.along * sine + p.across * cosine, s.y[k] - p.along * cosine + p.across * sine};
}

/// The rows that the animation needs: no more than the eye sees, and every peak.
std::vector<std::size_t> frames_of(const BodyLanding& l) {
  constexpr std::size_t kMost = 600;
  std::vector<double> acc, force;
  for (const BodySample& s : l.trajectory) {
    acc.push_back(s.acc);
    double sum = 0;
    for (const double f : s.force_y) sum += f;
    force.push_back(sum);
  }
  return kept_rows({&acc, &force}, kMost);
}

Json place_json(const landing::Place& p) { return {p.along, p.across}; }

Json animation_of(const BodyScene& scene, const BodyFall& f) {
  const Robot& robot = scene.robot;
  const std::vector<std::size_t> frames = frames_of(*f.landing);
  const auto column = [&](const std::function<double(const BodySample&)>& value, double unit) {
    Json out = Json::array();
    for (const std::size_t i : frames)
      out.push_back(std::round(value(f.landing->trajectory[i]) / unit) / std::round(1 / unit));
    return out;
  };
  Json out = {
      {"name", f.name}, {"peaks", peaks_json(f.landing->peaks, contact_name(robot))}, {"slope", std::tan(scene.slope)}};
  out["t"] = column([](auto& s) { return s.t; }, 1e-6);
  out["acc"] = column([](auto& s) { return s.acc; }, 1e-2);
  for (std::size_t k = 0; k < robot.links.size(); ++k) {
    Json link = {{"points", Json::array()}};
    for (const landing::Place& p : outline(robot, int(k))) link["points"].push_back(place_json(p));
    link["x"] = column([k](auto& s) { return s.x[k]; }, 1e-5),
    link["y"] = column([k](auto& s) { return s.y[k]; }, 1e-5);
    link["theta"] = column([k](auto& s) { return s.theta[k]; }, 1e-5);
    out["links"].push_back(link);
  }
  out["contacts"] = Json::array(), out["force"] = Json::array(), out["joints"] = Json::array();
  for (std::size_t k = 0; k < robot.contacts.size(); ++k) {
    const ContactPoint& c = robot.contacts[k];
    out["contacts"].push_back({{"name", c.name}, {"link", c.link}, {"at", place_json(c.at)}});
    out["force"].push_back(Json::array(
        {column([k](auto& s) { return s.force_x[k]; }, 1e-2), column([k](auto& s) { return s.force_y[k]; }, 1e-2)}));
  }
  for (std::size_t k = 0; k < robot.joints.size(); ++k)
    out["joints"].push_back({{"name", robot.joints[k].name}, {"phi", column([k](auto& s) { return s.phi[k]; }, 1e-4)}});
  if (robot.base == Base::kRail) out["rail"] = {std::cos(robot.rail_direction), std::sin(robot.rail_direction)};
  out["peak"] = {{"link", robot.peak_link}, {"at", place_json(robot.peak)}};
  return out;
}

/// The links of a row, moved by so much in x.
void add_links(Panel& panel, const Robot& robot, const BodySample& s, double x, double y = 0) {
  for (int k = 0; k < int(robot.links.size()); ++k) {
    Series line{"", {}, {}, Series::Look::kThick, k == 0 ? Series::kInk : (k - 1) % 6};
    for (const landing::Place& p : outline(robot, k)) {
      const auto [px, py] = at(s, k, p);
      line.x.push_back(px + x), line.y.push_back(py + y);
    }
    panel.series.push_back(line);
  }
}

/// The postures at the peaks beside each other, as far apart as they are long.
Panel postures_of(const BodyScene& scene, const BodyFall& f) {
  constexpr std::size_t kMost = 7;
  Panel out;
  out.title = f.name, out.scale = Panel::Scale::kBare;
  const double length = std::max(0.1, reach(scene.robot)), step = 1.5 * length;
  const std::vector<Peak> peaks = numbered(f.landing->peaks);
  for (std::size_t n = 0; n < std::min(kMost, peaks.size()); ++n) {
    const BodySample& s = row_at(f.landing->trajectory, peaks[n].t);
    const double x = step * double(n);
    add_links(out, scene.robot, s, x - s.x[0]);
    out.marks.push_back({x, 1.15 * length, circled(n + 1)});
    out.marks.push_back({x, -0.45 * length,
                         fmt::format("{} {:.0f} m/s^2", scene.robot.contacts[std::size_t(peaks[n].point)].name,
                                     peaks[n].acceleration)});
    out.marks.push_back({x, -0.25 * length, fmt::format("{:.3f} s", peaks[n].t)});
  }
  out.x_range = {-step / 2, step * (double(std::clamp<std::size_t>(peaks.size(), 3, kMost)) - 0.5)};
  out.y_range = {-0.6 * length, 1.3 * length};
  if (scene.slope == 0)
    out.series.push_back({"", {out.x_range->at(0), out.x_range->at(1)}, {0, 0}, Series::Look::kLine, Series::kGrey});
  return out;
}

Series curve(const std::string& name, const BodyLanding& l, const std::function<double(const BodySample&)>& value,
             Series::Look look = Series::Look::kLine) {
  Series out{name, {}, {}, look};
  for (const BodySample& s : l.trajectory) out.x.push_back(s.t), out.y.push_back(value(s));
  return out;
}
Figure acceleration(const std::vector<BodyFall>& falls) {
  std::vector<Series> series;
  for (const BodyFall& f : falls)
    series.push_back(curve(
        f.name, *f.landing, [](auto& s) { return s.acc; },
        series.empty() ? Series::Look::kLine : Series::Look::kDashed));
  Figure out = over_time("acceleration", "|a| [m/s^2]", series);
  for (std::size_t i = 0; i < falls.size(); ++i) add_marks(out.panels[0], falls[i].landing->peaks, int(i));
  out.width = Figure::Width::kWhole, out.panel_height = 320;
  out.caption = "Acceleration of the point that counts, its norm; the numbers are those of the postures.";
  return out;
}

/// One panel a joint.
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
  Series joints{"joints", {}, {}, Series::Look::kPoints, Series::kGrey},
      masses{"centres of mass", {}, {}, Series::Look::kPoints, 2},
      contacts{"contacts", {}, {}, Series::Look::kPoints, 1},
      peak{"the point that counts", {}, {}, Series::Look::kPoints, 3};
  const auto add = [&](Series& to, int link, const landing::Place& p) {
    const auto [x, y] = at(s, link, p);
    to.x.push_back(x), to.y.push_back(y);
  };
  for (int k = 0; k < int(robot.links.size()); ++k) {
    add(masses, k, robot.links[std::size_t(k)].com);
    if (robot.joint_of(k)) add(joints, k, {});
  }
  double low = scene.floor ? 0 : s.y[0], high = low, left = s.x[0], right = left;
  const auto name = [&](const std::string& text, double x, double y, double side) {
    panel.marks.push_back({x + side, y, text});
    low = std::min(low, y), high = std::max(high, y), left = std::min(left, x), right = std::max(right, x);
  };
  const double beside = 0.12 * reach(robot) + 0.02;  // a name stands so far beside what it names [m]
  for (const ContactPoint& c : robot.contacts) {
    add(contacts, c.link, c.at);
    const bool outside = contacts.x.back() >= masses.x[std::size_t(c.link)];
    name(c.name, contacts.x.back(), contacts.y.back(), outside ? beside : -beside);
  }
  for (int k = 0; k < int(robot.links.size()); ++k)
    name(robot.links[std::size_t(k)].name, masses.x[std::size_t(k)], masses.y[std::size_t(k)] + 0.4 * beside, -beside);
  add(peak, robot.peak_link, robot.peak);
  const double room = 0.1 * (high - low) + 0.03, middle = 0.5 * (left + right),
               half = 1.15 * (0.5 * (high - low) + room);  // the drawing is somewhat wider than it is high
  const double floor = 0.99 * half;                        // within the drawing, or it is not drawn
  panel.y_range = {low - room, high + room}, panel.x_range = {middle - half, middle + half};
  if (scene.floor)
    panel.series.push_back({"floor",
                            {middle - floor, middle + floor},
                            {std::tan(scene.slope) * (middle - floor), std::tan(scene.slope) * (middle + floor)},
                            Series::Look::kLine,
                            Series::kGrey});
  if (robot.base == Base::kRail) {
    const double dx = std::cos(robot.rail_direction), dy = std::sin(robot.rail_direction);
    panel.series.push_back({"rail",
                            {s.x[0] - half * dx, s.x[0] + half * dx},
                            {s.y[0] - half * dy, s.y[0] + half * dy},
                            Series::Look::kDashed,
                            Series::kGrey});
  }
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
  for (const BodyFall& f : falls) landings.push_back(animation_of(scene, f));
  report.player({{"landings", landings}});
  Figure postures;
  postures.name = "postures", postures.width = Figure::Width::kWhole, postures.panel_height = 260;
  for (const BodyFall& f : falls)
    if (!numbered(f.landing->peaks).empty()) postures.panels.push_back(postures_of(scene, f));
  postures.caption = "The robot at the acceleration peaks, with the contact that began each.";
  report.figure(postures);
  report.figure(acceleration(falls));
  if (!numbered(falls[0].landing->peaks).empty())
    report.figure(fall_picture(postures_of(scene, falls[0]), acceleration({falls[0]})));
  const BodyLanding& first = *falls[0].landing;
  Figure joint = per_joint(scene, "joint", "[deg]", [&](std::size_t j) {
    std::vector<Series> out{curve("angle", first, [j](auto& s) { return s.phi[j] * kDegrees; })};
    if (scene.robot.joints[j].driven())
      out.push_back(curve(
          "reference", first, [j](auto& s) { return s.phi_ref[j] * kDegrees; }, Series::Look::kDashed));
    return out;
  });
  joint.caption = "The joints against their references, " + falls[0].name + ".";
  report.figure(joint);
  Figure torque = per_joint(scene, "torque", "[Nm]", [&](std::size_t j) {
    std::vector<Series> out;
    for (const BodyFall& f : falls)
      out.push_back(curve(
          f.name, *f.landing, [j](auto& s) { return s.tau[j]; },
          out.empty() ? Series::Look::kLine : Series::Look::kDashed));
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
