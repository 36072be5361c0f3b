// Our landing against the same landing with other integrators, in one run: errors, times, ratios.
//
//   bench_integrators [csv] [repetitions] [tolerances a decade]
//
// csv: a file, or "-" for standard output. Each repetition times every method at every tolerance in turn, the methods
// in rotating order, so that a slow moment of the machine meets all of them.
#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <functional>

#include "common/median.hpp"
#include "common/stopwatch.hpp"
#include "landing/run/simulate.hpp"
#include "test/bench/cvode_landing.hpp"
#include "test/bench/odeint_landing.hpp"

using namespace ukemi;
using namespace ukemi::bench;

namespace {

/// The even-numbered landings of the reference: the paper's scene.
std::vector<Case> read_cases() {
  std::vector<Case> out;
  const std::vector<Case> all = landing::read_reference(UKEMI_DATASETS "/reference");
  for (std::size_t i = 0; i < all.size(); i += 2) out.push_back(all[i]);
  return out;
}

landing::SimulateOptions options(double accuracy) {
  return {.accuracy = accuracy, .rest = landing::SimulateOptions::Rest::kIgnore};
}

/// Our landing; the report adds the order of touchdowns.
Result ours(const Case& c, double accuracy) {
  const landing::LandingPeak p = landing::peak_acceleration(c.scene, c.sea, c.motion, options(accuracy));
  Result r;
  r.peak = p.peak, r.derivatives = p.work.derivatives, r.events = p.work.events;
  r.failed = p.end != landing::End::kTimeLimit;
  constexpr double kWithin = 1 - 1e-12;  // the second row is at the end, not beyond it by rounding
  const landing::Landing l = landing::simulate(c.scene, c.sea, c.motion, options(accuracy), 1 / (kWithin * p.t_end));
  const landing::Sample& end = l.trajectory.back();
  r.place = {end.x0, end.y0, end.phi0, end.phi1, end.phi_m};
  for (const landing::Touch& t : l.touches)
    if (r.touched < int(r.touchdowns.size())) r.touchdowns[r.touched++] = "HKF"[t.point];
  return r;
}

struct Method {
  const char* name;
  std::function<Result(const Case&, double)> land;   ///< with everything that errors are taken of
  std::function<double(const Case&, double)> timed;  ///< the peak, as fast as it comes
};

/// A method at a tolerance, over all cases.
struct Entry {
  int method;
  double accuracy;
  std::vector<double> peak_error, final_error, times;  ///< relative; m and rad; us a landing
  long derivatives = 0, events = 0;
  int failed = 0, other_order = 0;
};

double largest(const std::vector<double>& v) { return *std::max_element(v.begin(), v.end()); }
double smallest(const std::vector<double>& v) { return *std::min_element(v.begin(), v.end()); }

Entry measure_errors(int method, const Method& m, double accuracy, const std::vector<Case>& cases,
                     const std::vector<Place>& ends) {
  Entry e{method, accuracy, {}, {}, {}};
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Result r = m.land(cases[i], accuracy);
    double off = 0;
    for (std::size_t k = 0; k < r.place.size(); ++k) off = std::max(off, std::abs(r.place[k] - ends[i][k]));
    const bool failed = r.failed || !std::isfinite(r.peak) || !std::isfinite(off);
    constexpr double kNone = std::numeric_limits<double>::infinity();
    e.peak_error.push_back(failed ? kNone : std::abs(r.peak / cases[i].peak - 1));
    e.final_error.push_back(failed ? kNone : off);
    e.failed += failed;
    e.other_order += r.order() != cases[i].order.substr(0, r.touchdowns.size());
    e.derivatives += r.derivatives, e.events += r.events;
  }
  return e;
}

std::string csv_of(const std::vector<Entry>& entries, const std::vector<Method>& methods, std::size_t cases) {
  std::string out =
      "method,accuracy,peak_error_max,peak_error_median,final_error_max,final_error_median,time_us_median,time_us_min,"
      "rhs,events,failed\n";
  for (const Entry& e : entries)
    out += fmt::format("{},{:.3g},{:.3g},{:.3g},{:.3g},{:.3g},{:.4g},{:.4g},{:.1f},{:.2f},{}\n", methods[e.method].name,
                       e.accuracy, largest(e.peak_error), median(e.peak_error), largest(e.final_error),
                       median(e.final_error), median(e.times), smallest(e.times), double(e.derivatives) / double(cases),
                       double(e.events) / double(cases), e.failed);
  return out;
}

/// For each target and method the fastest entry that reaches the target in every case.
void print_table(const std::vector<Entry>& entries, const std::vector<Method>& methods, std::size_t cases) {
  fmt::print("{:>7}  {:13} {:>9} {:>10} {:>10} {:>9} {:>9} {:>8} {:>7} {:>12} {:>6} {:>9}\n", "target", "method",
             "accuracy", "peak max", "final max", "median us", "min us", "rhs", "events", "other orders", "ratio",
             "min ratio");
  for (const double target : {1e-4, 1e-8}) {
    double reference = 0, reference_min = 0;
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const Entry* best = nullptr;
      for (const Entry& e : entries)
        if (e.method == int(m) && std::max(largest(e.peak_error), largest(e.final_error)) <= target)
          if (best == nullptr || median(e.times) < median(best->times)) best = &e;
      if (best == nullptr) {
        fmt::print("{:7.0e}  {:13} not reached\n", target, methods[m].name);
        continue;
      }
      const double time = median(best->times);
      const double least = smallest(best->times);
      if (m == 0) reference = time, reference_min = least;
      fmt::print("{:7.0e}  {:13} {:9.1e} {:10.1e} {:10.1e} {:9.2f} {:9.2f} {:8.1f} {:7.2f} {:12} {:6.2f} {:9.2f}\n",
                 target, methods[m].name, best->accuracy, largest(best->peak_error), largest(best->final_error), time,
                 least, double(best->derivatives) / double(cases), double(best->events) / double(cases),
                 best->other_order, time / reference, least / reference_min);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string file = argc > 1 ? argv[1] : "-";
  const int repetitions = argc > 2 ? std::max(1, std::atoi(argv[2])) : 30;
  const int per_decade = argc > 3 ? std::max(1, std::atoi(argv[3])) : 2;
  const std::vector<Case> cases = read_cases();

  const OdeintLanding odeint;
  CvodeLanding adams(CvodeLanding::Kind::kAdams), bdf(CvodeLanding::Kind::kBdf);
  const auto peer = [](const char* name, auto& land) {
    return Method{name, std::ref(land), [&land](const Case& c, double accuracy) { return land(c, accuracy).peak; }};
  };
  const std::vector<Method> methods = {
      {"ukemi", ours,
       [](const Case& c, double accuracy) {
         return landing::peak_acceleration(c.scene, c.sea, c.motion, options(accuracy)).peak;
       }},
      peer("odeint_dopri5", odeint),
      peer("cvode_adams", adams),
      peer("cvode_bdf", bdf)};

  // Errors. Nobody has computed the ends in extended precision: they are ours at a tolerance below the ladder's.
  std::vector<Place> ends;
  for (const Case& c : cases) ends.push_back(ours(c, 1e-13).place);
  std::vector<Entry> entries;
  for (int m = 0; m < int(methods.size()); ++m)
    for (int i = 2 * per_decade; i <= 12 * per_decade; ++i)
      entries.push_back(measure_errors(m, methods[m], std::pow(10.0, -double(i) / per_decade), cases, ends));

  // Times.
  const int rungs = int(entries.size() / methods.size());
  double sink = 0;
  for (int n = 0; n < repetitions; ++n)
    for (int rung = 0; rung < rungs; ++rung)
      for (std::size_t m = 0; m < methods.size(); ++m) {
        const std::size_t turn = (m + n + rung) % methods.size();
        Entry& e = entries[turn * rungs + rung];
        const Stopwatch watch(Stopwatch::Time::kProcess);
        for (const Case& c : cases) sink += methods[turn].timed(c, e.accuracy);
        e.times.push_back(1e6 * watch.seconds() / double(cases.size()));
      }
  if (sink == 0) fmt::print("no landing has a peak\n");  // keeps the timed work from being left out

  const std::string csv = csv_of(entries, methods, cases.size());
  if (file == "-") {
    fmt::print("{}\n", csv);
  } else {
    std::ofstream out(file);
    out << csv;
    if (!out.flush()) {
      fmt::print(stderr, "{}: cannot be written\n", file);
      return 1;
    }
  }
  print_table(entries, methods, cases.size());
  return 0;
}
