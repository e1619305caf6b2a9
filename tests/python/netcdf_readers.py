"""Reads NetCDF files by every reader and compares them. Arguments: the folder with the files of docs/data.md, in both formats."""

import json
import sys
import warnings
from pathlib import Path

import h5netcdf
import netCDF4
import numpy
import pandas
import scipy.io
import xarray

warnings.simplefilter("error")
folder = Path(sys.argv[1])
BACKENDS = [("netcdf4", "nc"), ("scipy", "nc"), ("netcdf4", "nc4"), ("h5netcdf", "nc4")]


def read(name, engine):
    """A data set as users get it, read twice: durations were once rewritten by the first reading."""
    with xarray.open_dataset(folder / name, engine=engine) as dataset:
        first = dataset.load().copy(deep=True)
    with xarray.open_dataset(folder / name, engine=engine) as dataset:
        assert dataset.load().identical(first), f"{name}: the second reading differs"
    return first


def check(name, dataset):
    """No variable is a date, a duration or bytes; every one is described."""
    assert dataset.attrs["Conventions"] == "CF-1.11"
    assert dataset.attrs["source"].startswith("sim-host ")
    json.loads(dataset.attrs["configuration"])
    for key, variable in dataset.variables.items():
        text = variable.dtype.kind in "OU" and all(type(v) in (str, numpy.str_) for v in variable.values.flat)
        assert variable.dtype.kind in "fi" or text, f"{name}: {key} is {variable.dtype}"
        assert variable.attrs["long_name"], f"{name}: {key}"
        flags = "flag_values" in variable.attrs
        assert (variable.dtype == numpy.int8) == flags, f"{name}: {key}"
        if flags:
            assert len(variable.attrs["flag_meanings"].split()) == len(variable.attrs["flag_values"])
            assert set(numpy.unique(variable)) <= set(variable.attrs["flag_values"]), f"{name}: {key}"
        elif not text:
            assert variable.attrs["units"], f"{name}: {key}"
    for dimension in dataset.sizes:
        assert dimension in dataset.indexes, f"{name}: {dimension} has no coordinate"


def equal(a, b):
    """The same numbers and texts to the bit, whatever type a reader has for texts."""
    assert set(a.variables) == set(b.variables)
    for key in a.variables:
        one, two = a[key].values, b[key].values
        same = numpy.array_equal(one, two) if one.dtype.kind in "OU" else one.tobytes() == two.tobytes()
        assert same and a[key].dims == b[key].dims, key


for name in ["ride", "basin", "plane"]:
    all_ = [read(f"{name}.{end}", engine) for engine, end in BACKENDS]
    for dataset in all_:
        check(name, dataset)
        equal(all_[0], dataset)
sweeps = [read("limits/sweep.nc", engine) for engine in ["netcdf4", "scipy"]]
for dataset in sweeps:
    check("sweep", dataset)
    equal(sweeps[0], dataset)

# Readers below xarray: masks of netCDF4, raw values of scipy, strings of h5netcdf.
times = read("basin.nc", "netcdf4")["time_to_fall"].values
masked = netCDF4.Dataset(folder / "basin.nc")["time_to_fall"][:]
assert masked.mask.sum() == numpy.isnan(times).sum() > 0
with scipy.io.netcdf_file(folder / "basin.nc", mmap=False) as raw:
    assert numpy.array_equal(raw.variables["time_to_fall"][:], times, equal_nan=True)
with h5netcdf.File(folder / "ride.nc4") as file:
    assert file["cause"][0] in ("GyroLost", b"GyroLost")

# The tables and documents have the same bits.
ride, table = read("ride.nc", "scipy"), pandas.read_csv(folder / "ride.csv", comment="#")
for column in table:
    if column in ride:
        assert numpy.array_equal(table[column].values.astype(ride[column].dtype), ride[column].values), column
causes = (table["causes_high"].values.astype(object) * 2**32 + table["causes_low"].values.astype(object)).tolist()
numbers = ride["cause_number"].values.astype(int).tolist()
flags = ride["cause_active"].values
assert causes == [sum(1 << n for n, active in zip(numbers, row) if active) for row in flags.tolist()]
assert causes == table["causes"].astype(object).tolist() and max(causes) > 2**53
basin, document = read("basin.nc", "netcdf4"), json.loads((folder / "basin.json").read_text())
assert basin["height"].values.tolist() == document["height"]["upper"]
nulls = [[numpy.nan if t is None else t for t in row] for row in document["map"]["time_to_fall_s"]]
assert numpy.array_equal(basin["time_to_fall"].values, nulls, equal_nan=True)
sweep, heights = sweeps[0], pandas.read_csv(folder / "limits/heights.csv", comment="#")
assert sweep["sensor_delay"].values.tolist() == [0, 40] and heights["sensor_delay_ms"].unique().tolist() == [0, 40]
for row in heights.itertuples():
    at = dict(torque_limit=row.torque_limit, sensor_delay=row.sensor_delay_ms, speed=row.speed_m_s)
    assert sweep["height"].sel(at).item() == row.height_rad_s, at
print("same")
