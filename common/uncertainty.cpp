#include "common/uncertainty.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/csv.hpp"
#include "common/error.hpp"

namespace ukemi {

Uncertainty read_uncertainty(TomlSection& section, const std::vector<std::string>& known, const std::string& whom) {
  const auto order = section.optional_texts("order");
  const auto covariance = section.optional_matrix("covariance");
  if (!order || !covariance) section.fail("order", "both 'order' and 'covariance' are needed");
  if (covariance->size() != order->size())
    section.fail("covariance", fmt::format("{} rows: 'order' names {}", covariance->size(), order->size()));
  for (auto name = order->begin(); name != order->end(); ++name) {
    if (std::find(known.begin(), known.end(), *name) == known.end())
      section.fail("order", quoted(*name) + ": not a constant of " + whom + hint(*name, known));
    if (std::find(order->begin(), name, *name) != name) section.fail("order", quoted(*name) + ": named twice");
  }
  const auto n = long(order->size());
  Uncertainty out{*order, Eigen::MatrixXd(n, n)};
  for (long i = 0; i < n; ++i)
    for (long j = 0; j < n; ++j) out.covariance(i, j) = (*covariance)[std::size_t(i)][std::size_t(j)];
  if ((out.covariance.diagonal().array() < 0).any()) section.fail("covariance", "a variance below 0 on its diagonal");
  return out;
}

std::string covariance_lines(const Eigen::MatrixXd& covariance) {
  std::string t = "covariance = [\n";
  for (long i = 0; i < covariance.rows(); ++i) {
    t += "  [";
    for (long j = 0; j < covariance.cols(); ++j) t += (j ? ", " : "") + shortest(covariance(i, j));
    t += "],\n";
  }
  return t + "]\n";
}

}  // namespace ukemi
