"""The package itself: stubs, figures, notebooks."""

import ast
import inspect
import os
import subprocess
import sys
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path

import matplotlib.pyplot as plt
import pytest
import steer_assist as sa
from steer_assist import _core


def stubs():
    tree = ast.parse((files("steer_assist") / "_core.pyi").read_text())
    return {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}


def test_every_stub_exists_and_every_function_has_one():
    names = {name for name in dir(_core) if not name.startswith("_")}
    assert names == set(stubs())
    for name, stub in stubs().items():
        parameters = inspect.signature(getattr(_core, name)).parameters
        assert list(parameters) == [argument.arg for argument in stub.args.args], name
        assert getattr(_core, name).__doc__, name


def test_the_package_is_typed_and_described():
    assert (files("steer_assist") / "py.typed").is_file()
    for name in sa.__all__:
        assert (getattr(sa, name).__doc__ or "").strip(), name


def test_the_version_is_the_installed_ones():
    assert sa.__version__ == version("steer_assist") and sa.__version__[0].isdigit()


def test_the_types_are_clean(repository):
    """Must hold: mypy --strict has no remark on the package and its stubs."""
    pytest.importorskip("mypy", reason="mypy is not installed")
    package = repository / "python/steer_assist"
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file", str(repository / "python/pyproject.toml")]
    done = subprocess.run([*command, "--cache-dir", os.devnull, str(package)], capture_output=True, text=True, cwd=package.parent)
    assert done.returncode == 0, done.stdout + done.stderr


def test_shipped_names():
    assert "rigid_jason" in sa.bicycles() and len(sa.bicycles()) > 20
    assert "young" in sa.riders() and len(sa.bicycle_keys()) == 26


def test_figures_take_an_axis():
    """Must hold: each function draws on the given axis, names its axes, and returns it."""
    basin = sa.basin(speeds=[3, 4, 5], tolerance=0.2, max_rate=8, progress=False)
    results = {
        sa.plot.basin: basin,
        sa.plot.plane: sa.plane(speed=4, rays=4, points=10, tolerance=0.01, progress=False),
        sa.plot.ride: sa.ride(speed_m_s=4, steer_rate_rad_s=5),
        sa.plot.eigen: sa.eigen(),
        sa.plot.sweep: sa.sweep(over={"law": ["h", "f"]}, speeds=[3, 4], tolerance=0.2, progress=False),
    }
    for draw, result in results.items():
        figure, ax = plt.subplots()
        assert draw(result, ax=ax) is ax
        assert ax.get_xlabel() and (ax.lines or ax.collections)
        plt.close(figure)


NOTEBOOKS = sorted((Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, tmp_path):
    """Must hold: the notebook is stored without outputs, and every cell runs."""
    nbformat = pytest.importorskip("nbformat", reason="nbformat is not installed")
    nbclient = pytest.importorskip("nbclient", reason="nbclient is not installed")
    pytest.importorskip("ipykernel", reason="ipykernel is not installed")
    notebook = nbformat.read(path, as_version=4)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert code and all(not cell.outputs and cell.execution_count is None for cell in code)
    resources = {"metadata": {"path": str(path.parent)}}
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3", resources=resources).execute()
