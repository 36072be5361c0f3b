#include "identify/rollout/kernels.hpp"

namespace ukemi::identify {

using Large = ceres::Jet<double, kLargeJet>;
template RolloutStatus rollout(const Rig&, const SeaParameters<Large>&, const Nuisance<Large>&, const PreparedTrial&,
                               const RolloutOptions&, std::vector<Large>&, std::vector<Large>&, std::vector<Large>*);

}  // namespace ukemi::identify
