#!/usr/bin/env bash
# gazebo.sh UKEMI READER SOURCE: an actuator's URDF as Gazebo's parser understands it.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
cat > "$folder/leg.toml" <<'TOML'
[actuator]
name = "leg"
k_p = 50
k_d = 2
k_sea = 65.5
c_sea = 1.75
i_motor = 0.085
friction = 0.5
viscous_friction = 0.25
TOML
"$1" predict "$3/datasets/impact/trial_1.csv" --rig "$3/datasets/rigs/paper.toml" --actuator "$folder/leg.toml" \
  --export urdf --no-report --quiet -o "$folder/out" >/dev/null
"$2" "$folder/out/actuator.urdf.xml" | tee "$folder/read"
diff "$folder/read" - <<'READ'
knee_motor: damping 0.25, friction 0.5, stiffness 0
knee_spring: damping 1.75, friction 0, stiffness 65.5
READ
