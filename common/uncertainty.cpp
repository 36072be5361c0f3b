#include "common/uncertainty.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/csv.hpp"
#include "common/eigen.hpp"
#include "common/error.hpp"
#include "common/toml.hpp"
#include "common/uncertainty_file.hpp"

namespace ukemi {

std::pair<std::string, std::string> fault_of(const Uncertainty& u, const std::vector<std::string>& known,
                                             const std::string& owner) {
  for (auto name = u.order.begin(); name != u.order.end(); ++name) {
    if (std::find(known.begin(), known.end(), *name) == known.end())
      return {"order", quoted(*name) + ": not a constant of " + owner + hint(*name, known)};
    if (std::find(u.order.begin(), name, *name) != name) return {"order", quoted(*name) + ": named twice"};
  }
  constexpr double kRounding = 1e-6;  // relative to both standard errors
  const auto c = eigen(u.covariance);
  const auto n = long(u.order.size());
  const auto wrong = [](const std::string& message) {
    return std::pair<std::string, std::string>("covariance", message);
  };
  if (c.rows() != n) return wrong(fmt::format("{} rows: 'order' names {}", c.rows(), n));
  if (c.cols() != n) return wrong(fmt::format("{} columns: 'order' names {}", c.cols(), n));
  if (!c.allFinite()) return wrong("finite numbers are needed");
  if ((c.diagonal().array() < 0).any()) return wrong("a variance below 0 on its diagonal");
  for (long i = 0; i < n; ++i)
    for (long j = 0; j < i; ++j)
      if (std::abs(c(i, j) - c(j, i)) > kRounding * std::sqrt(c(i, i) * c(j, j)))
        return wrong(fmt::format("{} in row {}, column {}, and {} in row {}, column {}: a symmetric matrix is needed",
                                 shortest(c(i, j)), i + 1, j + 1, shortest(c(j, i)), j + 1, i + 1));
  return {"", ""};
}

Uncertainty read_uncertainty(TomlSection& section, const std::vector<std::string>& known, const std::string& owner) {
  const auto order = section.optional_texts("order");
  const auto rows = section.optional_matrix("covariance");
  if (!order || !rows) section.fail("order", "both 'order' and 'covariance' are needed");
  const auto n = long(rows->size());
  Uncertainty out{*order, DenseMatrix(n, n)};
  for (long i = 0; i < n; ++i)
    for (long j = 0; j < n; ++j) out.covariance(i, j) = (*rows)[std::size_t(i)][std::size_t(j)];
  if (const auto [key, message] = fault_of(out, known, owner); !message.empty()) section.fail(key, message);
  return out;
}

std::string covariance_lines(const DenseMatrix& covariance) {
  std::string t = "covariance = [\n";
  for (long i = 0; i < covariance.rows(); ++i) {
    t += "  [";
    for (long j = 0; j < covariance.cols(); ++j) t += (j ? ", " : "") + shortest(covariance(i, j));
    t += "],\n";
  }
  return t + "]\n";
}

}  // namespace ukemi
