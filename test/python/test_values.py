"""Every class is a value: ==, hash, copies, pickles. A new class without them fails here."""
import copy
import inspect
import math
import pathlib
import pickle

import numpy as np
import pytest

import ukemi

NO_VALUES = {"InputError", "Planner", "RobotPlanner", "Player", "AtlasReader", "RobotAtlasReader", "Feedback"}  # they are asked, or are an enumeration
CLASSES = {n: c for n, c in vars(ukemi).items() if inspect.isclass(c)}


@pytest.fixture(scope="module")
def examples(scene, actuator, hopper, driven):
    """One of each class."""
    rig = ukemi.read_rig(ukemi.dataset("rigs/paper.toml"))
    trials = [ukemi.read_trial(ukemi.dataset(f"impact/trial_{i}.csv")) for i in (1, 2)]
    fit = ukemi.identify(trials, rig)
    landing, best = ukemi.simulate(scene, actuator, ukemi.hold(-45)), ukemi.optimize(scene, actuator, evaluations=300)
    log = ukemi.read_drop(ukemi.dataset("drops/drop_1.csv"))
    drop = ukemi.Drop(log, ukemi.read_motion(ukemi.dataset("drops/hold.toml")))
    calibration = ukemi.calibrate(scene, actuator, [drop], free=["stiffness"])
    risk = ukemi.risk(scene, actuator, ukemi.hold(-45), samples=100)
    survey = ukemi.map(scene, actuator, grid=[4, 3, 3], polish=1)
    ratings = ukemi.ratings(scene, actuator, [8], evaluations=300)
    comparison = ukemi.compare(actuator, fit.actuator, scene=scene, robust="mean")
    design = ukemi.design(rig, fit.actuator, trials, hits=1, check=0)
    next_trials = ukemi.design_robot(driven[0], driven[1], ["drive.servo.friction"], noise={"phi": 1e-3})
    fall = ukemi.RobotDrop(ukemi.read_drop(ukemi.dataset("drops/hopper_1.csv"), hopper))
    leg = ukemi.calibrate(hopper, [fall], free=["stiffness"], law="only")
    legs = ukemi.compare(hopper.with_design({"drive.hip.k_p": 40}), hopper, evaluations=20)
    atlas = ukemi.atlas(scene, actuator, (0.3, 0.4, 2), (0, 1, 2), (0, 0.1, 2), evaluations=100)
    return {type(x).__name__: x for x in (
        scene, actuator, hopper, rig, rig.errors, trials[0], fit, fit.trials[0], fit.parameters["k_sea"], landing,
        landing.contacts[0], landing.figure(), best, best.motion, ukemi.motion_deg(-30, -80, 0.2, [3]), log, drop,
        calibration, calibration.drops[0], risk, risk.peaks, risk.peaks.mean, survey, survey.basins[0], ratings,
        ratings.plans[0], comparison, comparison.constants[0], comparison.motions[0], comparison.plans[0], design,
        design.hits[0], atlas, ukemi.Planner(scene, actuator).plan(0.4), ukemi.simulate(hopper),
        ukemi.optimize(hopper, evaluations=20), ukemi.risk(hopper, {}, samples=20), entry_of(atlas, scene, actuator),
        ukemi.atlas(hopper, height=(0.2, 0.3, 2), evaluations=100),
        ukemi.trade(hopper, {"drop.height": [0.2, 0.3]}, evaluations=20), driven[0], driven[1][0],
        ukemi.map(hopper, {"duration": 3}, polish=1), fall.log, fall, leg, legs,
        ukemi.predict_robot(driven[0], driven[1]), next_trials, next_trials.candidates[0])}


def entry_of(atlas, scene, actuator):
    path = pathlib.Path(ukemi.__file__).parent / "test_values_atlas.bin"
    atlas.save(path)
    entry = ukemi.AtlasReader(path, scene, actuator).at(0.35)
    path.unlink()
    return entry


def seen(x):
    """What an object shows, to hold against that of its copy."""
    out = {}
    for name, member in inspect.getmembers(type(x), lambda m: isinstance(m, property)):
        value = getattr(x, name)
        if isinstance(value, (float, int, str, bool, type(None), tuple, list, dict, np.ndarray)):
            out[name] = repr(value) if not isinstance(value, np.ndarray) else value.tobytes()
    return {k: v for k, v in out.items() if " object at 0x" not in str(v)}


@pytest.mark.parametrize("name", sorted(set(CLASSES) - NO_VALUES))
def test_a_value(examples, name):
    assert name in examples, f"no example of {name}: add one, or name it in NO_VALUES"
    x = examples[name]
    for again in (copy.copy(x), copy.deepcopy(x), pickle.loads(pickle.dumps(x))):
        assert type(again) is type(x) and again is not x
        assert again == x and not again != x and hash(again) == hash(x)
        assert seen(again) == seen(x) and repr(again) == repr(x) or " object at 0x" in repr(x)
    assert x != 3 and x != "x" and x is not None
    assert pickle.dumps(copy.copy(x)) == pickle.dumps(x)


def test_what_differs_is_not_equal(scene, actuator, hopper):
    assert ukemi.hold(-45) != ukemi.hold(-44) and ukemi.hold(-45) == ukemi.motion_deg(-45, -45, 1)
    assert ukemi.Motion(-0.0, -1, 0.2) == ukemi.Motion(0.0, -1, 0.2)
    assert scene != scene.dropped(height=scene.height + 1e-12) and scene == scene.dropped(height=scene.height)
    assert hopper != hopper.dropped(height=1) and scene != hopper
    t = np.arange(0, 0.1, 1e-3)
    a, b = (ukemi.DropLog(t, acc=np.where(t > 0.05, math.nan, k)) for k in (1, 2))
    assert a == ukemi.DropLog(t, acc=np.where(t > 0.05, math.nan, 1)) and a != b
    best = ukemi.optimize(scene, actuator, evaluations=50)
    plain = ukemi.Motion(best.motion.phi_i, best.motion.phi_f, best.motion.duration)
    assert plain == best.motion and best.motion == plain
    assert len({ukemi.hold(-45), ukemi.hold(-45), ukemi.hold(-30)}) == 2


def test_how_long_it_took_is_not_compared(scene, actuator, hopper):
    for make in (lambda: ukemi.optimize(scene, actuator, evaluations=100), lambda: ukemi.optimize(hopper, evaluations=50),
                 lambda: ukemi.map(scene, actuator, grid=[3, 3, 2], polish=1),
                 lambda: ukemi.compare(hopper, hopper, evaluations=20)):
        one, other = make(), make()
        assert one == other and hash(one) == hash(other)
    one, other = (ukemi.optimize(hopper, evaluations=50, seed=seed) for seed in (1, 2))
    assert one != other
    assert pickle.loads(pickle.dumps(one)).seconds == one.seconds  # it is kept


def test_a_pickle_of_something_else_is_an_input_error(scene):
    version, state = scene.__getstate__()
    empty = ukemi.Scene.__new__(ukemi.Scene)
    for wrong in ((version, state[:-9]), (version, state + b"x"), ("0", state), (version, b""), (version,)):
        with pytest.raises(ukemi.InputError, match="pickle"):
            empty.__setstate__(wrong)


def test_a_report_of_a_result_that_was_pickled(examples, tmp_path):
    from told import numbers
    for name in ("Landing", "Optimum", "Identification", "RobotOptimum", "Risk", "Calibration", "Design", "Comparison",
                 "RobotMap", "RobotCalibration", "RobotComparison"):
        again = pickle.loads(pickle.dumps(examples[name]))
        assert numbers(again.write_report(tmp_path / f"{name}2")) == numbers(examples[name].write_report(tmp_path / name))


def test_no_class_has_degrees_and_radians():
    for name, c in CLASSES.items():
        words = [(n, m.__doc__ or "") for n, m in vars(c).items() if isinstance(m, property) or callable(m)]
        text = " ".join(f"{n} {d}" for n, d in words)
        degrees = "_deg" in text
        assert not (degrees and any(unit in text for unit in ("[rad]", "[rad/s]"))), name


def test_what_was_minimised_is_said(scene, actuator):
    best = ukemi.optimize(scene, actuator, evaluations=300, objective="tolerant")
    assert f"tolerant peak {best.value:.6g} m/s^2" in repr(best) and f"tolerant peak {best.value:.6g}" in repr(best.motion)
    assert isinstance(best.motion, ukemi.Motion) and (best.goal, best.value) == (best.motion.goal, best.motion.value)
    plan = ukemi.Planner(scene, actuator, objective="peak").plan(0.4)
    assert f"; peak {plan.value:.6g} m/s^2" in repr(plan) and plan.motion.goal == "peak"
    none = ukemi.optimize(scene, actuator, evaluations=50, forbid=["hip", "knee", "foot"])
    assert not none.found and "nothing was found" in repr(none.motion) and none.message in repr(none)
    again = ukemi.simulate(scene.dropped(0.4, 0, 0, 0), actuator, plan.motion)
    assert again.peak == pytest.approx(plan.value, rel=1e-3)


def test_files_are_named_by_paths(scene, actuator, tmp_path):
    for x, read in ((scene, ukemi.read_scene), (actuator, ukemi.read_actuator), (ukemi.hold(-45), ukemi.read_motion)):
        x.save(tmp_path / "a.toml")
        assert read(tmp_path / "a.toml").toml() == read(str(tmp_path / "a.toml")).toml() == x.toml()
    for read in (ukemi.read_scene, ukemi.read_actuator, ukemi.read_motion, ukemi.read_rig, ukemi.read_trial,
                 ukemi.read_drop, ukemi.robot, ukemi.read_robot_scene):
        with pytest.raises(ukemi.InputError, match="nowhere"):
            read(pathlib.Path("nowhere"))
        with pytest.raises(TypeError):
            read(3)
        with pytest.raises(ukemi.InputError, match="a name of a file is needed"):
            read("a\0b")
    odd = tmp_path / "\udcff.toml"  # no UTF-8, and a name all the same
    scene.save(odd)
    assert ukemi.read_scene(odd) == ukemi.read_scene(str(odd)) == ukemi.read_scene(bytes(odd))
