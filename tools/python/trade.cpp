// What numbers of a design buy, for Python.
#include "landing/plan/trade.hpp"

#include <fmt/format.h>

#include "common/error.hpp"
#include "landing/plan/design_numbers.hpp"
#include "tools/python/body.hpp"
#include "tools/python/search.hpp"
#include "tools/report/trade.hpp"

namespace ukemi::python {

using namespace landing;

namespace {

using tools::TradeResult;

py::object worth(double value) { return value < kNoMotion ? py::cast(value) : py::none(); }

py::list designs_of(const TradeResult& r) {
  py::list out;
  for (const TradePoint& p : r.trade.points) {
    py::dict at, point;
    for (std::size_t a = 0; a < r.trade.axes.size(); ++a) at[r.trade.axes[a].name.c_str()] = p.at[a];
    point["at"] = at, point["held"] = worth(p.held), point["unchanged"] = worth(p.unchanged);
    point["planned"] = worth(p.planned);
    point["peak"] = worth(p.peak);
    point["motions"] = p.found() ? py::object(by_joint(r.scene.robot, p.motion)) : py::none();
    out.append(point);
  }
  return out;
}

std::vector<TradeAxis> axes_of(const BodyScene& scene, const py::dict& vary) {
  std::vector<TradeAxis> out;
  for (const auto& [key, values] : vary) {
    out.push_back({py::cast<std::string>(key), py::cast<std::vector<double>>(values)});
    for (const double value : out.back().values) {  // refused before anything is searched
      BodyScene tried = scene;
      set_design_number(tried, out.back().name, value);
    }
  }
  return out;
}

}  // namespace

void bind_trade(py::module_& m) {
  py::class_<TradeResult> c(m, "RobotTrade", "The best landings of a robot of links for values of its design.");
  c.def_property_readonly("points", designs_of,
                          "A dict for each design: at (its values by name), held, unchanged (the middle's motion), "
                          "planned, peak, motions by joint; None where there is nothing.")
      .def_property_readonly(
          "middle", [](const TradeResult& r) { return r.trade.middle; }, "Index of the middle design.")
      .def("__repr__", [](const TradeResult& r) {
        return fmt::format("<ukemi.RobotTrade: {} designs, {} plans>", r.trade.points.size(), r.trade.plans);
      });
  bind_value(c);
  bind_report(
      c, tools::kTradeOutputs, [](const TradeResult& r, tools::Run& run) { return report(r, run); },
      [](const TradeResult& r) { return r.search.seed; });
  m.def(
      "trade",
      [](const BodyScene& scene, const py::dict& vary, std::uint64_t seed, const std::string& objective,
         std::optional<long> evaluations, const std::optional<std::string>& robust,
         const std::optional<std::string>& scatter, double inflate, long samples, int threads,
         const std::vector<std::string>& forbidden, bool ratings,
         const std::optional<std::pair<std::string, std::string>>& front, std::size_t designs) {
        if (front.has_value() == !vary.empty()) throw InputError("vary or pareto is needed, and not both");
        const BodyScene kept = limited(scene, forbidden, false);
        TradeOptions options{
            .search = plan_options(kept, seed, objective, evaluations, robust, scatter, inflate, samples, threads)};
        if (ratings) options.prepare = [](BodyScene& s) { (void)respect_ratings(s); };
        const std::vector<TradeAxis> axes = axes_of(kept, vary);
        return long_call([&](const std::function<bool()>& stop) {
          options.monitor.stop = stop;
          if (!front) return TradeResult{.scene = kept, .trade = trade(kept, axes, options), .search = options.search};
          Front f = pareto(kept, front->first, front->second, designs, options);
          return TradeResult{.scene = std::move(f.scene),
                             .trade = std::move(f.trade),
                             .search = options.search,
                             .of = TradeResult::Of::kFront};
        });
      },
      py::arg("scene"), py::arg("vary") = py::dict(), py::arg("seed") = 1, py::arg("objective") = "peak",
      py::arg("evaluations") = py::none(), py::arg("robust") = py::none(), py::arg("scatter") = py::none(),
      py::arg("inflate") = 1.0, py::arg("samples") = BodyPlanOptions().samples, py::arg("threads") = 0,
      py::arg("forbid") = std::vector<std::string>{}, py::arg("respect_ratings") = false,
      py::arg("pareto") = py::none(), py::arg("designs") = 9,
      "What numbers of a robot's design buy: vary is a dict of one or two names, as \"drive.knee.k_sea\", each with "
      "the values that rise, in the units of the files. Or what one load costs in another: pareto is a pair of names "
      "of loads, or \"peak\"; the first is made small for so many values (designs) that the second may have.");
}

}  // namespace ukemi::python
