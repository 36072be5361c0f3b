#include "tools/study/drop_simulator.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "common/parallel.hpp"

namespace ukemi::tools {

bool finite_difference_slopes(const Settings& settings, double relative_step, int threads,
                              const FollowPerturbed& follow, FollowedDrop& followed) {
  followed.slope.assign(followed.value.size(), {});
  for (std::size_t o = 0; o < followed.value.size(); ++o)
    if (!followed.value[o].empty()) followed.slope[o].resize(long(followed.value[o].size()), long(settings.size()));
  std::atomic<long> steps{0};
  std::atomic<bool> done{true};
  parallel_for(int(settings.size()), threads, [&](int c) {
    const auto& [term, value] = settings[std::size_t(c)];
    const double size = relative_step * std::max(term->is_constant() ? std::abs(value) : 0, term->size);
    for (const double h : {size, -size}) {
      if (!(value + h > term->lower && value + h <= term->upper)) continue;
      Settings perturbed = settings;
      perturbed[std::size_t(c)].value += h;
      const FollowedDrop stepped = follow(perturbed, *term, h);
      steps += stepped.steps;
      if (!stepped.complete) continue;
      for (std::size_t o = 0; o < followed.value.size(); ++o)
        for (std::size_t i = 0; i < followed.value[o].size(); ++i)
          followed.slope[o](long(i), c) = (stepped.value[o][i] - followed.value[o][i]) / h;
      return;
    }
    done = false;
  });
  followed.steps += steps;
  if (!done) followed.slope.clear();
  return done;
}

}  // namespace ukemi::tools
