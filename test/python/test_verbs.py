"""Every verb tells in Python what the program tells, and its report is the program's."""
import html.parser
import math
import pathlib
import pickle
import re
import subprocess

import numpy as np
import pytest

import ukemi
from told import BUILD, numbers, program

SCENE, TABLE2 = ukemi.dataset("scenes/paper.toml"), ukemi.dataset("actuators/table2.toml")
RIG, HOPPER = ukemi.dataset("rigs/paper.toml"), ukemi.dataset("scenes/hopper.toml")
TRIALS = [ukemi.dataset(f"impact/trial_{i}.csv") for i in (1, 2)]
MOTIONS = pathlib.Path(__file__).parent.parent / "data/hopper_motion.toml"


@pytest.fixture(scope="module")
def rig():
    return ukemi.read_rig(RIG)


@pytest.fixture(scope="module")
def trials():
    return [ukemi.read_trial(p) for p in TRIALS]


@pytest.fixture(scope="module")
def fit(rig, trials):
    return ukemi.identify(trials, rig)


def same(result, folder, *arguments):
    """The report's summary against the program's. Returns it."""
    mine, told = ukemi.write_report(result, folder / "mine"), program(folder / "its", *arguments)
    assert numbers(mine) == numbers(told)
    assert (folder / "mine/report.html").stat().st_size > 10_000
    return mine


def test_identify_and_predict(rig, trials, fit, scene, actuator, tmp_path):
    same(fit, tmp_path, "identify", *TRIALS, "--rig", RIG)
    for_landing = ukemi.identify(trials, rig, scene=scene, motion=ukemi.hold(-45))
    told = same(for_landing, tmp_path, "identify", *TRIALS, "--rig", RIG, "--scene", SCENE, "--hold", -45)
    assert for_landing.landing["samples"] == 1024 and any("peak" in k or "landing" in k for k in told)
    same(ukemi.predict(trials, rig, actuator), tmp_path, "predict", *TRIALS, "--rig", RIG, "--actuator", TABLE2)


def test_design(rig, trials, fit, tmp_path):
    fit.actuator.save(tmp_path / "fit.toml")
    design = ukemi.design(rig, fit.actuator, trials, hits=1, check=4)
    told = same(design, tmp_path, "design", *TRIALS, "--rig", RIG, "--actuator", tmp_path / "fit.toml", "--hits", 1,
                "--check", 4)
    assert design.found and len(design.hits) == 1 and design.agrees == told["check"]["agrees"]
    assert design.hits[0].peak == told["hits"][0]["peak"] and design.value == told["criterion"]["after"]
    assert design.after["k_sea"] == told["constants"]["k_sea"]["half_width_after"] < design.before["k_sea"]
    assert f"criterion worst {design.value:.4g}" in repr(design)
    with pytest.raises(ukemi.InputError, match="noise: without trials"):
        ukemi.design(rig, fit.actuator)
    with pytest.raises(ukemi.InputError, match="actuator: no covariance of the constants"):
        ukemi.design(rig, ukemi.Actuator(0, 0, 0, 0, 1), noise=1e-4)
    for wrong in ({"criterion": "best"}, {"directions": "up"}, {"hits": 0}, {"width": (0.02, 0.01)}, {"noise": math.nan},
                  {"check": -1}, {"angle": -1}):
        with pytest.raises(ukemi.InputError):
            ukemi.design(rig, fit.actuator, trials, **wrong)


def test_compare(rig, trials, actuator, fit, scene, tmp_path):
    fit.actuator.save(tmp_path / "fit.toml")
    identified = ukemi.read_actuator(tmp_path / "fit.toml")
    found = ukemi.compare(actuator, identified, scene=scene, trials=trials, rig=rig)
    told = same(found, tmp_path, "compare", "--nominal", TABLE2, "--identified", tmp_path / "fit.toml", "--scene",
                SCENE, "--trials", *TRIALS, "--rig", RIG)
    assert found.complete and [m.set for m in found.motions] == ["nominal", "identified"]
    assert {c.name: c.z for c in found.constants} == {k: v["z"] for k, v in told["parameters"].items()}
    assert found.rms.keys() == found.motions[0].peaks.keys() == {"nominal", "identified"}
    assert not ukemi.compare(actuator, identified).motions
    for wrong in ({"robust": "mean"}, {"trials": trials}, {"rig": rig}, {"scene": scene, "robust": "worse"}):
        with pytest.raises(ukemi.InputError):
            ukemi.compare(actuator, identified, **wrong)


def test_simulate_optimize_risk(scene, actuator, tmp_path):
    paper = [SCENE, "--actuator", TABLE2]
    same(ukemi.simulate(scene, actuator, ukemi.hold(-30)), tmp_path, "simulate", *paper, "--hold", -30)
    same(ukemi.optimize(scene, actuator, evaluations=500, objective="tolerant"), tmp_path, "optimize", *paper,
         "--evaluations", 500, "--objective", "tolerant")
    same(ukemi.risk(scene, actuator, ukemi.hold(-45), samples=500), tmp_path, "risk", *paper, "--hold", -45,
         "--samples", 500)
    best = ukemi.optimize(scene, actuator, evaluations=2000, robust="cvar", samples=16)
    same(best, tmp_path, "optimize", *paper, "--evaluations", 2000, "--robust", "cvar", "--samples", 16)
    assert best.motion.goal == best.goal and best.motion.value == best.value and "cvar" in best.goal


def test_measured_drops(scene, actuator, tmp_path):
    ukemi.risk(scene, actuator, ukemi.hold(-45), samples=200).write_report(tmp_path / "drawn")
    measured = tmp_path / "drawn/risk.csv"
    paper = [SCENE, "--actuator", TABLE2, "--drops", measured]
    same(ukemi.risk(scene, actuator, ukemi.hold(-45), drops=measured), tmp_path, "risk", *paper, "--hold", -45)
    same(ukemi.optimize(scene, actuator, evaluations=2000, robust="mean", samples=16, drops=measured), tmp_path,
         "optimize", *paper, "--evaluations", 2000, "--robust", "mean", "--samples", 16)
    for wrong in ({"scatter": "height=0.01"}, {"inflate": 2}, {"inexact": True}):
        with pytest.raises(ukemi.InputError, match="has no effect"):
            ukemi.risk(scene, actuator, ukemi.hold(-45), drops=measured, **wrong)


def test_map_and_ratings(scene, actuator, tmp_path):
    paper = [SCENE, "--actuator", TABLE2]
    same(ukemi.map(scene, actuator, grid=[5, 4, 3], polish=2), tmp_path, "map", *paper, "--grid", "5,4,3", "--polish", 2)
    rated = ukemi.ratings(scene, actuator, [4, 12], evaluations=500)
    same(rated, tmp_path, "ratings", *paper, "--motor-speed", "4:12:2", "--evaluations", 500)
    assert [p.motor_speed for p in rated.plans] == [4, 12] and rated.plans[0].lowest.value >= rated.plans[1].lowest.value
    for speeds in ([], [12, 4], [0], [math.nan], [[1, 2]], np.ma.masked_array([1, 2], mask=[0, 1])):
        with pytest.raises(ukemi.InputError):
            ukemi.ratings(scene, actuator, speeds)


def test_trade(hopper, tmp_path):
    name = "drive.knee.k_p"
    bought = ukemi.trade(hopper, {name: [20, 60, 100]}, evaluations=500)
    same(bought, tmp_path, "trade", ukemi.dataset("scenes/hopper.toml"), "--vary", name + "=20:100:3", "--evaluations",
         500)
    assert [p["at"][name] for p in bought.points] == [20, 60, 100] and bought.middle == 1
    assert all(p["planned"] < p["held"] for p in bought.points) and "knee" in bought.points[0]["motions"]
    for wrong in ({}, {"drive.knee.k_q": [1, 2]}, {name: [2, 1]}, {name: [-1, 1]}):
        with pytest.raises(ukemi.InputError):
            ukemi.trade(hopper, wrong)


def hopper_text():
    """The scene, to be written anywhere."""
    hopper = pathlib.Path(HOPPER)
    return hopper.read_text().replace("../robots", str(hopper.parents[1] / "robots"))


def hopper_with_a_rated_knee(folder, rating):
    path = folder / "scene.toml"
    path.write_text(hopper_text() + f'\n[[load]]\nname = "knee"\nkind = "torque"\njoint = "knee"\nrating = {rating}\n')
    return path


def test_loads_and_designs(tmp_path):
    path = hopper_with_a_rated_knee(tmp_path, 12)
    scene = ukemi.read_robot_scene(path)
    assert scene.loads == {"knee": {"kind": "torque", "of": "knee", "rating": 12, "unit": "Nm", "limit": False}}
    landing = ukemi.simulate(scene, scene.held())
    knee = landing.loads["knee"]
    assert knee["value"] == 12 and knee["ratio"] == 1 and 0 < knee["t"] < 1  # its motor gives no more
    stronger = scene.with_design({"load.knee.rating": 24, "drive.*.tau_max": 24})
    assert stronger.design("load.knee.rating") == 24 and scene.design("load.knee.rating") == 12
    assert ukemi.simulate(stronger, stronger.held()).loads["knee"]["value"] > 12
    with pytest.raises(ukemi.InputError):
        scene.with_design({"drive.knee.k_q": 1})
    front = ukemi.trade(scene, pareto=("peak", "knee"), designs=3, evaluations=800)
    same(front, tmp_path, "trade", path, "--pareto", "peak,knee:3", "--evaluations", 800)
    planned = [p["planned"] for p in front.points]
    assert planned == sorted(planned, reverse=True)
    answer = ukemi.RobotPlanner(scene).plan(height=0.3, deadline=0.3)
    assert answer["loads"]["knee"]["ratio"] == pytest.approx(answer["loads"]["knee"]["value"] / 12)
    for wrong in ({"pareto": ("peak", "peak")}, {"pareto": ("peak", "knee"), "vary": {"drop.height": [0.1, 0.2]}}):
        with pytest.raises(ukemi.InputError):
            ukemi.trade(scene, **wrong)


def test_limits_of_plans_and_risk(tmp_path):
    path = hopper_with_a_rated_knee(tmp_path, 8)
    scene = ukemi.read_robot_scene(path)
    asked = dict(robust="mean", scatter="height=0.02", samples=16, evaluations=1500, forbid=["slider"])
    plan = ukemi.optimize(scene, share=0.9, **asked)
    told = same(plan, tmp_path, "optimize", path, "--robust", "mean", "--scatter", "height=0.02", "--samples", 16,
                "--evaluations", 1500, "--forbid", "slider", "--share", 0.9)
    assert plan.share == told["robust"]["share_kept"] and 0.9 < plan.share <= 1
    assert {name: load["value"] for name, load in plan.loads.items()} == {l["load"]: l["value"] for l in told["loads"]}
    assert plan.loads["slider.touch"] == {**plan.loads["slider.touch"], "limit": True, "value": 0, "ratio": None}
    assert ukemi.optimize(scene, evaluations=200, deadline=0.05).share is None
    # Held so straight that the slider comes down in some of the drops.
    held = ukemi.risk(scene, {}, scatter="height=0.2", samples=256, forbid=["slider", "foot"])
    told = same(held, tmp_path, "risk", path, "--scatter", "height=0.2", "--samples", 256, "--forbid", "slider,foot")
    assert held.touches == {"foot": told["forbidden"]["foot"]["share"], "slider": told["forbidden"]["slider"]["share"]}
    assert held.touches["foot"] == 1 and held.share == told["share_kept"] == 0
    knee = held.loads["knee"]
    assert knee["drops"] == told["ratings"]["load_knee"]["drops"] and knee["share"] == knee["drops"] / 256
    assert 0 < knee["share"] <= 1 and knee["rating"] == 8
    assert ukemi.risk(scene, {}, scatter="height=0.02", samples=64, forbid=["slider"]).share == 1


def test_atlas_of_limits(tmp_path):
    hopper = ukemi.read_robot_scene(ukemi.dataset("scenes/hopper.toml"))
    limits = dict(forbid=["slider"])
    atlas = ukemi.atlas(hopper, height=(0.2, 0.3, 2), evaluations=200, **limits)
    atlas.save(tmp_path / "atlas.bin")
    assert ukemi.RobotAtlasReader(tmp_path / "atlas.bin", hopper, **limits).at(height=0.25)["found"]
    with pytest.raises(ukemi.InputError):
        ukemi.RobotAtlasReader(tmp_path / "atlas.bin", hopper)


def test_atlas_and_its_reader(scene, actuator, tmp_path):
    grid = dict(height=(0.3, 0.5, 2), forward_speed=(0, 1, 2), pitch=(0, math.radians(20), 2))
    atlas = ukemi.atlas(scene, actuator, **grid, evaluations=300)
    same(atlas, tmp_path, "atlas", SCENE, "--actuator", TABLE2, "--height", "0.3:0.5:2", "--speed", "0:1:2",
         "--pitch-deg", "0:20:2", "--evaluations", 300)
    assert (tmp_path / "mine/atlas.bin").read_bytes() == (tmp_path / "its/atlas.bin").read_bytes()
    assert atlas.value.shape == (2, 2, 2) and atlas.axes["pitch"][1] == pytest.approx(math.radians(20))
    assert atlas.motion((1, 0, 1)).value == atlas.value[1, 0, 1]
    atlas.save(tmp_path / "a.bin")
    reader = ukemi.AtlasReader(tmp_path / "a.bin", scene, actuator, objective="peak", deadline=1)
    entry = reader.at(0.3, 0.0, 0.0)
    assert entry.found and entry.inside and entry.value <= atlas.value[0, 0, 0] * 1.001
    assert entry.value == pytest.approx(ukemi.simulate(scene.dropped(0.3, 0, 0), actuator, entry.motion).peak, rel=1e-3)
    assert not reader.at(5).inside
    for wrong in ({"height": math.nan}, {"height": -1}, {"height": 1, "pitch": 18}, {"height": 1, "vertical_speed": math.inf}):
        with pytest.raises(ukemi.InputError):
            reader.at(**wrong)
    with pytest.raises(ukemi.InputError, match="index 0: 2: 0 to 1"):
        atlas.motion((2, 0, 0))
    with pytest.raises(ukemi.InputError):
        ukemi.AtlasReader(SCENE, scene, actuator)
    with pytest.raises(ukemi.InputError):
        ukemi.atlas(scene, actuator, **{**grid, "height": (0.5, 0.3, 2)})


def test_atlas_of_links_and_its_reader(hopper, tmp_path):
    atlas = ukemi.atlas(hopper, height=(0.2, 0.4, 3), evaluations=600)
    same(atlas, tmp_path, "atlas", ukemi.dataset("scenes/hopper.toml"), "--height", "0.2:0.4:3", "--evaluations", 600)
    assert (tmp_path / "mine/atlas.bin").read_bytes() == (tmp_path / "its/atlas.bin").read_bytes()
    assert atlas.value.shape == (3, 1, 1) and set(atlas.motion((1, 0, 0))) == {"hip", "knee"}
    atlas.save(tmp_path / "a.bin")
    reader = ukemi.RobotAtlasReader(tmp_path / "a.bin", hopper, objective="peak", deadline=1)
    entry = reader.at(0.3)
    assert entry["found"] and entry["inside"] and entry["goal"] == "peak"
    played = ukemi.simulate(hopper.dropped(0.3), entry["motions"]).peak
    assert entry["value"] == pytest.approx(played, rel=1e-3) and played <= atlas.value[1, 0, 0] * 1.001
    with pytest.raises(ukemi.InputError):
        ukemi.atlas(hopper, height=(0.2, 0.4, 3), pitch=(0, 0.1, 2))
    with pytest.raises(ukemi.InputError):
        atlas.motion((3, 0, 0))


def test_calibrate(scene, actuator, tmp_path):
    hold = ukemi.dataset("drops/hold.toml")
    logs = [ukemi.dataset(f"drops/drop_{i}.csv") for i in (1, 2)]
    guess = ukemi.dataset("drops/first_guess.toml")
    drops = [ukemi.Drop(ukemi.read_drop(p), ukemi.read_motion(hold)) for p in logs]
    found = ukemi.calibrate(ukemi.read_scene(guess), actuator, drops[:1], validate=drops[1:], free=["stiffness", "pitch"],
                            profile=["stiffness"], errors={"damping_normal": 20})
    same(found, tmp_path, "calibrate", logs[0], "--scene", guess, "--actuator", TABLE2, "--motion", hold, "--validate",
         logs[1], "--free", "stiffness,pitch", "--profile", "stiffness", "--errors", "damping_normal=20")
    assert len(found.drops) == len(found.validation) == 1
    low, high = found.profiles["stiffness"]
    assert low < found.parameters["stiffness"].value < high and found.error_budget["stiffness"]["damping_normal"] > 0


def test_robots_of_links(hopper, tmp_path):
    motions = ukemi.read_motions(MOTIONS, HOPPER)
    assert motions == ukemi.read_motions(MOTIONS, hopper)
    landing = ukemi.simulate(hopper, motions)
    same(landing, tmp_path, "simulate", HOPPER, "--motion", MOTIONS)
    assert set(landing.phi) >= set(motions) and landing.phi["knee"].shape == landing.t.shape
    assert not landing.phi["knee"].flags.writeable and landing.contacts[0].point in hopper.contacts
    best = ukemi.optimize(hopper, evaluations=60)
    same(best, tmp_path, "optimize", HOPPER, "--evaluations", 60)
    assert best.value <= best.held_value and f"{best.goal} {best.value:.6g} m/s^2" in repr(best)
    same(ukemi.risk(hopper, motions, samples=100, forbid=["knee"]), tmp_path, "risk", HOPPER, "--motion", MOTIONS,
         "--samples", 100, "--forbid", "knee")
    with pytest.raises(ukemi.InputError, match="forbid: 'toe'"):
        ukemi.risk(hopper, motions, forbid=["toe"])
    same(ukemi.robot(ukemi.dataset("robots/hopper.toml")), tmp_path, "robot", ukemi.dataset("robots/hopper.toml"))
    ukemi.save_motions(tmp_path / "m.toml", hopper, motions)
    again = ukemi.read_motions(tmp_path / "m.toml", hopper)
    assert again["knee"].phi_f == pytest.approx(motions["knee"].phi_f, rel=1e-12)
    with pytest.raises(ukemi.InputError, match="motions: 'toe'"):
        ukemi.simulate(hopper, {"toe": motions["knee"]})
    for wrong in ({"rate": math.nan}, {"accuracy": 1}):
        with pytest.raises(ukemi.InputError):
            ukemi.simulate(hopper, **wrong)
    for wrong in ({"robust": "worse"}, {"objective": "pek"}, {"samples": 0}, {"scatter": "forward_speed=1"}):
        with pytest.raises(ukemi.InputError):
            ukemi.optimize(hopper, **wrong)
    with pytest.raises(TypeError):
        ukemi.simulate(hopper, [motions["knee"]])


def test_measured_drops_of_links(hopper, tmp_path):
    drops = tmp_path / "drops.csv"
    drops.write_text("height,phi_off_knee_deg\n0.3,0\n0.32,1\n0.29,-1\n")
    played = ukemi.risk(hopper, {}, drops=drops)
    assert played.peaks.samples == 3
    same(played, tmp_path, "risk", HOPPER, "--drops", drops)
    plan = ukemi.optimize(hopper, robust="worst", evaluations=500, drops=drops)
    assert plan.value < 0.8 * plan.held_value
    same(plan, tmp_path, "optimize", HOPPER, "--robust", "worst", "--evaluations", 500, "--drops", drops)
    with pytest.raises(ukemi.InputError, match="scatter: beside drops"):
        ukemi.risk(hopper, {}, drops=drops, scatter="height=0.1")


def test_map_of_links(hopper, tmp_path):
    motions = {n: ukemi.Motion(*m, 0.3) for n, m in (("hip", (0.7, 1.0)), ("knee", (-1.4, -1.0)))}
    ukemi.save_motions(tmp_path / "slice.toml", hopper, motions)
    found = ukemi.map(hopper, {"phi_i_hip": 5, "phi_f_knee": 4}, slice=ukemi.read_motions(tmp_path / "slice.toml", hopper),
                      polish=2, seed=3)
    told = same(found, tmp_path, "map", HOPPER, "--vary", "phi_i_hip:5,phi_f_knee:4", "--slice", tmp_path / "slice.toml",
                "--polish", 2, "--seed", 3)
    assert list(found.axes) == ["phi_i_hip", "phi_f_knee"] and found.peak.shape == (5, 4)
    assert found.minima[0]["peak"] == np.nanmin(found.peak) == told["minima"][0]["peak_acceleration"]
    assert [b["peak"] for b in found.basins] == [b["peak_acceleration"] for b in told["basins"]]
    there = {"hip": ukemi.Motion(found.axes["phi_i_hip"][1], 1.0, 0.3), "knee": ukemi.Motion(-1.4, found.axes["phi_f_knee"][2], 0.3)}
    assert found.peak[1, 2] == pytest.approx(ukemi.simulate(hopper, there).peak, rel=1e-3)
    assert not found.peak.flags.writeable and "<path" in found.figure().svg + ukemi.map(hopper, {"duration": 3}).figure().svg
    for vary, said in (([], "vary: 0 variables: one to three of phi_i_hip"), (["phi_i_toe"], "vary: 'phi_i_toe': one of"),
                       ({"duration": 1}, "vary: 'duration': 1: a whole number of points from 2 to 4096"),
                       (["duration", "duration"], "vary: 'duration': the variable is given twice"),
                       ({"duration": math.nan}, "vary: 'duration': nan")):
        with pytest.raises(ukemi.InputError, match=said) as e:
            ukemi.map(hopper, vary)
        assert "\n" not in str(e.value)
    with pytest.raises(ukemi.InputError, match="slice: phi_i_hip = 3"):
        ukemi.map(hopper, {"duration": 3}, slice={**motions, "hip": ukemi.Motion(3, 1, 0.3)})
    with pytest.raises(ukemi.InputError, match="motions: 'toe'"):
        ukemi.map(hopper, {"duration": 3}, slice={"toe": motions["hip"]})


def test_ratings_of_links(hopper, tmp_path):
    rated = ukemi.ratings(hopper, [4, 12], evaluations=300, seed=2)
    same(rated, tmp_path, "ratings", HOPPER, "--motor-speed", "4:12:2", "--evaluations", 300, "--seed", 2)
    assert [p["at"]["drive.*.speed_max"] for p in rated.points] == [4, 12]
    both = ukemi.ratings(hopper, [4, 12], motor_torques=[6, 12], evaluations=50)
    same(both, tmp_path, "ratings", HOPPER, "--motor-speed", "4:12:2", "--motor-torque", "6:12:2", "--evaluations", 50)
    for speeds, said in (([], "two values or more that rise"), ([12, 4], "two values or more that rise"),
                         ([0, 4], "drive.*.speed_max = 0"), ([math.nan, 4], "drive.*.speed_max = nan")):
        with pytest.raises(ukemi.InputError, match=re.escape(said)):
            ukemi.ratings(hopper, speeds)
    with pytest.raises(ukemi.InputError, match="vary: 'drive.knee.speed_max': respect_ratings is needed"):
        ukemi.trade(hopper, {"drive.knee.speed_max": [4, 8]})
    with pytest.raises(ukemi.InputError, match="respect_ratings: no drive has"):
        ukemi.optimize(hopper, evaluations=50, respect_ratings=True)


def test_compare_of_links(tmp_path):
    softer, fit = tmp_path / "softer.toml", tmp_path / "fit.toml"
    softer.write_text('[actuator]\nname = "softer"\nk_p = 40\nk_d = 1\nk_sea = 120\nc_sea = 1.6\ni_motor = 0.085\n')
    fit.write_text(pathlib.Path(TABLE2).read_text() +
                   '\n[uncertainty]\norder = ["k_p", "k_sea"]\ncovariance = [[4, 0], [0, 9]]\n')
    nominal, identified = (ukemi.read_robot_scene(HOPPER, {"hip": f}) for f in (softer, fit))
    found = ukemi.compare(nominal, identified, evaluations=200, robust="mean", seed=2)
    told = same(found, tmp_path, "compare", "--scene", HOPPER, "--nominal", f"hip={softer}", "--identified", f"hip={fit}",
                "--evaluations", 200, "--robust", "mean", "--seed", 2)
    assert found.complete and {c.name: c.z for c in found.constants} == {k: v["z"] for k, v in told["parameters"].items()}
    assert [m["set"] for m in found.motions] == ["nominal", "identified"]
    for m in found.motions:
        assert m["peaks"] == told["peaks"][m["set"] + "_motion"] and set(m["motions"]) == {"hip", "knee"}
        for name, scene in (("nominal", nominal), ("identified", identified)):
            assert m["peaks"][name] == pytest.approx(ukemi.simulate(scene, m["motions"]).peak, rel=1e-9)
    assert [p["value"] for p in found.plans] == [p["promised"] for p in told["plans"]] and len(found.plans) == 3
    assert found.plans[2]["truth"].mean.value == told["plans"][2]["truth"]["mean"]
    text = hopper_text()
    narrow = tmp_path / "narrow.toml"
    narrow.write_text(text.replace("-150", "-120"))
    assert narrow.read_text() != text
    for other, said in ((ukemi.read_robot_scene(str(narrow), {"hip": fit}), "search of phi_i_knee: only drives"),
                        (identified.dropped(height=1), "drop.height: 0.3 and 1: only drives may differ"),
                        (ukemi.read_robot_scene(ukemi.dataset("scenes/foot.toml")), "two robots")):
        with pytest.raises(ukemi.InputError, match=said):
            ukemi.compare(nominal, other)
    for wrong in ({"evaluations": 0}, {"robust": "worse"}, {"robust": "mean", "scatter": "forward_speed=1"},
                  {"scatter": "height=0.01"}):
        with pytest.raises(ukemi.InputError):
            ukemi.compare(nominal, identified, **wrong)


def test_calibrate_of_links(hopper, tmp_path):
    logs = [ukemi.dataset(f"drops/hopper_{i}.csv") for i in (1, 2)]
    holds = [ukemi.dataset(f"drops/hopper_hold_{i}.toml") for i in (1, 2)]
    drops = [ukemi.RobotDrop(ukemi.read_drop(log, hopper), ukemi.read_motions(hold, hopper), height=height)
             for log, hold, height in zip(logs, holds, (0.3, 0.2))]
    found = ukemi.calibrate(HOPPER, drops[:1], free=["stiffness", "friction"], law="only", validate=drops[1:],
                            profile=["friction"], errors={"damping_normal": 5}, priors={"friction": (0.45, 0.2)})
    same(found, tmp_path, "calibrate", logs[0], "--scene", HOPPER, "--motion-of", f"hopper_1={holds[0]}", "--motion-of",
         f"hopper_2={holds[1]}", "--height-of", "hopper_1=0.3", "--height-of", "hopper_2=0.2", "--validate", logs[1],
         "--free", "stiffness,friction", "--law", "only", "--profile", "friction", "--errors", "damping_normal=5",
         "--prior", "friction=0.45:0.2")
    told, mine = ((tmp_path / f / "scene.toml").read_text().split("\nrobot =")[1] for f in ("its", "mine"))
    assert told.partition("\n")[2] == mine.partition("\n")[2]  # but for the way to the robot's file, the same text
    assert found.converged and len(found.drops) == len(found.validation) == 1 and set(found.profiles) == {"friction"}
    assert found.scene.design("floor.friction") == found.parameters["friction"].value
    assert found.error_budget["stiffness"].keys() >= {"noise", "damping_normal"} and "phi_knee" in found.rms
    of_scene = ukemi.calibrate(hopper, drops[:1], free=["stiffness", "friction"], law="only")
    assert "parameters" in of_scene.write_report(tmp_path / "no_file") and not (tmp_path / "no_file/scene.toml").exists()
    asked = ukemi.calibrate(hopper, drops[:1], free=["stiffness"], law="asked")  # one constant is not enough for these
    laws = [law["law"] for law in asked.laws]
    assert laws[0] == "linear, Coulomb's friction, without pads" and asked.asked in laws[1:] and asked.laws[0]["rejected"]
    assert asked.laws[0]["bic"] == 0 > asked.laws[laws.index(asked.asked)]["bic"]
    pad = "robot.contact.foot.pad.thickness"
    assert hopper.design(pad) == 0 and (asked.scene.design(pad) > 0) == ("with pads" in asked.asked)
    log = drops[0].log
    again = ukemi.RobotDropLog(hopper, log.t, log.outputs, name=log.name)
    assert again == log and not log.outputs["acc"].flags.writeable
    for call, said in (
            (lambda: ukemi.RobotDropLog(hopper, log.t, {"phi_toe": log.t}), "drop: 'phi_toe': acc, ax, ay, x_slider"),
            (lambda: ukemi.RobotDropLog(hopper, log.t[::-1], {"acc": log.t}), "t"),
            (lambda: ukemi.RobotDropLog(hopper, log.t, {"acc": log.t[1:]}), "acc"),
            (lambda: ukemi.read_drop(HOPPER, hopper), "hopper.toml"),
            (lambda: ukemi.RobotDrop(log, height=-1), "height: -1"),
            (lambda: ukemi.calibrate(hopper, []), "drop"),
            (lambda: ukemi.calibrate(hopper, [ukemi.RobotDrop(log, forward_speed=1)]), "forward_speed: a robot on this base"),
            (lambda: ukemi.calibrate(hopper, [ukemi.RobotDrop(log, {"toe": ukemi.hold(-45)})]), "motions: 'toe'"),
            (lambda: ukemi.calibrate(hopper, drops, free=["frictions"]), "frictions"),
            (lambda: ukemi.calibrate(hopper, drops, law="mine"), "law: 'mine'"),
            (lambda: ukemi.calibrate(hopper, drops, accuracy=1), "accuracy: 1"),
            (lambda: ukemi.calibrate(ukemi.read_robot_scene(ukemi.dataset("scenes/foot.toml")), drops), "another robot")):
        with pytest.raises(ukemi.InputError, match=re.escape(said)) as e:
            call()
        assert "\n" not in str(e.value)


def test_a_plan_that_keeps_limits_in_a_share_of_the_drops(hopper, tmp_path):
    best = ukemi.optimize(hopper, evaluations=2000, robust="mean", samples=16, scatter="height=0.02", forbid=["knee"],
                          share=0.9)
    same(best, tmp_path, "optimize", HOPPER, "--evaluations", 2000, "--robust", "mean", "--samples", 16, "--scatter",
         "height=0.02", "--forbid", "knee", "--share", 0.9)
    for wrong, said in (({"share": 0.9}, "share: "), ({"share": 2, "robust": "mean", "forbid": ["knee"]}, "share: 2"),
                        ({"share": 0.9, "robust": "mean"}, "share: the scene has no limit to keep")):
        with pytest.raises(ukemi.InputError, match=said):
            ukemi.optimize(hopper, **wrong)


def test_driven_robots(driven, hopper, tmp_path):
    robot, _, trials = driven
    found = ukemi.identify_robot(
        robot, trials, ["drive.servo.i_motor", "drive.servo.friction"], profile=["drive.servo.friction"])
    low, high = found.profiles["drive.servo.friction"]
    assert low <= found.parameters["drive.servo.friction"].value <= high and len(found.profiles) == 1
    assert found.converged and found.parameters["drive.servo.i_motor"].value == pytest.approx(1e-3, rel=1e-3)
    assert found.robot.number("drive.servo.i_motor") == found.parameters["drive.servo.i_motor"].value
    assert found.rms["phi_servo"] < 1e-5 and found.outputs(0)["phi_servo"].shape == trials[0].t.shape
    assert found.baselines["phi_servo"]["model"] < found.baselines["phi_servo"]["held"]
    assert math.isnan(found.baselines["phi_servo"]["mean"]) and found.contacts(0) == []
    promised = ukemi.predict_robot(found.robot, trials).bands(0)["phi_servo"]
    assert promised.shape == trials[0].t.shape and (promised > 0).all() and found.bands(0) == {}
    each = ukemi.identify_robot(robot, trials, ["drive.servo.friction"], per_run=["drive.servo.friction"])
    assert list(n for n, p in each.parameters.items() if p.free) == ["drive.servo.friction@1"]
    with pytest.raises(ukemi.InputError, match="it is not fitted"):
        ukemi.identify_robot(robot, trials, ["drive.servo.friction"], per_run=["drive.servo.i_motor"])
    for wrong in ({"free": ["drive.toe.k_p"]}, {"free": ["drive.servo.k_p"], "lower": {"drive.toe.k_p": 1}}):
        with pytest.raises(ukemi.InputError):
            ukemi.identify_robot(robot, trials, **wrong)
    with pytest.raises(IndexError):
        found.outputs(1)
    rows = ["t,torque_ff_servo,phi_servo"] + [f"{0.01 * k},{0.2 * math.sin(k / 7)},0" for k in range(100)]
    (tmp_path / "swing.csv").write_text("\n".join(rows) + "\n")
    (tmp_path / "still.csv").write_text("\n".join(["t,phi_ref_servo"] + [f"{0.01 * k},0" for k in range(100)]) + "\n")
    commands = [ukemi.read_robot_trials(tmp_path / f, robot, commands=True)[0] for f in ("still.csv", "swing.csv")]
    next_ = ukemi.design_robot(robot, commands, ["drive.servo.i_motor"], noise={"phi": 1e-3}, count=1)
    assert [c.rank for c in next_.candidates] == [0, 1] and next_.criterion == "worst"
    assert next_.after["drive.servo.i_motor"] < next_.before["drive.servo.i_motor"] == math.inf
    assert next_ == pickle.loads(pickle.dumps(next_)) and next_.value == next_.candidates[1].together
    with pytest.raises(ukemi.InputError, match="--noise"):
        ukemi.design_robot(robot, commands, ["drive.servo.i_motor"])
    for pieces in ("often", -1.0, [2.0, 1.0], "auto"):
        with pytest.raises(ukemi.InputError):
            ukemi.read_robot_trials(trials[0].name, robot, pieces=pieces)
    push = ukemi.predict_robot(robot, trials, controller=lambda t, phi, dphi: [0.2 * math.sin(9 * t) - 0.01 * dphi[0]])
    assert push.rms["phi_servo"] > 10 * found.rms["phi_servo"]
    nothing = ukemi.predict_robot(robot, trials, controller=lambda t, phi, dphi: phi * 0)
    assert nothing.rms == ukemi.predict_robot(robot, trials).rms
    with pytest.raises(ukemi.InputError, match="controller: 2 torques"):
        ukemi.predict_robot(robot, trials, controller=lambda t, phi, dphi: [0, 0])
    with pytest.raises(ZeroDivisionError):
        ukemi.identify_robot(robot, trials, ["drive.servo.friction"], controller=lambda t, phi, dphi: [1 / 0])
    leg = ukemi.read_driven_robot(ukemi.dataset("scenes/hopper.toml"))
    rows = ["t,phi_hip,phi_knee,phi_ref_hip,phi_ref_knee"] + [f"{0.002 * k},0.6,-1.2,0.6,-1.2" for k in range(50)]
    (tmp_path / "leg.csv").write_text("\n".join(rows) + "\n")
    stands = ukemi.predict_robot(leg, ukemi.read_robot_trials(tmp_path / "leg.csv", leg))
    assert any(contact == "foot" and touches for _, contact, touches in stands.contacts(0))


def test_a_report_is_the_program_s(scene, actuator, tmp_path):
    landing = ukemi.simulate(scene, actuator, ukemi.hold(-30))
    summary = landing.write_report(tmp_path / "mine", figures=["svg"])
    subprocess.run([BUILD / "ukemi", "simulate", SCENE, "--actuator", TABLE2, "--hold", "-30", "--figures", "svg", "-o",
                    tmp_path / "its", "--quiet"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    names = sorted(p.name for p in (tmp_path / "mine").iterdir())
    assert names == sorted(p.name for p in (tmp_path / "its").iterdir()) and "acceleration.svg" in names

    class Words(html.parser.HTMLParser):
        def handle_data(self, data):
            self.said = getattr(self, "said", "") + data

    def said(folder):
        words = Words()
        text = (tmp_path / folder / "report.html").read_text()
        words.feed(re.sub(r"(?s)<footer.*|<h2[^>]*>Provenance.*", "", text))
        return words.said

    assert said("mine")[:2000] == said("its")[:2000]
    assert summary["provenance"]["command"].startswith("python3")
    with pytest.raises(ukemi.InputError, match="figures: 'gif'"):
        landing.write_report(tmp_path / "x", figures=["gif"])
    with pytest.raises(ukemi.InputError, match="result: Motion"):
        ukemi.write_report(ukemi.hold(-45), tmp_path / "x")
    with pytest.raises(ukemi.InputError):
        landing.write_report("")


def test_every_verb_is_a_function():
    said = subprocess.run([BUILD / "ukemi", "--help"], capture_output=True, text=True, check=True).stdout
    verbs = re.findall(r"^  ([a-z]+) {2,}", said, re.MULTILINE)
    assert len(verbs) >= 10
    assert {v for v in verbs if not hasattr(ukemi, v)} <= {"bench", "demo", "help"}
