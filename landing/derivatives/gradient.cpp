#include "landing/derivatives/gradient.hpp"

#include "landing/body/by_links.hpp"
#include "landing/derivatives/body_gradient.hpp"

namespace ukemi::landing {

namespace {

/// The parameter of the robot of links; those of the floor are of all contacts together.
BodyParameter body_parameter(Parameter p) {
  using Of = BodyParameter::Of;
  const int of_drop = int(p) - int(Parameter::kHeight), of_contact = int(p) - int(Parameter::kStiffness),
            of_drive = int(p) - int(Parameter::kKp);
  if (of_drive >= 0) return {Of::kDrive, 0, of_drive};
  if (of_contact >= 0) return {Of::kContact, -1, of_contact};
  if (of_drop >= 0) return {Of::kDrop, -1, of_drop};
  return {Of::kMotion, -1, int(p)};
}

/// The gradients by the first P of Parameter.
template <int P>
PeakGradients<P> first_gradients(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                 const SimulateOptions& options, int max_peaks) {
  validate(scene, sea, motion), options.validate();
  const TwoLinkLanding l(scene, sea, motion);
  std::array<BodyParameter, P> parameters;
  for (int i = 0; i < P; ++i) parameters[std::size_t(i)] = body_parameter(Parameter(i));
  const BodyGradients found = gradients(l.scene, l.motion, parameters, options, max_peaks);
  PeakGradients<P> out{{}, found.t_end, found.end, found.status, found.work};
  for (const BodyPeakGradient& p : found.peaks) out.peaks.push_back({p.t, p.value, p.d, p.kind, p.contact});
  return out;
}

}  // namespace

PeakGradients<kQuinticParameters> quintic_peaks(const Scene& scene, const SeaParameters<double>& sea,
                                                const Motion& motion, const SimulateOptions& options, int max_peaks) {
  return first_gradients<kQuinticParameters>(scene, sea, motion, options, max_peaks);
}

PeakGradients<kMotionParameters> motion_peaks(const Scene& scene, const SeaParameters<double>& sea,
                                              const Motion& motion, const SimulateOptions& options, int max_peaks) {
  return first_gradients<kMotionParameters>(scene, sea, motion, options, max_peaks);
}

PeakGradients<kParameters> all_gradients(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                         const SimulateOptions& options, int max_peaks) {
  return first_gradients<kParameters>(scene, sea, motion, options, max_peaks);
}

}  // namespace ukemi::landing
