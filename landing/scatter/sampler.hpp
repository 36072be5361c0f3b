// Maps points of the unit cube to random numbers of given distributions, group by group.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace ukemi::landing {

/// Seeds of other drops than those of a search with this seed: to select among its best candidates, and to report the
/// answer.
constexpr std::uint64_t selection_seed(std::uint64_t seed) { return seed ^ std::uint64_t{0x9d6e5} << 32; }
constexpr std::uint64_t fresh_seed(std::uint64_t seed) { return seed ^ std::uint64_t{0xf4e5a} << 32; }

/// Quantile at u in (0, 1) of the standard normal distribution truncated at three deviations.
double truncated_normal(double u);

/// Numbers that are drawn together, under one name.
struct ScatterGroup {
  std::string name;
  int first, count;  ///< coordinates
};

class Sampler {
 public:
  /// Adds independent normal numbers of this standard deviation, truncated at three deviations.
  void normal(const std::string& name, double deviation, int count = 1);
  /// Adds normal numbers of a covariance, their standard deviations times `factor`. Throws InputError for a covariance
  /// that is not positive semidefinite.
  void correlated(const std::string& name, const Eigen::MatrixXd& covariance, double factor = 1);
  /// Adds uniform numbers from -1 to 1.
  void uniform(const std::string& name, int count);

  /// Number of coordinates that a sample is drawn from, one for each number; 0: nothing scatters.
  int dimension() const { return dimension_; }
  const std::vector<ScatterGroup>& groups() const { return groups_; }
  /// The numbers at a point of the cube, dimension() of them, in the order in which their groups were added.
  std::vector<double> at(std::span<const double> u) const;

  /// Scrambled Sobol points from point `first` on, concatenated: see ScrambledSobol.
  std::vector<double> even(long count, std::uint64_t seed, long first = 0) const;
  /// Independent points.
  std::vector<double> independent(long count, std::uint64_t seed) const;

 private:
  struct Block {
    int first;
    Eigen::MatrixXd root;  ///< R R^T is the covariance; empty: uniform
  };
  void add(const std::string& name, int count, Eigen::MatrixXd root);

  std::vector<Block> blocks_;
  std::vector<ScatterGroup> groups_;
  int dimension_ = 0;
};

}  // namespace ukemi::landing
