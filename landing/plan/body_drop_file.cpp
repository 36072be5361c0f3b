#include "landing/plan/body_drop_file.hpp"

#include <algorithm>
#include <cmath>

#include "common/degrees.hpp"
#include "common/error.hpp"
#include "landing/plan/design_numbers.hpp"
#include "landing/scatter/drop_file.hpp"

namespace ukemi::landing {

namespace {

/// The name of a design number in tables of drops.
std::string column_name(const std::string& design) {
  for (const char* prefix : {"drop.", "detection."})
    if (design.starts_with(prefix)) return design.substr(std::string(prefix).size());
  return design == "floor.slope_deg" ? "slope_deg" : design;
}
/// Whether a design number is made of others, which stand beside it.
bool is_composed(const std::string& design) {
  return design.find('*') != std::string::npos || design.ends_with(".length") ||
         (design.starts_with("floor.") && design != "floor.slope_deg");
}

/// at(drop): the number of a drop, constant or not.
template <class At>
BodyDropColumn column(const std::string& name, double unit, At at) {
  return {name, [=](const BodyDrop& d) { return at(d) / unit; }, [=](BodyDrop& d, double x) { at(d) = x * unit; }};
}

/// A deviation from the motion, in rad or s in a drop whose tolerance is 1, as those that are read have.
BodyDropColumn deviation(const std::string& name, double unit, std::size_t joint, double Deviation::*at,
                         double ExecutionTolerance::*tolerance) {
  return {name, [=](const BodyDrop& d) { return d.joints[joint].deviation.*at * d.scene.execution.*tolerance / unit; },
          [=](BodyDrop& d, double x) { d.joints[joint].deviation.*at = x * unit; }};
}

std::vector<BodyDropColumn> columns_of(const BodyScene& scene) {
  std::vector<BodyDropColumn> out;
  for (const std::string& design : design_names(scene))
    if (!is_composed(design) && !design.starts_with("load."))
      out.push_back({column_name(design),
                     [get = design_getter(scene, design)](const BodyDrop& d) { return get(d.scene); },
                     [set = design_setter(scene, design)](BodyDrop& d, double x) { set(d.scene, x); }});
  if (scene.robot.base != Base::kRail)
    out.push_back(column(
        "pitch_rate_deg", kDegree, [](auto& d) -> auto& { return d.scene.drop.pitch_rate; }));
  for (std::size_t i = 0; i < scene.robot.joints.size(); ++i) {
    const Joint& joint = scene.robot.joints[i];
    if (!joint.driven()) continue;
    const std::string of = "_" + joint.name;
    out.push_back(column(
        "phi_off" + of + "_deg", kDegree, [i](auto& d) -> auto& { return d.joints[i].phi; }));
    out.push_back(column(
        "rate_off" + of + "_deg", kDegree, [i](auto& d) -> auto& { return d.joints[i].rate; }));
    out.push_back(deviation("phi_i_off" + of + "_deg", kDegree, i, &Deviation::phi_i, &ExecutionTolerance::phi));
    out.push_back(deviation("phi_f_off" + of + "_deg", kDegree, i, &Deviation::phi_f, &ExecutionTolerance::phi));
    out.push_back(deviation("duration_off" + of, 1, i, &Deviation::duration, &ExecutionTolerance::duration));
  }
  return out;
}

BodyDrop planned_drop(const BodyScene& scene) {
  BodyDrop out{.scene = scene, .joints = std::vector<BodyDrop::Joint>(scene.robot.joints.size())};
  out.scene.execution = {1, 1};
  out.scene.uncertainty.reset(), out.scene.identified.reset(), out.scene.verdicts.clear();  // of the planned scene
  return out;
}

}  // namespace

std::vector<BodyDropColumn> scattered_columns(std::span<const BodyDrop> drops, const BodyScene& scene) {
  const BodyDrop planned = planned_drop(scene);
  std::vector<BodyDropColumn> out;
  for (BodyDropColumn& c : columns_of(scene)) {
    const double own = c.get(planned);
    if (!std::isnan(own) && std::any_of(drops.begin(), drops.end(), [&](auto& d) { return c.get(d) != own; }))
      out.push_back(std::move(c));
  }
  return out;
}

std::vector<BodyDrop> read_drops(const std::string& path, const BodyScene& scene) {
  const BodyDrop planned = planned_drop(scene);
  std::vector<BodyDrop> out;
  std::vector<ReadColumn> columns;
  for (const BodyDropColumn& c : columns_of(scene))
    columns.push_back({c.name, std::isnan(c.get(planned)) ? "the scene has none" : "",
                       [&out, set = c.set](std::size_t row, double value) {
                         set(out[row], value);
                         out[row].scene.validate();
                       }});
  const auto none = [&](const std::string& name, const char* why) {
    columns.push_back({name, "", [why](std::size_t, double value) {
                         if (value != 0) throw InputError(why);
                       }});
  };
  const Base base = scene.robot.base;
  if (base != Base::kFree) none("forward_speed", "a robot on a rail or a pin has none");
  if (base == Base::kRail) none("pitch_rate_deg", "a robot on a rail has none");
  if (base == Base::kPinned) none("height", "a pinned robot is not dropped");
  read_drop_rows(path, columns, [&](std::size_t rows) { out.assign(rows, planned); });
  return out;
}

}  // namespace ukemi::landing
