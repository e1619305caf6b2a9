"""Bad input: named by key, value and range, and nothing runs."""

import pickle
import warnings

import numpy as np
import pandas
import pytest
import steer_assist as sa

START = {"speed_m_s": 4, "steer_rate_rad_s": 5}


@pytest.mark.parametrize(
    "changes, key, words",
    [
        ({"colour": "red"}, "colour", "unknown field `colour`"),
        ({"plant": {"sensor": []}}, "plant.sensor", "unknown field"),
        ({"time_limit_s": "long"}, "time_limit_s", "string"),
        ({"law": "hh"}, "law", "hh"),
        ({"bicycle": "tricycle"}, "bicycle", "tricycle"),
        ({"rider": "nobody"}, "rider", "nobody"),
        ({"torque_limit_nm": float("nan")}, "torque_limit_nm", "not a finite number"),
        ({"start": {"speed_m_s": np.inf}}, "start.speed_m_s", "not a finite number"),
        ({"taper_m_s": np.ones((2, 2))}, "taper_m_s", r"shape \(2, 2\)"),
        ({"taper_m_s": [1.0, 2.0, 3.0]}, "taper_m_s", "length"),
        ({"bicycle": object()}, "bicycle", "no bicycle"),
        ({"imu": {1, 2}}, "imu", "set is no value"),
    ],
)
def test_the_key_is_named(changes, key, words):
    with pytest.raises(sa.ScenarioError, match=words) as raised:
        sa.ride(**{**START, **changes} if "start" not in changes else changes)
    assert raised.value.key is not None and raised.value.key.startswith(key)


@pytest.mark.parametrize(
    "changes, key, least, most",
    [
        ({"speed_m_s": 31}, "start.speed_m_s", -30, 30),
        ({"torque_limit_nm": -1}, "torque_limit_nm", 0, None),
        ({"time_limit_s": 0}, None, None, 3600),
    ],
)
def test_the_range_is_named(changes, key, least, most):
    with pytest.raises(sa.ScenarioError) as raised:
        sa.ride(**{**START, **changes})
    error = raised.value
    assert isinstance(error, ValueError) and error.range is not None
    assert key is None or error.key == key
    assert least is None or error.range[0] == pytest.approx(least, abs=1)
    assert most is None or error.range[1] == most


def test_a_search_out_of_range():
    with pytest.raises(sa.ScenarioError, match="tolerance") as raised:
        sa.basin(tolerance=1e-12)
    assert raised.value.key == "search" and raised.value.range[0] == 1e-9


def test_a_start_is_needed():
    with pytest.raises(sa.ScenarioError, match="must be given") as raised:
        sa.ride()
    assert raised.value.key == "start.speed_m_s"
    with pytest.raises(sa.ScenarioError) as raised:
        sa.plane()
    assert raised.value.key == "plane.speed"


def test_a_parameter_of_a_bicycle():
    parameters = sa.check()["config"]["bicycle"]["parameters"]
    with pytest.raises(sa.ScenarioError, match="mB") as raised:
        sa.ride(bicycle={**parameters, "mB": -3.0}, **START)
    assert raised.value.key == "bicycle.parameters.mB" and raised.value.range[0] > 0
    with pytest.raises(sa.ScenarioError, match="`mX` is no parameter") as raised:
        sa.ride(bicycle={**parameters, "mX": 1.0}, **START)
    assert raised.value.key == "bicycle.mX"
    parameters.pop("zH")
    with pytest.raises(sa.ScenarioError, match="`zH` is missing"):
        sa.ride(bicycle=parameters, **START)


def test_degrees_are_doubted():
    """Situation: 20 degrees/s and 18 degrees given for radians. Must hold: a warning names the key; radians give none."""
    with pytest.warns(sa.UnitsWarning, match="roll_rate_rad_s = 20.*degrees"):
        sa.scenario(start={"speed_m_s": 4, "roll_rate_rad_s": 20})
    with pytest.warns(sa.UnitsWarning, match="fall.roll_rad = 80"):
        sa.scenario(fall={"roll_rad": 80})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sa.scenario(start={"speed_m_s": 4, "roll_rate_rad_s": 2}, fall={"roll_rad": 1.4})


def test_a_missing_file(tmp_path):
    with pytest.raises(sa.ScenarioError, match="nothing.toml"):
        sa.ride(tmp_path / "nothing.toml")
    wrong = tmp_path / "wrong.toml"
    wrong.write_text("[search]\nscan = 1\n")
    with pytest.raises(sa.ScenarioError, match="wrong.toml") as raised:
        sa.basin(wrong)
    assert raised.value.key == "search.scan"


def test_an_error_passes_between_processes():
    error = pickle.loads(pickle.dumps(sa.ScenarioError("wrong", "a.b", (0.0, 1.0))))
    assert (str(error), error.key, error.range) == ("wrong", "a.b", (0.0, 1.0))


@pytest.mark.parametrize("threads", [0, -1, 1025, 2.0, True])
def test_threads_out_of_range(threads):
    for search in (lambda: sa.basin(threads=threads), lambda: sa.plane(speed=4, threads=threads), lambda: sa.sweep(over={"law": ["h"]}, threads=threads)):
        with pytest.raises(sa.ScenarioError, match="threads") as raised:
            search()
        assert raised.value.key == "threads" and raised.value.range == (1.0, 1024.0)


def test_speeds_of_eigenvalues_out_of_range():
    """Situation: km/h for m/s, and none. Must hold: refused with the key, not computed."""
    for speeds in ([36.0], [-31.0], [1e9], []):
        with pytest.raises(sa.ScenarioError, match="speeds") as raised:
            sa.eigen(speeds=speeds)
        assert raised.value.key == "speeds"


def test_a_duration_of_pandas_is_no_number():
    with pytest.raises(sa.ScenarioError, match="Timedelta") as raised:
        sa.ride(time_limit_s=pandas.Timedelta("3s"), **START)
    assert raised.value.key == "time_limit_s"


def test_doubts_are_warnings():
    """Situation: a frame whose inertias no rigid body has. Action: every computation. Must hold: each warns, the given one not."""
    parameters = sa.check()["config"]["bicycle"]["parameters"]
    doubtful = {**parameters, "IBxx": 40.0}
    for compute in (
        lambda: sa.ride(bicycle=doubtful, **START),
        lambda: sa.basin(bicycle=doubtful, speeds=[4.0], max_rate=0.5),
        lambda: sa.plane(bicycle=doubtful, speed=4, rays=4, method="fast"),
        lambda: sa.eigen(bicycle=doubtful, speeds=[4.0]),
        lambda: sa.sweep(over={"law": ["h"]}, bicycle=doubtful, speeds=[4.0], max_rate=0.5),
    ):
        with pytest.warns(sa.ScenarioWarning, match="IB"):
            compute()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sa.ride(bicycle=parameters, **START)
