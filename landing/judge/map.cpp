#include "landing/judge/peak_grid.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "common/checks.hpp"
#include "common/error.hpp"
#include "common/parallel.hpp"
#include "landing/judge/survey.hpp"
#include "landing/search/population.hpp"
#include "landing/search/search.hpp"
#include "landing/search/two_link_objective.hpp"

namespace ukemi::landing {

void MapOptions::validate() const {
  double points = 1;
  for (const int n : cells) {
    if (n < 1 || n > 4096) throw InputError("grid: " + std::to_string(n) + ": 1 to 4096 points an axis are needed");
    points *= n;
  }
  if (points > 1e8) throw InputError("grid: more than 1e8 points");
  if (points < 2) throw InputError("grid: 2 points along some variable are needed");
  SimulateOptions{.accuracy = accuracy}.validate(), SimulateOptions{.accuracy = tight}.validate();
  for (const double x : slice) check_finite("slice", x);
  check_count("polish", polished, 1, 1'000'000);
}

std::size_t PeakMap::index(const Place& at) const {
  std::size_t i = 0;
  for (std::size_t k = 0; k < cells.size(); ++k) i = i * std::size_t(cells[k]) + std::size_t(at[k]);
  return i;
}

PeakMap::Place PeakMap::place(std::size_t index) const {
  Place at(cells.size());
  for (std::size_t k = cells.size(); k-- > 0; index /= std::size_t(cells[k]))
    at[k] = int(index % std::size_t(cells[k]));
  return at;
}

double PeakMap::coordinate(int variable, int i) const {
  const auto k = std::size_t(variable);
  const Variable& v = variables[k];
  return cells[k] == 1 ? slice[variable] : v.lower + (v.upper - v.lower) * i / (cells[k] - 1);
}

MotionValues PeakMap::values(const Place& at) const {
  Coordinates x(int(at.size()));
  for (int k = 0; k < int(at.size()); ++k) x[k] = coordinate(k, at[std::size_t(k)]);
  return x;
}

std::vector<std::size_t> PeakMap::neighbours(std::size_t here) const {
  std::vector<std::size_t> out{here};
  std::size_t stride = 1;  // between two points along variable k
  for (std::size_t k = cells.size(); k-- > 0; stride *= std::size_t(cells[k])) {
    const auto points = std::size_t(cells[k]), at = here / stride % points;
    for (std::size_t i = 0, n = out.size(); i < n; ++i) {
      if (at > 0) out.push_back(out[i] - stride);
      if (at + 1 < points) out.push_back(out[i] + stride);
    }
  }
  return out;
}

namespace {

PeakMap empty_map(const std::vector<Variable>& variables, const MapOptions& options) {
  const std::size_t n = variables.size();
  if (options.cells.size() > n)
    throw InputError("grid: " + std::to_string(options.cells.size()) + " numbers: the motion has " + std::to_string(n) +
                     " variables");
  if (options.slice.size() != 0 && std::size_t(options.slice.size()) != n)
    throw InputError("slice: " + std::to_string(options.slice.size()) + " values: the motion has " + std::to_string(n) +
                     " variables");
  PeakMap map{variables, options.cells, options.slice, {}};
  map.cells.resize(n, 1);
  if (map.slice.size() == 0) {
    Coordinates middle(static_cast<long>(n));
    for (std::size_t k = 0; k < n; ++k)
      middle[long(k)] = variables[k].lower + 0.5 * (variables[k].upper - variables[k].lower);
    map.slice = middle;
  }
  std::size_t points = 1;
  for (const int c : map.cells) points *= std::size_t(c);
  const PeakMap::Cell not_played{std::numeric_limits<double>::quiet_NaN(), {}, -1, false, End::kStopped};
  map.grid.resize(points, not_played);
  return map;
}

/// Differential evolution from one cell of the grid down into its basin.
Candidate descend(const Scene& scene, const MotionSpace& space, const PeakMap& map, const PeakMap::Place& cell,
                  const MapOptions& options, std::uint64_t n) {
  constexpr int kPopulation = 20;
  constexpr long kMotions = 3000;
  constexpr double kConverged = 1e-7;
  TwoLinkObjective objective(scene, space, {.stop = options.monitor.stop});
  Search search(objective, {.motions = kMotions, .work = work_allowed(1, kMotions), .hold = 0}, options.seed + n);
  Random random(options.seed, n);
  std::vector<Candidate> population(kPopulation, search.centre()), trials = population;
  for (Candidate& p : population)
    for (int a = 0; a < p.u.size(); ++a) {
      const int points = map.cells[std::size_t(a)], at = cell[std::size_t(a)];
      const Variable& v = map.variables[std::size_t(a)];
      // Along a fixed variable the population starts within a tenth of its range.
      const double width = points > 1 ? 1.0 / (points - 1) : 0.1,
                   middle = points > 1 ? at * width : (map.slice[a] - v.lower) / std::max(v.upper - v.lower, 1e-300);
      p.u[a] = std::clamp(points > 1 ? width * (at + random.uniform(-1, 1)) : middle + width * random.uniform(-1, 1),
                          0.0, 1.0);
      if (&p == &population[0]) p.u[a] = middle;
    }
  search.evaluate(population);
  while (!search.over()) {
    while (!search.over() && spread(population) > kConverged)
      evolve([&](std::span<Candidate> p) { search.evaluate(p); }, random, population, trials, {});
    sample_around(search.best(), random, population);  // restart, narrow
    search.evaluate(population);
  }
  return search.judge(options.tight);
}

}  // namespace

std::vector<std::size_t> local_minima(const PeakMap& map) {
  std::vector<std::size_t> minima;
  for (std::size_t i = 0; i < map.grid.size(); ++i) {
    const double here = map.grid[i].peak;
    if (!std::isfinite(here)) continue;
    const auto neighbours = map.neighbours(i);
    if (std::none_of(neighbours.begin(), neighbours.end(), [&](std::size_t n) { return map.grid[n].peak < here; }))
      minima.push_back(i);
  }
  std::stable_sort(minima.begin(), minima.end(),
                   [&](std::size_t a, std::size_t b) { return map.grid[a].peak < map.grid[b].peak; });
  return minima;
}

PeakMap::Cell cell_of(const RunEnd& l, double value) {
  const bool none = no_landing(l.end) || l.end == End::kStopped;
  return {none ? std::numeric_limits<double>::quiet_NaN() : value, l.contacts, l.peak_contact, l.joint_lost, l.end};
}

PeakMap map_peaks(const std::vector<Variable>& variables, const MapOptions& options, const PlayCells& play) {
  options.validate();
  PeakMap map = empty_map(variables, options);
  std::size_t row = 1;  // the landings of a row are similar: lanes reach their events together
  for (auto cells = map.cells.rbegin(); row == 1; ++cells) row = std::size_t(*cells);
  std::atomic<long> rows{0};
  const int count = int(map.grid.size() / row);
  parallel_for(count, options.threads, [&](int r) {
    if (options.monitor.stopped()) return;
    const std::size_t first = std::size_t(r) * row;
    play(map, first, std::span(map.grid).subspan(first, row));
    options.monitor.progress(++rows, count);
  });
  return map;
}

PeakMap map_peaks(const Scene& scene, const SeaParameters<double>& sea, const MapOptions& options) {
  return map_peaks(scene, ReferenceSpace(scene, sea), options);
}

PeakMap map_peaks(const Scene& scene, const MotionSpace& space, const MapOptions& options) {
  return map_peaks(
      space.variables(), options, [&](const PeakMap& map, std::size_t first, std::span<PeakMap::Cell> row) {
        std::vector<DrivenMotion> plays;
        std::vector<BatchCase> cases;
        for (std::size_t k = 0; k < row.size(); ++k) plays.push_back(space.play(map.values(map.place(first + k))));
        for (const DrivenMotion& p : plays) cases.push_back({&scene, &p.sea, p.motion});
        std::vector<LandingPeak> peaks(cases.size());
        batch_peaks(cases, peaks,
                    {.accuracy = options.accuracy, .over = options.monitor.stop ? &options.monitor.stop : nullptr});
        for (std::size_t k = 0; k < peaks.size(); ++k) row[k] = cell_of(peaks[k], peaks[k].peak);
      });
}

std::vector<Candidate> distinct_basins(const PeakMap& map, const MapOptions& options, const Descend& descend) {
  if (options.monitor.stopped()) return {};
  std::vector<std::size_t> minima = local_minima(map);
  minima.resize(std::min(minima.size(), std::size_t(options.polished)));
  std::vector<Candidate> found(minima.size());
  std::atomic<long> searched{0};
  parallel_for(int(minima.size()), options.threads, [&](int n) {
    const Candidate best = descend(map.place(minima[std::size_t(n)]), std::uint64_t(n));
    if (options.monitor.stopped()) return;
    found[std::size_t(n)] = best;
    options.monitor.progress(++searched, long(minima.size()));
  });
  std::sort(found.begin(), found.end());
  constexpr double kApart = 0.02;
  std::vector<Candidate> distinct;
  for (const Candidate& p : found)
    if (p.value < kNoMotion &&
        std::none_of(distinct.begin(), distinct.end(), [&](const Candidate& q) { return distance(p, q) < kApart; }))
      distinct.push_back(p);
  return distinct;
}

std::vector<Basin> basins(const Scene& scene, const MotionSpace& space, const PeakMap& map, const MapOptions& options) {
  options.validate();
  if (int(map.variables.size()) != space.dimension() || map.cells.size() != map.variables.size())
    throw InputError("map: its variables are not those of the motion");
  std::vector<Basin> out;
  for (const Candidate& p : distinct_basins(map, options, [&](const PeakMap::Place&cell, std::uint64_t n) {
         return descend(scene, space, map, cell, options, n);
       })) {
    const Coordinates x = space.values(p.u);
    out.push_back({x, space.play(x), p.value});
  }
  return out;
}

std::vector<double> peak_slice(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                               const MotionRange& x, const MotionRange& y, int cells, int threads) {
  check_count("cells", cells, 2, 4096);
  std::vector<BatchCase> cases;
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      Motion m = motion;
      m.*x.number = std::lerp(x.low, x.high, double(i) / (cells - 1));
      m.*y.number = std::lerp(y.low, y.high, double(j) / (cells - 1));
      cases.push_back({&scene, &sea, m});
    }
  std::vector<LandingPeak> peaks(cases.size());
  batch_peaks(cases, peaks, {}, threads);
  std::vector<double> out;
  for (const LandingPeak& p : peaks) out.push_back(no_landing(p.end) ? std::nan("") : p.peak);
  return out;
}

}  // namespace ukemi::landing
