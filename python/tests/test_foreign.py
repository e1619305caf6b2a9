"""Values of other kinds and Datasets of other origin: supported, or refused by what is missing."""

import math
import warnings
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
import steer_assist as sa
import xarray as xr

START = {"speed_m_s": 4, "steer_rate_rad_s": 5}
SHORT = {"speeds": [4.0], "tolerance": 0.2, "max_rate": 8, "progress": False}
TABLE = pd.DataFrame({"speed_m_s": [0.0, 7.5], "gain_nm_s_rad": [30.0, 0.0]})


def own(roll_rate_rad_s, speed_m_s):
    return 12.0 * roll_rate_rad_s


@pytest.mark.parametrize(
    "compute",
    [
        lambda law: sa.ride(law=law, **START).roll_rad,
        lambda law: sa.ride({"law": law}, **START).roll_rad,
        lambda law: sa.basin(law=law, **SHORT).height,
        lambda law: sa.basin({"law": law}, **SHORT).height,
        lambda law: sa.plane(law=law, speed=4, rays=4, points=10, tolerance=0.05, progress=False).reach,
        lambda law: sa.eigen(law=law, speeds=[4.0]).real_part,
        lambda law: sa.eigen({"law": law}, speeds=[4.0]).real_part,
        lambda law: sa.sweep(law=law, over={"torque_limit_nm": [5.0]}, **SHORT).height,
        lambda law: sa.sweep({"law": law}, over={"torque_limit_nm": [5.0]}, **SHORT).height,
    ],
)
def test_a_table_is_a_law_everywhere(compute):
    """Must hold: a DataFrame is the law that a dictionary with its columns is, not the law none."""
    frame = compute(TABLE)
    assert frame.equals(compute({name: TABLE[name].tolist() for name in TABLE}))
    assert not frame.equals(compute("none"))


def test_a_function_is_a_law_where_rides_are_continuous():
    assert sa.ride({"law": own}, **START).equals(sa.ride(law=own, **START).assign_attrs())
    assert sa.basin({"law": own}, **SHORT).height.equals(sa.basin(law=own, **SHORT).height)
    for refused in (
        lambda: sa.eigen(law=own, speeds=[4.0]),
        lambda: sa.eigen({"law": own}, speeds=[4.0]),
        lambda: sa.sweep(law=own, over={"torque_limit_nm": [5.0]}, **SHORT),
        lambda: sa.sweep(over={"law": [own]}, **SHORT),
        lambda: sa.sweep(over={"law": [TABLE]}, **SHORT),
        lambda: sa.check(law=own),
    ):
        with pytest.raises(sa.ScenarioError, match="law") as raised:
            refused()
        assert raised.value.key.startswith("law")


def test_the_result_of_a_function_needs_it_again():
    """Situation: a ride with a Python function. Action: use the ride again, with and without the function. Must hold: the missing
    argument is named; with it the ride is the same."""
    ride = sa.ride(law=own, **START)
    for again in (lambda: sa.ride(ride), lambda: sa.basin(ride, **SHORT), lambda: sa.eigen(ride, speeds=[4.0])):
        with pytest.raises(sa.ScenarioError, match="`own`.*law=") as raised:
            again()
        assert raised.value.key == "law"
    assert sa.ride(ride, law=own).roll_rad.equals(ride.roll_rad)
    assert sa.eigen(ride, law="h", speeds=[4.0]).real_part.size > 0


@pytest.mark.parametrize("value", [1j, np.complex128(1.0), np.complex64(1.0), None, np.array([1.0]), np.array([1.0, 2.0]), math.nan, "much", [1.0]])
def test_what_a_function_may_not_return(value):
    """Must hold: refused before the computation, and where it is returned at one ride's rates only, with the inputs."""

    def late(roll_rate_rad_s, speed_m_s):
        tried = abs(roll_rate_rad_s) in (0.003, 0.03, 0.1, 0.3, 0.5, 1.0, 3.0)
        return 0.0 if tried else value

    for law in (lambda roll_rate_rad_s, speed_m_s: value, late):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with pytest.raises(sa.ScenarioError, match=r"rad/s and .* m/s.*one\s+finite number") as raised:
                sa.ride(law=law, **START)
        assert raised.value.key == "law"


def test_a_function_may_return_any_real_number():
    for kind in (float, np.float64, np.float32, np.int64, int, np.array):
        ride = sa.ride(law=lambda roll_rate_rad_s, speed_m_s: kind(2.0), **START)
        assert float(ride.torque_nm.min()) == float(ride.torque_nm.max()) == 2.0


def test_a_series_is_a_bicycle():
    parameters = sa.check(bicycle="rigid_jason")["config"]["bicycle"]["parameters"]
    series = pd.Series(parameters, name="jason")
    assert sa.as_bicycle(series) == sa.as_bicycle({**parameters, "name": "jason"})
    assert sa.ride(bicycle=series, **START).roll_rad.equals(sa.ride(bicycle=parameters, **START).roll_rad)
    assert sa.as_bicycle(pd.DataFrame([parameters]).iloc[0])["parameters"] == parameters
    with pytest.raises(sa.ScenarioError, match="`zH` is missing"):
        sa.as_bicycle(series.drop("zH"))
    with pytest.raises(sa.ScenarioError, match="DataFrame.*Series"):
        sa.as_bicycle(pd.DataFrame([parameters]))


def test_correlated_uncertainties_count_as_independent():
    """Situation: two masses with one common error. Must hold: the nominal values and each one's deviation."""
    uncertainties = pytest.importorskip("uncertainties")
    parameters = sa.check(bicycle="rigid_jason")["config"]["bicycle"]["parameters"]
    common = uncertainties.ufloat(0.0, 0.3)
    shared = {**parameters, "mB": parameters["mB"] + 2.0 * common, "mF": parameters["mF"] + common}
    config = sa.check(bicycle=shared)["config"]["bicycle"]
    assert config["parameters"] == parameters
    assert config["uncertainties"]["mB"] == pytest.approx(0.6) and config["uncertainties"]["mF"] == pytest.approx(0.3)


FOREIGN = xr.Dataset({"height": ("speed", [1.0])})


@pytest.mark.parametrize(
    "use, words",
    [
        (lambda: sa.plot.basin(FOREIGN), "`speed_m_s`.*`capped`"),
        (lambda: sa.plot.plane(FOREIGN), "`steer_rate_rad_s`"),
        (lambda: sa.plot.ride(FOREIGN), "`roll_rad`"),
        (lambda: sa.plot.eigen(FOREIGN), "`real_part`"),
        (lambda: sa.plot.sweep(FOREIGN), "`area`"),
        (lambda: sa.plot.basin({"height": [1.0]}), "dict; expected a Dataset of basin"),
        (lambda: sa.plot.ride(TABLE), "DataFrame; expected a Dataset of ride"),
        (lambda: sa.document(FOREIGN), "`document`"),
        (lambda: sa.document({}), "`document`.*dict"),
        (lambda: sa.islands(FOREIGN), "`document`"),
        (lambda: sa.causes(FOREIGN), "`document`"),
        (lambda: sa.islands(sa.ride(**START)), "`islands`"),
        (lambda: sa.causes(sa.ride(**START)), "`causes`"),
        (lambda: sa.ride(FOREIGN), "`document`"),
        (lambda: sa.ride(sa.eigen(speeds=[4.0])), "without a scenario"),
        (lambda: sa.ride(TABLE), "DataFrame"),
        (lambda: sa.replay(TABLE), "recording: a DataFrame"),
        (lambda: sa.replay(FOREIGN), "recording: a Dataset"),
        (lambda: sa.identify(TABLE), "record: a DataFrame"),
        (lambda: sa.as_bicycle(FOREIGN), "Dataset is no bicycle"),
        (lambda: sa.as_bicycle(SimpleNamespace(parameters=[1.0])), "SimpleNamespace is no bicycle"),
        (lambda: sa.as_bicycle(SimpleNamespace(parameters={"w": 1.0})), "`c` is missing"),
        (lambda: sa.sweep(over=[1, 2]), "over: a list"),
    ],
)
def test_what_is_missing_is_named(use, words):
    with pytest.raises(sa.ScenarioError, match=words) as raised:
        use()
    assert raised.value.key


def test_a_figure_of_a_sweep_has_one_or_two_axes():
    """Situation: sweeps with a single cell and with three axes. Must hold: refused by their axes, until one is selected."""
    single = sa.sweep(over={"law": ["h"]}, **{**SHORT, "speeds": [3, 4]})
    with pytest.raises(sa.ScenarioError, match="single cell") as raised:
        sa.plot.sweep(single)
    assert raised.value.key == "measure"
    over = {"law": ["h", "f"], "torque_limit_nm": [2, 5], "sensor_delay_s": [0.0, 0.02]}
    three = sa.sweep(over=over, **{**SHORT, "speeds": [3, 4]})
    with pytest.raises(sa.ScenarioError, match=r"law \(2\), torque_limit \(2\), sensor_delay \(2\)"):
        sa.plot.sweep(three)
    assert sa.plot.sweep(three.isel(law=0)) is not None
    assert sa.plot.sweep(three.isel(law=0, sensor_delay=0)).get_xlabel() == "largest torque of the assist [N m]"


def test_a_warning_is_at_the_callers_line():
    """Must hold: each warning names this file, whichever function gave it."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        sa.ride(speed_m_s=4, roll_rate_rad_s=20)
        sa.scenario(fall={"roll_rad": 80})
        parameters = sa.check()["config"]["bicycle"]["parameters"]
        doubtful = {**parameters, "IBxx": 40.0}
        sa.eigen(bicycle=doubtful, speeds=[4.0])
        sa.sweep(over={"law": ["h"]}, bicycle=doubtful, **SHORT)
    kinds = [one.category for one in caught]
    assert kinds.count(sa.UnitsWarning) == 2 and kinds.count(sa.ScenarioWarning) >= 2
    assert {one.filename for one in caught} == {__file__}
