#include "tools/report/animation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "landing/body/places.hpp"
#include "tools/report/page/kept_rows.hpp"

namespace ukemi::tools {

using namespace landing;

std::string point_name(int point) { return kPointNames[std::size_t(point)]; }
PointName contact_name(const Robot& robot) {
  return [&robot](int contact) { return robot.contacts[std::size_t(contact)].name; };
}

std::vector<Peak> contact_peaks(const std::vector<Peak>& peaks) {
  std::vector<Peak> out;
  for (const Peak& p : peaks)
    if (p.point >= 0) out.push_back(p);
  return out;
}
Json peaks_json(const std::vector<Peak>& peaks, const PointName& name) {
  Json out = Json::array();
  for (const Peak& p : contact_peaks(peaks))
    out.push_back({{"n", out.size() + 1}, {"t", p.t}, {"acceleration", p.acceleration}, {"contact", name(p.point)}});
  return out;
}

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
    std::vector<std::pair<double, landing::Place>> sorted;
    for (const landing::Place& p : all) sorted.push_back({along(p), p});
    std::sort(sorted.begin(), sorted.end(), [](auto& a, auto& b) { return a.first < b.first; });
    all.clear();
    for (const auto& [at, p] : sorted) all.push_back(p);
    return all;
  }
  std::sort(all.begin(), all.end(),
            [&](const landing::Place& a, const landing::Place& b) { return angle(a) < angle(b); });
  all.push_back(all.front());
  return all;
}

namespace {

/// Columns of the rows of a trajectory that the page shows: no peak of the acceleration and of `force` is lost.
template <class Row>
class Columns {
 public:
  using Value = std::function<double(const Row&)>;
  Columns(const std::vector<Row>& rows, const Value& force) : rows_(rows) {
    constexpr std::size_t kMaxFrames = 600;  // bound on the parts into which kept_rows divides
    std::vector<double> acc, forces;
    for (const Row& s : rows) acc.push_back(s.acc), forces.push_back(force(s));
    frames_ = kept_rows({&acc, &forces}, kMaxFrames);
  }
  /// Rounded to multiples of `unit`.
  Json operator()(const Value& value, double unit) const {
    Json out = Json::array();
    for (const std::size_t i : frames_) out.push_back(std::round(value(rows_[i]) / unit) / std::round(1 / unit));
    return out;
  }

 private:
  const std::vector<Row>& rows_;
  std::vector<std::size_t> frames_;
};

Columns<Sample> columns_of(const Landing& l) {
  return {l.trajectory,
          [](auto& s) { return std::sqrt(s.force[kHip][0] * s.force[kHip][0] + s.force[kHip][1] * s.force[kHip][1]); }};
}

/// Times and poses.
Json motion_of(const Columns<Sample>& column, double unit) {
  Json out;
  const std::pair<const char*, double Sample::*> columns[] = {
      {"t", &Sample::t}, {"x", &Sample::x0}, {"y", &Sample::y0}, {"phi_0", &Sample::phi0}, {"phi_1", &Sample::phi1}};
  for (const auto& [name, member] : columns) out[name] = column(member, unit);
  return out;
}

Json place_json(const landing::Place& p) { return {p.along, p.across}; }

}  // namespace

Json animation(const std::string& name, const Landing& landing, const std::vector<Landing>& ghosts, double length) {
  const Columns<Sample> column = columns_of(landing);
  Json out = {{"name", name}, {"length", length}, {"peaks", peaks_json(landing.peaks)}};
  out.update(motion_of(column, 1e-6));
  for (const Landing& ghost : ghosts) out["ghosts"].push_back(motion_of(columns_of(ghost), 1e-4));
  out["acc"] = column(&Sample::acc, 1e-2);
  for (std::size_t j = 0; j < std::size_t(kPoints); ++j)
    out["force"].push_back(Json::array({column([j](const Sample& s) { return s.force[j][0]; }, 1e-2),
                                        column([j](const Sample& s) { return s.force[j][1]; }, 1e-2)}));
  return out;
}

Json animation(const std::string& name, const BodyScene& scene, const BodyLanding& landing) {
  const Robot& robot = scene.robot;
  const Columns<BodySample> column(landing.trajectory,
                                   [](auto& s) { return std::accumulate(s.force_y.begin(), s.force_y.end(), 0.0); });
  Json out = {
      {"name", name}, {"peaks", peaks_json(landing.peaks, contact_name(robot))}, {"slope", std::tan(scene.slope)}};
  out["t"] = column(&BodySample::t, 1e-6);
  out["acc"] = column(&BodySample::acc, 1e-2);
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

}  // namespace ukemi::tools
