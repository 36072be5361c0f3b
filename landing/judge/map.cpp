#include "landing/judge/map.hpp"

#include <atomic>
#include <cmath>

#include "common/error.hpp"
#include "common/parallel.hpp"
#include "landing/search/population.hpp"
#include "landing/search/search.hpp"

namespace ukemi::landing {

void MapOptions::validate() const {
  for (const int n : cells)
    if (n < 2 || n > 4096) throw InputError("grid: " + std::to_string(n) + ": 2 to 4096 points an axis are needed");
  if (double(cells[0]) * cells[1] * cells[2] > 1e8) throw InputError("grid: more than 1e8 points");
  if (polished < 1) throw InputError("polish: " + std::to_string(polished) + ": at least 1 is needed");
}

PeakMap map_peaks(const Scene& scene, const SeaParameters<double>& sea, const MapOptions& options) {
  options.validate();
  PeakMap map{options.cells, {}, {scene.search.phi, scene.search.phi, scene.search.duration}};
  const auto [ni, nj, nk] = options.cells;
  map.grid.resize(map.index(ni, 0, 0));
  std::atomic<long> rows{0};
  // A row of durations is one batch: its landings are alike, so that lanes meet their events together.
  parallel_for(ni * nj, options.threads, [&](int row) {
    std::vector<BatchCase> cases;
    for (int k = 0; k < nk; ++k) cases.push_back({&scene, &sea, map.motion(row / nj, row % nj, k)});
    std::vector<LandingPeak> peaks(cases.size());
    batch_peaks(cases, peaks,
                {.accuracy = options.accuracy, .over = options.monitor.stop ? &options.monitor.stop : nullptr});
    for (int k = 0; k < nk; ++k) {
      const LandingPeak& p = peaks[std::size_t(k)];
      map.grid[map.index(row / nj, row % nj, k)] = {
          no_landing(p.end) || p.end == End::kStopped ? std::numeric_limits<double>::quiet_NaN() : p.peak, p.contacts,
          p.peak_contact, p.end};
    }
    options.monitor.progress(++rows, ni * nj);
  });
  return map;
}

std::vector<Basin> basins(const Scene& scene, const SeaParameters<double>& sea, const PeakMap& map,
                          const MapOptions& options) {
  struct Minimum {
    double peak;
    std::array<int, 3> at;
  };
  if (options.monitor.stopped()) return {};
  std::vector<Minimum> minima;
  const auto [ni, nj, nk] = map.cells;
  for (int i = 0; i < ni; ++i)
    for (int j = 0; j < nj; ++j)
      for (int k = 0; k < nk; ++k) {
        const double here = map.grid[map.index(i, j, k)].peak;
        bool lowest = std::isfinite(here);
        for (int d = 0; lowest && d < 27; ++d) {
          const int a = i + d / 9 - 1, b = j + d / 3 % 3 - 1, c = k + d % 3 - 1;
          if (a < 0 || b < 0 || c < 0 || a >= ni || b >= nj || c >= nk) continue;
          lowest = !(map.grid[map.index(a, b, c)].peak < here);
        }
        if (lowest) minima.push_back({here, {i, j, k}});
      }
  std::stable_sort(minima.begin(), minima.end(), [](const Minimum& a, const Minimum& b) { return a.peak < b.peak; });
  minima.resize(std::min(minima.size(), std::size_t(options.polished)));

  std::vector<Point3> found(minima.size());
  std::atomic<long> searched{0};
  parallel_for(int(minima.size()), options.threads, [&](int n) {
    constexpr int kPopulation = 20;
    constexpr long kMotions = 3000;
    constexpr double kConverged = 1e-7;
    Objective objective(scene, sea, {.stop = options.monitor.stop});
    Search search(objective, {.motions = kMotions, .work = work_allowed(Goal::kPeak, kMotions)},
                  options.seed + std::uint64_t(n));
    Random random(options.seed, std::uint64_t(n));
    std::vector<Point3> population(kPopulation), trials(kPopulation);
    for (Point3& p : population)
      for (std::size_t a = 0; a < 3; ++a) {
        const double cell = 1.0 / (map.cells[a] - 1);
        p.u[a] = std::clamp(cell * (minima[std::size_t(n)].at[a] + random.uniform(-1, 1)), 0.0, 1.0);
        if (&p == &population[0]) p.u[a] = cell * minima[std::size_t(n)].at[a];
      }
    search.evaluate(population);
    while (!search.over()) {
      while (!search.over() && spread(population) > kConverged)
        evolve([&](std::span<Point3> p) { search.evaluate(p); }, random, population, trials, {});
      scatter(search.best(), random, population);  // once more, from close by
      search.evaluate(population);
    }
    const Point3 best = search.settle(options.tight);
    if (options.monitor.stopped()) return;
    found[std::size_t(n)] = best;
    options.monitor.progress(++searched, long(minima.size()));
  });
  std::sort(found.begin(), found.end());
  constexpr double kApart = 0.02;
  std::vector<Point3> distinct;
  for (const Point3& p : found)
    if (p.value < kNoMotion &&
        std::none_of(distinct.begin(), distinct.end(), [&](const Point3& q) { return distance(p, q) < kApart; }))
      distinct.push_back(p);
  const Objective objective(scene, sea, {});
  std::vector<Basin> out;
  for (const Point3& p : distinct) out.push_back({objective.motion(p), p.value});
  return out;
}

}  // namespace ukemi::landing
