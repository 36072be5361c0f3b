// Fisher information of trials on the constants. At an estimate u, a trial with predicted angles phi_n(u) and noise
// sigma has the information on the constants, each relative to its value,
//
//     I_ij = sum_n (u_i dphi_n/du_i) (u_j dphi_n/du_j) / sigma^2,
//
// which adds up over trials; I^-1 is the covariance to expect. Derivatives are exact. Tests: test/unit/design.cpp.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/actuator.hpp"
#include "common/actuator_constants.hpp"
#include "identify/rollout/rollout.hpp"

namespace ukemi::identify {

using ConstantJet = ceres::Jet<double, kSmallJet>;

/// The rig's angles with derivatives by each of `constants` relative to its value, u_i dphi/du_i in slot i.
RolloutStatus differentiate(const Rig& rig, const SeaParameters<double>& sea, const std::vector<int>& constants,
                            const PreparedTrial& trial, std::vector<ConstantJet>& phi, std::vector<ConstantJet>& phi_m);

/// The current knowledge of the constants.
struct Knowledge {
  SeaParameters<double> sea;    ///< the estimate, torque limit included
  std::vector<int> constants;   ///< which of the five are uncertain (each above 0); the others are taken as known
  Eigen::MatrixXd information;  ///< of those, relative to their values
  long measurements = 0;        ///< number of angles behind it; 0: unknown, then intervals are normal, not Student's
  void validate() const;        ///< throws InputError
};

/// I of one trial (noise above 0), see above, of the angles that its log holds; none where the rollout fails.
std::optional<Eigen::MatrixXd> information_of(const Rig& rig, const SeaParameters<double>& sea,
                                              const std::vector<int>& constants, const Trial& trial, double noise);
/// The constants above 0 that the file calls uncertain; all that are above 0 where it calls none.
std::vector<int> uncertain_constants(const Actuator& actuator);
/// The knowledge from existing trials at an estimate. Throws InputError where a rollout fails: it does not fit them.
Knowledge knowledge_of(const Rig& rig, const SeaParameters<double>& sea, const std::vector<int>& constants,
                       const std::vector<Trial>& trials, double noise);
/// The knowledge in an actuator file: the inverse of its covariance; none where it holds none, or a singular one.
std::optional<Knowledge> knowledge_of(const Actuator& actuator);

/// I^-1; none where the information is singular.
std::optional<Eigen::MatrixXd> covariance_of(const Eigen::MatrixXd& information);
/// Relative 95 % half-widths, a constant each; infinite where they are not determined.
Eigen::VectorXd half_widths(const Eigen::MatrixXd& information, long measurements);

/// The criterion that a set of hits minimises, each a relative standard error: that of the worst-known constant, the
/// geometric mean of the axes of the ellipsoid (D-optimal), its longest axis (E-optimal).
enum class Criterion { kWorst, kD, kE };
const char* name(Criterion criterion);
double criterion_value(Criterion criterion, const Eigen::MatrixXd& information);  ///< infinite where not determined

}  // namespace ukemi::identify
