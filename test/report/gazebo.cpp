// Gazebo's own parser reads what `--export urdf` writes: the joints, their damping and the spring.
#include <cstdio>
#include <cstdlib>
#include <sdf/sdf.hh>

int main(int, char** arguments) {
  sdf::Root root;
  const sdf::Errors errors = root.Load(arguments[1]);
  for (const sdf::Error& e : errors) std::printf("%s\n", e.Message().c_str());
  if (!errors.empty() || !root.Model() || root.Model()->JointCount() != 2) return 1;
  for (unsigned i = 0; i < 2; ++i) {
    const sdf::Joint& joint = *root.Model()->JointByIndex(i);
    std::printf("%s: damping %.17g, friction %.17g, stiffness %.17g\n", joint.Name().c_str(), joint.Axis()->Damping(),
                joint.Axis()->Friction(), joint.Axis()->SpringStiffness());
  }
}
