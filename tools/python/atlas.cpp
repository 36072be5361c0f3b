// Python bindings of atlases: planning, saving, reading.
#include <fmt/format.h>

#include "landing/atlas/atlas_reader.hpp"
#include "landing/atlas/body_atlas.hpp"
#include "landing/atlas/body_atlas_reader.hpp"
#include "landing/atlas/two_link_atlas.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/plan/body_space.hpp"
#include "tools/python/arguments.hpp"
#include "tools/report/atlas.hpp"
#include "tools/report/body.hpp"

namespace ukemi::python {

using namespace landing;

/// The header of a file has no padding but is not reflectable.
void serialize(auto& a, AtlasHeader& x) { a.number(x); }

namespace {

struct AtlasPlan {
  tools::AtlasResult result;
  Scene scene;
  Actuator actuator;
  std::uint64_t seed = 1;
};
/// An atlas of a robot of links.
struct BodyAtlasPlan {
  tools::AtlasResult result;
  BodyScene scene;
  std::uint64_t seed = 1;
};

using Axis = std::tuple<double, double, std::uint64_t>;
/// The grid's axis; without one the single value of the scene's drop.
AtlasAxis axis_of(const char* what, const std::optional<Axis>& given, double of_drop) {
  if (!given) return {of_drop, of_drop, 1};
  const auto& [lowest, highest, count] = *given;
  return {checked(what, lowest, Range::any()), checked(what, highest, Range::any()), count};
}
AtlasOptions atlas_options(const Arguments& a, const Drop& drop, const std::optional<Axis>& height,
                           const std::optional<Axis>& forward_speed, const std::optional<Axis>& pitch) {
  AtlasOptions out;
  out.grid.axes = {axis_of("height", height, drop.height), axis_of("forward_speed", forward_speed, drop.forward_speed),
                   axis_of("pitch", pitch, drop.pitch)};
  out.search.goal = goal_of(a.objective), out.search.evaluations = a.evaluations;
  out.search.seed = a.seed, out.search.threads = a.threads;
  out.robust = robust_of(a);
  return out;
}

const char* goal_name(std::uint64_t goal) { return Goal(goal) == Goal::kPeak ? "peak" : "tolerant peak"; }

void plan_all(const AtlasRobot& robot, AtlasOptions options, tools::AtlasResult& r) {
  options.validate(), robot.validate(options.grid);
  r.drops = options.shard.drops(options.grid);
  r.atlas.header = atlas_header(robot, options);
  r.atlas.cells.resize(options.grid.size());
  long_call([&](const std::function<bool()>& stop) {
    options.monitor.stop = stop;
    plan_atlas(robot, options, r.atlas.cells);
    r.atlas.header.safest = {};
    if (r.atlas.open() == 0)
      r.atlas.header.safest = safest_motion(robot, options.grid, r.atlas.cells, options.search.threads, {{}, stop});
    return true;
  });
}
AtlasPlan planned(const Scene& scene, const Actuator& actuator, const AtlasOptions& options) {
  const TwoLinkAtlas robot(scene, actuator);
  AtlasPlan out{{.scene = scene.name, .variables = robot.variables()}, scene, actuator, options.search.seed};
  out.result.scene_toml = to_toml(scene, ""), out.result.actuator_toml = to_toml(actuator);
  plan_all(robot, options, out.result);
  return out;
}
BodyAtlasPlan planned(const BodyScene& scene, const AtlasOptions& options) {
  const BodyAtlas robot(scene);
  BodyAtlasPlan out{
      {.scene = scene.name, .variables = robot.variables(), .unit = tools::unit_of(scene)}, scene, options.search.seed};
  plan_all(robot, options, out.result);
  return out;
}

/// of(cell) of every cell as an array of the grid's shape; NaN without a motion.
template <class Of>
py::array_t<double> column_of(const Atlas& atlas, Of of) {
  std::vector<py::ssize_t> shape;
  for (const AtlasAxis& a : atlas.header.grid.axes) shape.push_back(py::ssize_t(a.count));
  py::array_t<double> out(shape);
  for (std::size_t i = 0; i < atlas.cells.size(); ++i)
    out.mutable_data()[i] = atlas.cells[i].planned() ? of(atlas.cells[i]) : std::nan("");
  return out;
}

/// The cell at grid indices; null if it has no motion. Throws InputError for an index out of range.
const AtlasCell* cell_at(const Atlas& atlas, const std::array<std::size_t, AtlasGrid::kAxes>& place) {
  const AtlasHeader& h = atlas.header;
  for (std::size_t k = 0; k < place.size(); ++k)
    if (place[k] >= h.grid.axes[k].count)
      throw InputError(fmt::format("index {}: {}: 0 to {} is needed", k, place[k], h.grid.axes[k].count - 1));
  const AtlasCell& cell = atlas.cells[h.grid.index(place)];
  return cell.planned() ? &cell : nullptr;
}
using Indices = std::array<std::size_t, AtlasGrid::kAxes>;
std::optional<PlannedMotion> motion_at(const AtlasPlan& p, const Indices& place) {
  const AtlasCell* const cell = cell_at(p.result.atlas, place);
  if (!cell) return std::nullopt;
  const ReferenceSpace space(p.scene, p.actuator.sea);
  return PlannedMotion{space.play(cell->coordinates(space.dimension())).motion, goal_name(p.result.atlas.header.goal),
                       cell->value};
}
py::object motion_at(const BodyAtlasPlan& p, const Indices& place) {
  const AtlasCell* const cell = cell_at(p.result.atlas, place);
  if (!cell) return py::none();
  const BodySpace space(p.scene);
  return by_joint(p.scene.robot, space.motion(space.unit(cell->coordinates(space.dimension()))));
}

template <class Plan>
void bind_atlas_class(py::module_& m, const char* name, const char* words, const char* motion) {
  using Motion = decltype(motion_at(std::declval<const Plan&>(), Indices{}));
  Value<Plan> c(m, name, words);
  property(c, "value", "The goal of each drop [m/s^2], axes height, forward_speed, pitch; NaN: no motion.",
           [](auto& p) { return column_of(p.result.atlas, [](const AtlasCell& x) { return x.value; }); });
  property(c, "peak", "The peak of each drop itself [m/s^2].",
           [](auto& p) { return column_of(p.result.atlas, [](const AtlasCell& x) { return x.peak; }); });
  property(c, "tolerant_peak", "The same within the execution tolerance [m/s^2].",
           [](auto& p) { return column_of(p.result.atlas, [](const AtlasCell& x) { return x.tolerant_peak; }); });
  property(c, "axes", "The grid's values along height [m], forward_speed [m/s], pitch [rad].", [](auto& p) {
    const char* const names[] = {"height", "forward_speed", "pitch"};
    py::dict out;
    for (std::size_t k = 0; k < AtlasGrid::kAxes; ++k) {
      const AtlasAxis& a = p.result.atlas.header.grid.axes[k];
      py::array_t<double> values{py::ssize_t(a.count)};
      for (std::size_t i = 0; i < a.count; ++i) values.mutable_at(py::ssize_t(i)) = a.at(i);
      out[names[k]] = values;
    }
    return out;
  });
  c.def("motion", static_cast<Motion (*)(const Plan&, const Indices&)>(&motion_at), py::arg("index"), motion)
      .def(
          "save", [](const Plan& p, const Path& path) { write_file(path, atlas_bytes(p.result.atlas)); },
          py::arg("path"), "Writes atlas.bin, which AtlasReader opens.")
      .def("__repr__", [](const Plan& p) {
        const Atlas& atlas = p.result.atlas;
        return fmt::format("<ukemi.Atlas of {} drops, {} planned for the {}>", atlas.cells.size(), atlas.planned(),
                           goal_name(atlas.header.goal));
      });
  bind_report(c, tools::kAtlasOutputs, &Plan::seed, [](auto& p, tools::Run& run) { return report(p.result, run); });
}

using NamedEntry = WithGoal<AtlasEntry>;
using PythonReader = Asked<AtlasReader, Scene>;
using PythonBodyReader = Asked<BodyAtlasReader, BodyScene>;
py::dict entry_of(PythonBodyReader& r, const Drop& drop) {
  const BodyAtlasEntry e = r.ask([&](BodyAtlasReader& x) { return x.at(drop); });
  py::dict out;
  out["found"] = e.found, out["inside"] = e.inside, out["holds"] = e.holds, out["wrong"] = e.wrong,
  out["goal"] = r.goal;
  out["motions"] = e.found ? py::object(by_joint(r.scene.robot, e.motion)) : py::none();
  out["value"] = e.found ? py::cast(e.value) : py::none();
  return out;
}

struct ReaderArguments : Arguments {
  double deadline = AtlasReader::Options().deadline;
};
const Argument kReaderDeadline{"deadline", &ReaderArguments::deadline};
AtlasReader::Options reader_options(const ReaderArguments& a) {
  AtlasReader::Options out{.goal = goal_of(a.objective)};
  out.deadline = checked("deadline", a.deadline, Range::positive());
  return out;
}

void bind_body_reader(py::module_& m) {
  py::class_<PythonBodyReader> c(m, "RobotAtlasReader", "An atlas in the control program of a robot of links.");
  define_constructor(
      c,
      [](const ReaderArguments& a, const Path& path, const BodyScene& scene) {
        const AtlasReader::Options options = reader_options(a);
        const BodyScene limited = with_limits(scene, a);
        return std::make_unique<PythonBodyReader>("reader", limited, goal_name(std::uint64_t(options.goal)), path.text,
                                                  limited, options);
      },
      "path: atlas.bin; scene, forbid and respect_ratings: those of the atlas; objective: peak or tolerant, by which "
      "motions are compared; deadline for playing them [s].",
      py::arg("path"), py::arg("scene"), kObjective.with("tolerant"), kReaderDeadline.with(0.03), kForbid,
      kRespectRatings);
  c.def(
      "at",
      [](PythonBodyReader& r, double height, double forward_speed, double pitch, double pitch_rate) {
        return entry_of(r, dropped({}, {height, forward_speed, pitch, pitch_rate}));
      },
      py::arg("height"), py::arg("forward_speed") = 0.0, py::arg("pitch") = 0.0, py::arg("pitch_rate") = 0.0,
      "For a drop: height [m], forward_speed [m/s], pitch [rad], pitch_rate [rad/s]. A dict of found, inside (the "
      "grid reaches so far), holds (no motion around is softer than the held posture), motions (by joint), value "
      "(the goal at this very drop [m/s^2]), goal and wrong.");
}

void bind_atlas_reader(py::module_& m) {
  Value<NamedEntry> entry(m, "AtlasEntry", "What an atlas has for a drop.");
  property(entry, "found", "Whether there is a motion.", [](auto& e) { return e.answer.found; });
  property(entry, "inside",
           "Whether the grid reaches so far; else the motion is the one that is safest over all drops.",
           [](auto& e) { return e.answer.inside; });
  property(entry, "holds", "Whether no motion around lands as softly as holding the posture: the motion does.",
           [](auto& e) { return e.answer.holds; });
  property(entry, "motion", "The motion, with the goal at this very drop.", [](auto& e) {
    return PlannedMotion{e.answer.motion, e.goal, e.answer.value};
  });
  property(entry, "value", "The goal at this very drop [m/s^2]; infinite where no time was left to play it.",
           [](auto& e) { return e.answer.value; });
  entry.def_readonly("goal", &NamedEntry::goal, "By which the motions were compared.")
      .def("__repr__", [](const NamedEntry& e) {
        if (!e.answer.found) return std::string("<ukemi.AtlasEntry: none>");
        return fmt::format("<ukemi.AtlasEntry: {}; {}>", tools::motion_words(e.answer.motion),
                           minimised(e.goal, e.answer.value));
      });
  py::class_<PythonReader> c(m, "AtlasReader",
                             "An atlas in a control program: an answer for the drop at hand in 2 ms.");
  define_constructor(
      c,
      [](const ReaderArguments& a, const Path& path, const Scene& scene, const Actuator& actuator) {
        const AtlasReader::Options options = reader_options(a);
        require_gains(actuator);
        return std::make_unique<PythonReader>("reader", scene, goal_name(std::uint64_t(options.goal)), path.text, scene,
                                              actuator.sea, options);
      },
      "path: atlas.bin; scene and actuator: those of the atlas; objective: peak or tolerant, by which motions are "
      "compared; deadline for playing them [s]. All memory is taken here.",
      py::arg("path"), py::arg("scene"), py::arg("actuator"), kObjective.with("tolerant"), kReaderDeadline);
  c.def(
      "at",
      [](PythonReader& r, double height, double forward_speed, double pitch, double pitch_rate, double vertical_speed) {
        Drop drop = dropped({}, {height, forward_speed, pitch, pitch_rate});
        drop.vertical_speed = checked("vertical_speed", vertical_speed, Range::any());
        return NamedEntry{r.ask([&](AtlasReader& x) { return x.at(drop); }), r.goal};
      },
      py::arg("height"), py::arg("forward_speed") = 0.0, py::arg("pitch") = 0.0, py::arg("pitch_rate") = 0.0,
      py::arg("vertical_speed") = 0.0,
      "For a drop: height [m], forward_speed [m/s], pitch [rad], pitch_rate [rad/s], vertical_speed [m/s], "
      "upwards.");
}

}  // namespace

void bind_atlas(py::module_& m) {
  bind_atlas_class<AtlasPlan>(m, "Atlas", "The best motion for every drop of a grid: the table that a robot carries.",
                              "The motion of a drop by its indices along the axes, or None.");
  bind_atlas_class<BodyAtlasPlan>(m, "RobotAtlas", "The same of a robot of links.",
                                  "The motions of a drop, by joint, by its indices along the axes, or None.");
  bind_atlas_reader(m), bind_body_reader(m);
  define(
      m, "atlas",
      [](const Arguments& a, const Scene& scene, const Actuator& actuator, const Axis& height,
         const Axis& forward_speed, const Axis& pitch) {
        require_gains(actuator);
        return planned(scene, actuator, atlas_options(a, scene.drop, height, forward_speed, pitch));
      },
      py::arg("scene"), py::arg("actuator"), py::arg("height"), py::arg("forward_speed"), py::arg("pitch"), kObjective,
      kEvaluations, kRobust, kScatter, kInflate, kSamples.with(RobustOptions().samples), kSeed, kThreads,
      "The best motion for every drop of a grid, as `ukemi atlas`. height [m], forward_speed [m/s], pitch [rad]: "
      "(lowest, highest, how many); the rest as of `optimize`, for each drop. Shards and resumption: the program.");
  define(
      m, "atlas",
      [](const Arguments& a, const BodyScene& scene, const std::optional<Axis>& height,
         const std::optional<Axis>& forward_speed, const std::optional<Axis>& pitch) {
        const AtlasOptions options = atlas_options(a, scene.drop, height, forward_speed, pitch);
        return planned(with_limits(scene, a), options);
      },
      py::arg("scene"), py::arg("height") = py::none(), py::arg("forward_speed") = py::none(),
      py::arg("pitch") = py::none(), kObjective, kEvaluations, kRobust, kScatter, kInflate, kSamples, kSeed, kThreads,
      kForbid, kRespectRatings,
      "The same of a robot of links; an axis that is not given stands where the scene does. forbid and respect_ratings "
      "as of `optimize`; RobotAtlasReader is told them too.");
}

}  // namespace ukemi::python
