#include "identify/rollout/kernels.hpp"

namespace ukemi::identify {

using Small = ceres::Jet<double, kSmallJet>;
template RolloutStatus rollout(const Rig&, const SeaParameters<Small>&, const Nuisance<Small>&, const PreparedTrial&,
                               const RolloutOptions&, std::vector<Small>&, std::vector<Small>&, std::vector<Small>*);

}  // namespace ukemi::identify
