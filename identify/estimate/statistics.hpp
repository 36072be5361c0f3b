// Tests of residuals, each with a probability under the hypothesis that nothing is wrong; and a quantile.
#pragma once

#include <span>
#include <vector>

namespace ukemi::identify {

/// P(X > x) of the chi-squared distribution with `degrees` > 0 degrees of freedom; 1 for x <= 0.
double chi_squared_tail(double x, double degrees);

/// The x > 0 with P(X > x) = level, 0 < level < 1.
double chi_squared_quantile(double level, double degrees);

/// Which of several hypotheses are rejected so that, were all true, any would be with probability `level` at most: the
/// k-th smallest p below level / (number - k + 1), and all smaller ones so too (Holm 1979).
std::vector<bool> holm(const std::vector<double>& p, double level);

/// P(X > ratio) of twice the logarithm of a likelihood ratio for `terms` further terms whose truth, if they are absent,
/// is the bound 0: the mixture of chi-squared distributions with binomial weights (Self, Liang 1987; for one term
/// 50:50), the terms taken as uncorrelated.
double at_bound_tail(double ratio, int terms);

/// Root mean square distance from a bound under a normal distribution of standard deviation 1, truncated at the bound,
/// whose mean lies `beyond` >= 0 outside of it: 1 for 0, about sqrt(2) / beyond far outside.
double spread_from_bound(double beyond);

/// Ljung and Box's Q over the lags 1 .. lags of one series of mean 0: chi-squared with as many degrees of freedom where
/// the series is white. Not demeaned: an offset is no white noise. 0 for a series that is 0 or too short for the lags.
double ljung_box(const std::vector<double>& series, int lags);

/// Sum of x_i x_(i + lag).
double lagged_product(std::span<const double> x, std::size_t lag);

/// NaN for an empty series.
double root_mean_square(std::span<const double> x);

struct Moments {
  double count = 0, skewness = 0, kurtosis = 0;  ///< kurtosis of the normal distribution: 0
};
/// About the series' mean; 0 for a series that is constant.
Moments moments(const std::vector<double>& series);

/// Jarque and Bera's statistic, chi-squared with 2 degrees of freedom where the samples are normal.
double jarque_bera(const Moments& m);

/// t quantile at 97.5 % for n - p degrees of freedom: the half width of a 95 % interval in standard errors.
double t_quantile_975(long degrees_of_freedom);

}  // namespace ukemi::identify
