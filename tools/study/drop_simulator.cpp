#include "tools/study/drop_simulator.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "common/parallel.hpp"

namespace ukemi::tools {

bool differentiate_by_differences(const Settings& settings, double part, int threads, const FollowBeside& follow,
                                  FollowedDrop& followed) {
  followed.slope.assign(followed.value.size(), {});
  for (std::size_t o = 0; o < followed.value.size(); ++o)
    if (!followed.value[o].empty()) followed.slope[o].resize(long(followed.value[o].size()), long(settings.size()));
  std::atomic<long> steps{0};
  std::atomic<bool> done{true};
  parallel_for(int(settings.size()), threads, [&](int c) {
    const auto& [term, value] = settings[std::size_t(c)];
    const double size = part * std::max(term->is_constant() ? std::abs(value) : 0, term->size);
    for (const double h : {size, -size}) {
      if (!(value + h > term->lower && value + h <= term->upper)) continue;
      Settings beside = settings;
      beside[std::size_t(c)].value += h;
      const FollowedDrop there = follow(beside, *term, h);
      steps += there.steps;
      if (!there.complete) continue;
      for (std::size_t o = 0; o < followed.value.size(); ++o)
        for (std::size_t i = 0; i < followed.value[o].size(); ++i)
          followed.slope[o](long(i), c) = (there.value[o][i] - followed.value[o][i]) / h;
      return;
    }
    done = false;
  });
  followed.steps += steps;
  if (!done) followed.slope.clear();
  return done;
}

}  // namespace ukemi::tools
