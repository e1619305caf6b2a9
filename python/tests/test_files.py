"""Results as NetCDF files: every kind through every backend, and equal to the files of the command line."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
import steer_assist as sa
import xarray as xr

BACKENDS = ["scipy", "netcdf4", "h5netcdf"]


@pytest.fixture(scope="module")
def results(repository):
    """A result of every kind, with causes, draws and an axis of words."""
    short = {"tolerance": 0.2, "max_rate": 8, "progress": False}
    record = repository / "python/notebooks/perturbed_young_5mps.csv"
    recording = repository / "data/recordings/g2_steer_encoder_spikes_2mps.csv"
    return {
        "ride": sa.ride(preset="product", speed_m_s=4, steer_rate_rad_s=1, plant={"faults": ["gyro:missing@300ms"]}),
        "basin": sa.basin(speeds=[3, 4], rider="young", rider_draws=2, **short),
        "plane": sa.plane(speed=4, rays=4, points=10, tolerance=0.01, progress=False),
        "eigen": sa.eigen(law="h", speeds=[3.0, 4.0]),
        "sweep": sa.sweep(over={"torque_limit_nm": [1, None], "sensor_delay_s": [0.0, 0.02]}, speeds=[3, 4], **short),
        "replay": sa.replay(recording, map="extract"),
        "identify": sa.identify(record, reduce=False, progress=False).dataset(),
    }


KINDS = ["ride", "basin", "plane", "eigen", "sweep", "replay", "identify"]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("kind", KINDS)
def test_a_result_survives_a_file(results, kind, backend, tmp_path):
    """Action: write a result with this backend, and read it with it. Must hold: the same values, coordinates, attributes of the
    variables and document; a scenario in it can be used again."""
    result = results[kind]
    result.to_netcdf(tmp_path / "result.nc", engine=backend)
    with xr.open_dataset(tmp_path / "result.nc", engine=backend) as again:
        xr.testing.assert_equal(again.load(), result)
        assert sa.document(again) == sa.document(result)
        for name, variable in result.variables.items():
            read = {key: value for key, value in again[name].attrs.items()}
            assert read.keys() == variable.attrs.keys(), name
            assert all(np.array_equal(read[key], value) for key, value in variable.attrs.items()), name
        if kind in ("ride", "basin", "plane"):
            assert sa.scenario(again) == sa.scenario(result)


def test_every_number_has_a_unit_and_a_name(results):
    """Must hold: a name for every variable; a unit for every one of numbers; a meaning for every flag."""
    for kind, result in results.items():
        for name, variable in result.variables.items():
            assert variable.attrs.get("long_name"), (kind, name)
            words = variable.dtype.kind in "UO"
            assert words or {"units", "flag_meanings"} & set(variable.attrs), (kind, name)


#: Names in the files of the command line that do not only lack the unit of a result's.
NAMES = {"time_s": "t", "drawn_quantile": "height_quantile"}


def in_file(name, file):
    """The variable of a file with the name of a variable of a result."""
    ends = ("_nm_s", "_rad_s", "_m_s", "_nm", "_rad", "_s")
    short = next((name.removesuffix(end) for end in ends if name.endswith(end)), name)
    found = next((one for one in (NAMES.get(name), name, short) if one in file.variables), None)
    return None if found is None else file[found]


def words_of(variable):
    """Values of flags as their words."""
    meanings = np.array(variable.flag_meanings.split())
    return meanings[variable.values]


def compared(result, file):
    """Compares every variable of a result with that of a file, if it has one; returns their names."""
    names = set()
    for name in result.variables:
        there, here = in_file(name, file), result[name]
        if there is None:
            continue
        names.add(name)
        if "flag_meanings" in there.attrs and here.dtype.kind == "U":
            ours = np.where(here.values == "", "none", here.values)
            np.testing.assert_array_equal(ours, words_of(there))
            continue
        np.testing.assert_array_equal(here.values, there.values, err_msg=name)
        if "flag_meanings" in here.attrs:
            assert here.flag_meanings == there.flag_meanings and here.dtype == there.dtype == np.int8
            np.testing.assert_array_equal(here.flag_values, there.flag_values)
        elif here.dtype.kind == "f" and "units" in there.attrs:
            assert here.units == there.units, name
    return names


def test_a_ride_is_the_command_lines_file(results, sim_host, tmp_path):
    words = "ride --preset product --speed 4 --steer-rate 1 --fault gyro:missing@300ms --netcdf"
    sim_host(*words.split(), str(tmp_path / "ride.nc"))
    with xr.open_dataset(tmp_path / "ride.nc", engine="scipy") as file:
        names = compared(results["ride"], file.load())
    assert names >= {"time_s", "roll_rad", "torque_nm", "mode", "limit", "limit_active", "cause", "cause_number", "cause_active"}
    ride = results["ride"]
    active = ride.cause[ride.cause_active.any("time_s")].values
    assert "GyroLost" in active and 1 < len(active) < ride.sizes["cause"]


def test_a_basin_is_the_command_lines_file(results, sim_host, tmp_path):
    words = "basin --speeds 3:4:1 --rider young --rider-draws 2 --tolerance 0.2 --max-rate 8 --netcdf"
    sim_host(*words.split(), str(tmp_path / "basin.nc"))
    with xr.open_dataset(tmp_path / "basin.nc", engine="scipy") as file:
        names = compared(results["basin"], file.load())
    assert names >= {"speed_m_s", "rate", "height", "capped", "outcome", "time_to_fall_s", "fall", "drawn_height", "drawn_quantile"}


def test_a_sweep_is_the_command_lines_file(results, sim_host, tmp_path):
    words = "sweep --over torque-limit=1,none --over sensor-delay=0.0s,0.02s --speeds 3:4:1 --tolerance 0.2 --max-rate 8 -q --out"
    sim_host(*words.split(), str(tmp_path / "out"))
    with xr.open_dataset(tmp_path / "out/sweep.nc", engine="scipy") as file:
        names = compared(results["sweep"], file.load())
        for axis in ("torque_limit", "sensor_delay"):
            assert file[axis].long_name == results["sweep"][axis].long_name
    assert names >= {"torque_limit", "sensor_delay", "speed_m_s", "height", "capped", "area", "mean_height", "area_capped"}


def test_the_extra_for_netcdf_has_what_the_first_example_writes_with():
    """The engine of the page's first example is not required: the page's first install line has its extra."""
    root = Path(__file__).parents[2]
    page = (root / "docs/python.md").read_text()
    project = tomllib.loads((root / "python/pyproject.toml").read_text())["project"]
    example = page.split("## In ten lines")[1].split("```")[1]
    engine = re.search(r'engine="(\w+)"', example)
    assert engine is not None
    extra = " ".join(project["optional-dependencies"]["netcdf"])
    assert engine[1] in extra and "h5py" in extra
    assert page.split("## Install")[1].split("pip install ")[1].startswith("'./python[netcdf]'")
