// How well numbers are known: their names and covariance, as [uncertainty] of a file has them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/toml.hpp"

namespace ukemi {

/// From a normal number's mean to its 97.5 % quantile, in standard deviations: half of its 95 % interval.
inline constexpr double kNormal975 = 1.959963984540054;

struct Uncertainty {
  std::vector<std::string> order;
  Eigen::MatrixXd covariance;  ///< of those, in their order, SI
};

/// The key that is wrong and what is wrong with it, see `check` of common/checks.hpp; both empty: nothing.
std::pair<std::string, std::string> fault_of(const Uncertainty& uncertainty, const std::vector<std::string>& known,
                                             const std::string& whom);
/// `order` and `covariance`; each name once and one of `known`, which are constants of `whom`. Throws InputError with
/// file:line:column.
Uncertainty read_uncertainty(TomlSection& section, const std::vector<std::string>& known, const std::string& whom);
/// The line of the key `covariance`.
std::string covariance_lines(const Eigen::MatrixXd& covariance);

}  // namespace ukemi
