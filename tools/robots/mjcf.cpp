// Robots in MJCF, compiled by MuJoCo.
#include "common/error.hpp"
#include "tools/robots/spatial_robot.hpp"

#ifdef UKEMI_WITH_MJCF

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <memory>
#include <regex>

namespace ukemi::tools {

namespace {

thread_local std::vector<std::string> mujoco_warnings;

struct MujocoFailure {
  std::string text;
};

/// Replaces MuJoCo's own handlers, which write a log file and wait for a key, during its lifetime.
class MujocoHandlers {
 public:
  MujocoHandlers() : error_(mju_user_error), warning_(mju_user_warning) {
    mujoco_warnings.clear();
    mju_user_error = [](const char* text) { throw MujocoFailure{text}; };
    mju_user_warning = [](const char* text) { mujoco_warnings.push_back(text); };
  }
  ~MujocoHandlers() { mju_user_error = error_, mju_user_warning = warning_; }
  MujocoHandlers(const MujocoHandlers&) = delete;
  MujocoHandlers& operator=(const MujocoHandlers&) = delete;

 private:
  void (*error_)(const char*);
  void (*warning_)(const char*);
};

[[noreturn]] void fail_as_mujoco(const std::string& path, const std::string& text) {
  Location where{path};
  std::smatch m;
  if (std::regex_search(text, m, std::regex("line (?:= )?([0-9]{1,9})(?:, column (?:= )?([0-9]{1,9}))?"))) {
    where.line = std::stol(m[1]);
    if (m[2].matched) where.column = std::stol(m[2]);
  }
  throw InputError(where, "MuJoCo: " + std::regex_replace(text, std::regex("\\s+"), " "));
}

using Model = std::unique_ptr<mjModel, void (*)(mjModel*)>;

Model compiled(const std::string& path) {
  char error[1000] = "";
  try {
    Model model(mj_loadXML(path.c_str(), nullptr, error, sizeof error), mj_deleteModel);
    if (!model) fail_as_mujoco(path, error);
    return model;
  } catch (const MujocoFailure& failure) {
    fail_as_mujoco(path, failure.text);
  }
}

std::string name_of(const mjModel& m, mjtObj type, int id) {
  const char* given = mj_id2name(&m, type, id);
  return given && *given ? given : fmt::format("{}{}", mju_type2Str(type), id);
}
Eigen::Vector3d vector_at(const mjtNum* v, int i) { return {v[3 * i], v[3 * i + 1], v[3 * i + 2]}; }
Eigen::Isometry3d pose_at(const mjtNum* position, const mjtNum* q, int i) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = Eigen::Quaterniond(q[4 * i], q[4 * i + 1], q[4 * i + 2], q[4 * i + 3]).normalized().toRotationMatrix();
  out.translation() = vector_at(position, i);
  return out;
}

/// Maximum torque of the motors on a joint: those with a force limit, or a control limit and a constant gain.
std::optional<double> effort_of(const mjModel& m, int joint) {
  double out = 0;
  for (int a = 0; a < m.nu; ++a) {
    if (m.actuator_trntype[a] != mjTRN_JOINT || m.actuator_trnid[2 * a] != joint) continue;
    const double gear = std::abs(m.actuator_gear[6 * a]);
    const bool motor = m.actuator_gaintype[a] == mjGAIN_FIXED && m.actuator_biastype[a] == mjBIAS_NONE;
    if (m.actuator_forcelimited[a])
      out += gear * m.actuator_forcerange[2 * a + 1];
    else if (motor && m.actuator_ctrllimited[a])
      out += gear * m.actuator_gainprm[mjNGAIN * a] * m.actuator_ctrlrange[2 * a + 1];
    else
      return std::nullopt;
  }
  return out > 0 ? std::optional(out) : std::nullopt;
}

SpatialJoint joint_at(const mjModel& m, int j) {
  using enum SpatialJoint::Motion;
  SpatialJoint out;
  const int type = m.jnt_type[j], q = m.jnt_qposadr[j], dof = m.jnt_dofadr[j];
  out.name = name_of(m, mjOBJ_JOINT, j);
  out.type = type == mjJNT_HINGE ? "hinge" : type == mjJNT_SLIDE ? "slide" : type == mjJNT_BALL ? "ball" : "free";
  out.motion = type == mjJNT_HINGE ? kTurns : type == mjJNT_FREE ? kFloats : kOther;
  if (type == mjJNT_SLIDE && m.jnt_limited[j])
    out.travel = {m.jnt_range[2 * j] - m.qpos0[q], m.jnt_range[2 * j + 1] - m.qpos0[q]};
  if (type != mjJNT_HINGE) return out;
  out.axis = vector_at(m.jnt_axis, j).normalized(), out.anchor = vector_at(m.jnt_pos, j);
  if (m.jnt_limited[j]) out.lower = m.jnt_range[2 * j] - m.qpos0[q], out.upper = m.jnt_range[2 * j + 1] - m.qpos0[q];
  out.zero = m.qpos0[q];
  out.stiffness = m.jnt_stiffness[j], out.rest = m.qpos_spring[q] - m.qpos0[q];
  out.damping = m.dof_damping[dof], out.friction = m.dof_frictionloss[dof], out.armature = m.dof_armature[dof];
  out.effort = effort_of(m, j);
  return out;
}

/// Adds a body; one of several joints becomes a chain of massless frames, a joint each. Returns the index of the last.
int add_body(const mjModel& m, int b, const std::vector<int>& last, SpatialRobot& out) {
  SpatialBody body;
  body.name = b == 0 ? "world" : name_of(m, mjOBJ_BODY, b);
  if (b > 0) body.parent = last[std::size_t(m.body_parentid[b])], body.in_parent = pose_at(m.body_pos, m.body_quat, b);
  for (int k = 0; k < m.body_jntnum[b]; ++k) {
    body.joint = joint_at(m, m.body_jntadr[b] + k);
    if (k + 1 == m.body_jntnum[b]) break;
    SpatialBody frame = body;
    frame.name += " after " + body.joint.name;
    out.bodies.push_back(frame);
    body.parent = int(out.bodies.size()) - 1, body.in_parent.setIdentity();
  }
  if (body.joint.name.empty()) body.joint.name = body.name;
  body.inertia.mass = m.body_mass[b], body.inertia.tensor = vector_at(m.body_inertia, b).asDiagonal();
  body.inertia = in_frame(body.inertia, pose_at(m.body_ipos, m.body_iquat, b));
  out.bodies.push_back(std::move(body));
  return int(out.bodies.size()) - 1;
}

/// Applies equality constraints: a joint bound to another follows it; connected bodies would close a loop.
void apply_equalities(const mjModel& m, SpatialRobot& out) {
  for (int e = 0; e < m.neq; ++e) {
    if (!m.eq_active[e]) continue;
    const int type = m.eq_type[e], other = m.eq_obj2id[e];
    if (type == mjEQ_CONNECT || type == mjEQ_WELD)
      throw InputError(
          {out.file}, fmt::format("equality {}: it holds {} and {} together: a tree is needed",
                                  quoted(name_of(m, mjOBJ_EQUALITY, e)), quoted(name_of(m, mjOBJ_BODY, m.eq_obj1id[e])),
                                  quoted(other > 0 ? name_of(m, mjOBJ_BODY, other) : "world")));
    if (type != mjEQ_JOINT) continue;
    const std::string bound = name_of(m, mjOBJ_JOINT, m.eq_obj1id[e]);
    for (SpatialBody& body : out.bodies)
      if (body.joint.name == bound) body.joint.follows = other >= 0 ? name_of(m, mjOBJ_JOINT, other) : "a constant";
  }
}

}  // namespace

SpatialRobot read_mjcf(const std::string& path) {
  SpatialRobot out;
  out.file = path, out.format = "MJCF", out.no_drive = "actuators of MJCF are no drives here";
  const MujocoHandlers handlers;
  const Model model = compiled(path);
  const mjModel& m = *model;
  std::vector<int> last;
  for (int b = 0; b < m.nbody; ++b) last.push_back(add_body(m, b, last, out));
  const auto point = [&](mjtObj type, const char* kind, int id, int body, const Eigen::Vector3d& at) {
    if (mj_id2name(&m, type, id)) out.points.push_back({name_of(m, type, id), kind, last[std::size_t(body)], at});
  };
  for (int s = 0; s < m.nsite; ++s) point(mjOBJ_SITE, "site", s, m.site_bodyid[s], vector_at(m.site_pos, s));
  for (int b = 1; b < m.nbody; ++b) point(mjOBJ_BODY, "body", b, b, Eigen::Vector3d::Zero());
  for (int g = 0; g < m.ngeom; ++g) point(mjOBJ_GEOM, "geom", g, m.geom_bodyid[g], vector_at(m.geom_pos, g));
  apply_equalities(m, out);
  out.gravity = vector_at(m.opt.gravity, 0);
  out.left_out = {fmt::format("{} geoms' shapes", m.ngeom), fmt::format("{} actuators", m.nu),
                  fmt::format("{} tendons", m.ntendon), fmt::format("{} sensors", m.nsensor)};
  out.warnings = mujoco_warnings;
  return out;
}

}  // namespace ukemi::tools

#else

namespace ukemi::tools {

SpatialRobot read_mjcf(const std::string& path) {
  throw InputError({path}, "this program was built without MuJoCo: for MJCF install libmujoco-dev and build again");
}

}  // namespace ukemi::tools

#endif
