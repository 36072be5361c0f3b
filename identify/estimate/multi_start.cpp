#include "identify/estimate/multi_start.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "common/parallel.hpp"

namespace ukemi::identify {

void MultiStart::search_all(int count, const Search& search) { search_batch(0, count, search); }

void MultiStart::search_until_believed(int count, const Search& search) {
  const auto continues = [&] {
    return !believed() && times_found_ < options_.same && spent_ < options_.work && !options_.monitor.stopped();
  };
  for (int i = 0; i < count && continues(); i += options_.at_once)
    search_batch(i, std::min(options_.at_once, count - i), search);
}

void MultiStart::forget() {
  best_.cost = std::numeric_limits<double>::infinity();
  minima_.clear();
}

std::vector<MultiStart::Minimum> MultiStart::minima() const {
  std::vector<Minimum> out = minima_;
  std::sort(out.begin(), out.end(),
            [](const Minimum& a, const Minimum& b) { return a.solution.cost < b.solution.cost; });
  return out;
}

void MultiStart::search_batch(int first, int count, const Search& search) {
  std::vector<LeastSquaresSolution> solutions(std::size_t(std::max(count, 0)));
  std::atomic<long> done{starts_};
  parallel_for(count, options_.threads, [&](int i) {
    solutions[std::size_t(i)] = search(first + i);
    options_.monitor.progress(++done, options_.most);
  });
  for (LeastSquaresSolution& s : solutions) add(std::move(s));  // in order, whatever the threads
}

void MultiStart::add(LeastSquaresSolution s) {
  const int start = starts_++;
  spent_ += s.work;
  if (!s.usable) {
    if (best_.message.empty()) best_.message = s.message;
    return;
  }
  if (s.converged) {
    const auto same = std::find_if(minima_.begin(), minima_.end(), [&](const Minimum& m) {
      return std::abs(m.solution.cost / s.cost - 1) < options_.same_cost;
    });
    if (same == minima_.end())
      minima_.push_back({s, start, 1});
    else if (++same->found; s.cost < same->solution.cost)
      same->solution = s, same->start = start;
  }
  if (s.cost < best_.cost * (1 - options_.same_cost)) times_found_ = 0;
  if (s.cost < best_.cost * (1 + options_.same_cost)) ++times_found_;
  if (s.cost < best_.cost || !best_.usable)
    best_ = std::move(s), best_start_ = start;
  else if (best_.message.empty())
    best_.message = s.message;
}

}  // namespace ukemi::identify
