#include "landing/optimize.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "common/error.hpp"
#include "common/parallel.hpp"
#include "common/random.hpp"
#include "landing/nlopt_solver.hpp"

namespace ukemi::landing {

void OptimizeOptions::validate() const {
  if (evaluations < 1) throw InputError("evaluations: " + std::to_string(evaluations) + ": at least 1 is needed");
  const auto& names = nlopt_names();
  if (solver != "auto" && std::find(names.begin(), names.end(), solver) == names.end()) {
    std::string all = "auto";
    for (const std::string& n : names) all += ", " + n;
    throw InputError("solver: " + quoted(solver) + ": one of " + all + " is needed" + hint(solver, names));
  }
}

namespace {

constexpr double kFailed = 1e9;  ///< the objective where a landing could not be followed; finite, for NLopt

/// The box scaled to the unit cube.
class Box {
 public:
  Box(const Scene& scene, const SeaParameters<double>& sea) : scene_(scene), sea_(sea) {}

  Motion motion(const double* u) const {
    const auto& r = scene_.search;
    const auto in = [](const std::array<double, 2>& range, double s) {
      return std::clamp(range[0] + s * (range[1] - range[0]), range[0], range[1]);
    };
    return {in(r.phi, u[0]), in(r.phi, u[1]), in(r.duration, u[2])};
  }
  double operator()(const double* u, double accuracy, double bound = std::numeric_limits<double>::infinity()) const {
    const LandingPeak p = peak_acceleration(scene_, sea_, motion(u), {.accuracy = accuracy, .abandon_above = bound});
    return p.end == End::kFailed ? kFailed : p.peak;
  }

 private:
  const Scene& scene_;
  const SeaParameters<double>& sea_;
};

struct Candidate {
  double value = std::numeric_limits<double>::infinity();
  std::array<double, 3> u{0.5, 0.5, 0.5};
  bool operator<(const Candidate& o) const { return value < o.value; }
};

/// Counts landings across threads and tells the caller.
class Progress {
 public:
  explicit Progress(const OptimizeOptions& o) : options_(o) {}
  void add(long landings) {
    const std::lock_guard lock(mutex_);
    done_ += landings;
    if (options_.progress) options_.progress(std::min(done_, options_.evaluations), options_.evaluations);
  }

 private:
  const OptimizeOptions& options_;
  std::mutex mutex_;
  long done_ = 0;
};

Candidate from(const NloptResult& r) { return {r.value, {r.x[0], r.x[1], r.x[2]}}; }

NloptProblem local_problem(const Box& box, const Candidate& start, double size, double accuracy) {
  NloptProblem p{[&box, accuracy](const double* u) { return box(u, accuracy); }, {0, 0, 0}, {1, 1, 1}, {}, {}};
  for (const double u : start.u) {
    p.start.push_back(u);
    p.step.push_back(u + size <= 1 ? size : -size);  // a step inside the box
  }
  for (double& s : p.step) s = std::abs(s);
  return p;
}

/// Sampling, then polishing of the best distinct samples, then of the best of those. Every stage is a fixed list of
/// independent pieces of work, so that threads change nothing.
Candidate search(const Box& box, const OptimizeOptions& o, long& used) {
  constexpr int kChunk = 512;
  const long samples = std::max<long>(1, o.evaluations * 2 / 5);
  const int keep = int(std::clamp<long>(o.evaluations / 500, 1, 24));
  const long polish = o.evaluations * 2 / 5 / keep;
  Progress progress(o);
  std::vector<Candidate> best;
  for (long begin = 0; begin < samples; begin += kChunk) {
    std::vector<Candidate> chunk(std::size_t(std::min<long>(kChunk, samples - begin)));
    // Beyond four times as many as are kept, the worst of the best so far bounds what is of interest.
    const double bound = best.size() >= std::size_t(4 * keep) ? best[std::size_t(4 * keep - 1)].value : kFailed;
    parallel_for(int(chunk.size()), o.threads, [&](int i) {
      Random random(o.seed, std::uint64_t(begin + i));
      Candidate& c = chunk[std::size_t(i)];
      for (double& u : c.u) u = random.uniform();
      c.value = box(c.u.data(), o.search_accuracy, bound);
    });
    best.insert(best.end(), chunk.begin(), chunk.end());
    std::stable_sort(best.begin(), best.end());
    best.resize(std::min(best.size(), std::size_t(8 * keep)));
    progress.add(long(chunk.size()));
  }
  used += samples;

  // Distinct starts: no two within a twentieth of the box of each other.
  std::vector<Candidate> starts;
  for (const Candidate& c : best) {
    const bool near = std::any_of(starts.begin(), starts.end(), [&](const Candidate& s) {
      return std::abs(s.u[0] - c.u[0]) < 0.05 && std::abs(s.u[1] - c.u[1]) < 0.05 && std::abs(s.u[2] - c.u[2]) < 0.05;
    });
    if (!near && starts.size() < std::size_t(keep)) starts.push_back(c);
  }
  std::vector<long> spent(starts.size());
  const auto run = [&](int i, const char* algorithm, double size, long evaluations, double accuracy) {
    Candidate& c = starts[std::size_t(i)];
    if (evaluations < 2) return;
    const NloptResult r = minimize(algorithm, local_problem(box, c, size, accuracy),
                                   {.evaluations = evaluations, .x_tolerance = 1e-7}, o.seed + std::uint64_t(i));
    spent[std::size_t(i)] += r.evaluations;
    progress.add(r.evaluations);
    if (r.value < c.value) c = from(r);
  };
  parallel_for(int(starts.size()), o.threads, [&](int i) { run(i, "sbplx", 0.03, polish, o.search_accuracy); });
  std::stable_sort(starts.begin(), starts.end());
  starts.resize(std::min<std::size_t>(starts.size(), 4));
  spent.resize(std::max(spent.size(), starts.size()));
  long so_far = used;
  for (const long s : spent) so_far += s;
  const long rest = std::max<long>(0, o.evaluations - so_far) / long(2 * starts.size());
  // The best stand on cliffs: what the search's accuracy takes for this side may be the other. So the end is played at
  // the result's own accuracy.
  parallel_for(int(starts.size()), o.threads, [&](int i) {
    Candidate& c = starts[std::size_t(i)];
    c.value = box(c.u.data(), o.accuracy);
    run(i, "nelder_mead", 0.02, rest, o.accuracy);
    run(i, "sbplx", 0.004, rest, o.accuracy);
  });
  for (const long s : spent) used += s;
  return *std::min_element(starts.begin(), starts.end());
}

/// One NLopt algorithm as it comes; a local one is started again at random until the evaluations are spent.
Candidate plain(const Box& box, const OptimizeOptions& o, long& used) {
  Candidate best;
  for (std::uint64_t restart = 0; used < o.evaluations; ++restart) {
    Candidate start;
    Random random(o.seed, restart);
    if (restart > 0)
      for (double& u : start.u) u = random.uniform();
    const NloptResult r = minimize(o.solver, local_problem(box, start, 0.1, o.search_accuracy),
                                   {.evaluations = o.evaluations - used, .x_tolerance = 1e-6}, o.seed + restart);
    used += std::max<long>(1, r.evaluations);
    if (r.value < best.value) best = from(r);
  }
  return best;
}

}  // namespace

Optimum optimize(const Scene& scene, const SeaParameters<double>& sea, const OptimizeOptions& options) {
  options.validate();
  const Box box(scene, sea);
  Optimum out;
  const Candidate best =
      options.solver == "auto" ? search(box, options, out.evaluations) : plain(box, options, out.evaluations);
  out.motion = box.motion(best.u.data());
  const SimulateOptions tight{.accuracy = options.accuracy};
  out.landing = peak_acceleration(scene, sea, out.motion, tight);
  out.found = best.value < kFailed && out.landing.end != End::kFailed;
  if (!out.found) {
    out.message = "no motion of the search range could be followed";
    return out;
  }
  out.tolerant = tolerant_peak(scene, sea, out.motion, tight, options.tolerance_samples, options.seed, options.threads);
  return out;
}

}  // namespace ukemi::landing
