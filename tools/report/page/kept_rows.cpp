#include "tools/report/page/kept_rows.hpp"

#include <algorithm>

namespace ukemi::tools {

std::vector<std::size_t> kept_rows(const std::vector<const std::vector<double>*>& columns, std::size_t parts) {
  std::vector<std::size_t> out;
  const std::size_t n = columns.empty() ? 0 : columns.front()->size();
  const bool all = n <= 3 * parts;
  for (std::size_t part = 0; part < (all ? n : parts); ++part) {
    const std::size_t begin = all ? part : n * part / parts, end = all ? part + 1 : n * (part + 1) / parts;
    std::vector<std::size_t> kept = {begin};
    for (const std::vector<double>* c : columns) {
      const auto [low, high] = std::minmax_element(c->begin() + long(begin), c->begin() + long(end));
      kept.push_back(std::size_t(low - c->begin())), kept.push_back(std::size_t(high - c->begin()));
    }
    std::sort(kept.begin(), kept.end());
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    out.insert(out.end(), kept.begin(), kept.end());
  }
  if (n > 0 && out.back() != n - 1) out.push_back(n - 1);
  return out;
}

}  // namespace ukemi::tools
