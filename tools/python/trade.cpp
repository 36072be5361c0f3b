// Python bindings of design trade-offs.
#include "landing/plan/trade.hpp"

#include <fmt/format.h>

#include "common/error.hpp"
#include "landing/plan/design_numbers.hpp"
#include "tools/python/arguments.hpp"
#include "tools/report/trade.hpp"

namespace ukemi::python {

using namespace landing;

namespace {

using tools::TradeResult;

py::object value_or_none(double value) { return value < kNoMotion ? py::cast(value) : py::none(); }

py::list designs_of(const TradeResult& r) {
  py::list out;
  for (const TradePoint& p : r.trade.points) {
    py::dict at, point;
    for (std::size_t a = 0; a < r.trade.axes.size(); ++a) at[r.trade.axes[a].name.c_str()] = p.at[a];
    point["at"] = at, point["held"] = value_or_none(p.held), point["unchanged"] = value_or_none(p.unchanged);
    point["planned"] = value_or_none(p.planned);
    point["peak"] = value_or_none(p.peak);
    point["motions"] = p.found() ? py::object(by_joint(r.scene.robot, p.motion)) : py::none();
    out.append(point);
  }
  return out;
}

/// Throws InputError for an invalid axis, before any search.
void check_axes(const BodyScene& scene, const std::vector<TradeAxis>& axes, bool ratings) {
  for (const TradeAxis& axis : axes) {
    for (const double value : axis.values) {
      BodyScene tried = scene;
      set_design_number(tried, axis.name, value);
    }
    if (!ratings && is_rating(axis.name))
      throw InputError("vary: " + quoted(axis.name) + ": respect_ratings is needed: without it no plan keeps a rating");
  }
}

std::vector<TradeAxis> axes_of(const py::dict& vary) {
  std::vector<TradeAxis> out;
  for (const auto& [key, values] : vary)
    out.push_back({py::cast<std::string>(key), py::cast<std::vector<double>>(values)});
  return out;
}

struct TradeArguments : Arguments {
  std::optional<std::pair<std::string, std::string>> front = {};
  std::size_t designs = 9;
};

/// A trade over `axes`, or the front of two loads.
TradeResult traded(const BodyScene& scene, const std::vector<TradeAxis>& axes,
                   const std::optional<std::pair<std::string, std::string>>& front, std::size_t designs, bool ratings,
                   const BodyPlanOptions& search) {
  check_axes(scene, axes, ratings);
  TradeOptions options{.search = search};
  if (ratings) options.prepare = [](BodyScene& s) { (void)respect_ratings(s); };
  const auto find = [&] {
    if (!front) return TradeResult{.scene = scene, .trade = trade(scene, axes, options), .search = search};
    Front f = pareto(scene, front->first, front->second, designs, options);
    return TradeResult{
        .scene = std::move(f.scene), .trade = std::move(f.trade), .search = search, .of = TradeResult::Of::kFront};
  };
  return monitored(find, options.monitor);
}

void bind_body_ratings(py::module_& m) {
  define(
      m, "ratings",
      [](const Arguments& a, const BodyScene& scene, const Numbers& speeds, const std::optional<Numbers>& torques) {
        std::vector<TradeAxis> axes = {{"drive.*.speed_max", column("motor_speeds", speeds)}};
        if (torques) axes.push_back({"drive.*.motor_torque_max", column("motor_torques", *torques)});
        return traded(scene, axes, {}, 0, true, plan_options(scene, a));
      },
      py::arg("scene"), py::arg("motor_speeds"), py::arg("motor_torques") = py::none(), kEvaluations, kSeed, kThreads,
      "The same of a robot of links, a trade of what all its drives are rated: motor_speeds [rad/s], motor_torques "
      "[Nm], two of each at least; None: what each drive's own motor_torque_max says.");
}

}  // namespace

void bind_trade(py::module_& m) {
  Value<TradeResult> c(m, "RobotTrade", "The best landings of a robot of links for values of its design.");
  property(c, "points",
           "A dict for each design: at (its values by name), held, unchanged (the middle's motion), planned, peak, "
           "motions by joint; None where there is nothing.",
           designs_of);
  property(c, "middle", "Index of the middle design.", [](auto& r) { return r.trade.middle; });
  c.repr([](auto& r) { return fmt::format(": {} designs, {} plans", r.trade.points.size(), r.trade.plans); });
  bind_report(
      c, tools::kTradeOutputs, [](auto& r) { return r.search.seed; },
      [](auto& r, tools::Run& run) { return report(r, run); });
  define(
      m, "trade",
      [](const TradeArguments& a, const BodyScene& scene, const py::dict& vary) {
        if (a.front.has_value() == !vary.empty()) throw InputError("vary or pareto is needed, and not both");
        BodyScene limited = scene;
        forbid(limited, a.forbid);
        return traded(limited, axes_of(vary), a.front, a.designs, a.respect_ratings, plan_options(limited, a));
      },
      py::arg("scene"), py::arg("vary") = py::dict(), kSeed, kObjective, kEvaluations, kRobust, kScatter, kInflate,
      kSamples, kThreads, kForbid, kRespectRatings, Argument{"pareto", &TradeArguments::front},
      Argument{"designs", &TradeArguments::designs},
      "What numbers of a robot's design buy: vary is a dict of one or two names, as \"drive.knee.k_sea\", each with "
      "the values that rise, in the units of the files. Or what one load costs in another: pareto is a pair of names "
      "of loads, or \"peak\"; the first is made small for so many values (designs) that the second may have.");
  bind_body_ratings(m);
}

}  // namespace ukemi::python
