"""Eigenvalues, against BicycleParameters."""

from pathlib import Path

import numpy as np
import pytest
import steer_assist as sa


def sorted_roots(values):
    return np.sort_complex(np.round(values, 12))


def test_eigenvalues_are_those_of_bicycleparameters():
    """Situation: the benchmark bicycle as BicycleParameters has it. Must hold: its eigenvalues at speeds around the critical
    ones are ours."""
    sets = pytest.importorskip("bicycleparameters.parameter_sets", reason="BicycleParameters is not installed")
    models = pytest.importorskip("bicycleparameters.models")
    parameters = sa.check(bicycle="benchmark")["config"]["bicycle"]["parameters"]
    theirs = sets.Meijaard2007ParameterSet({**parameters, "v": 1.0}, True)
    speeds = np.array([0.5, 2.0, 4.3, 5.0, 6.0, 9.0])
    ours = sa.eigen(bicycle=theirs, speeds=speeds)
    model = models.Meijaard2007Model(theirs)
    for i, speed in enumerate(speeds):
        expected = model.calc_eigen(v=speed)[0].ravel()
        found = (ours.real_part[i] + 1j * ours.imag_part[i]).values
        np.testing.assert_allclose(sorted_roots(found), sorted_roots(expected), rtol=1e-9, atol=1e-9)
    assert 4.29 < ours.v_w < 4.30 and 6.02 < ours.v_c < 6.03


def test_uncertain_parameters_of_bicycleparameters():
    """Situation: parameters with uncertainties, as a Bicycle object of BicycleParameters keeps them."""
    uncertainties = pytest.importorskip("uncertainties")
    parameters = sa.check(bicycle="rigid_jason")["config"]["bicycle"]["parameters"]

    class Bicycle:
        bicycleName = "Rigid"

        def __init__(self):
            self.parameters = {"Benchmark": {key: uncertainties.ufloat(value, 0.01 * abs(value)) for key, value in parameters.items()}}

    config = sa.check(bicycle=Bicycle())["config"]["bicycle"]
    assert config["name"] == "Rigid" and config["parameters"] == parameters
    assert config["uncertainties"]["mB"] == pytest.approx(0.01 * parameters["mB"])


@pytest.mark.parametrize("name, beside", [("Silver", "IFzz"), ("Browser", None)])
def test_bicycles_of_bicycleparameters(name, beside):
    """Situation: bicycles as BicycleParameters loads those that it ships, one with parameters beside the 26. Must hold: its
    26 values and their deviations; a value beside them that contradicts them warns; a deviation that is no number is refused."""
    package = pytest.importorskip("bicycleparameters")
    theirs = package.Bicycle(name, pathToData=str(Path(package.__file__).parent / "app-data"))
    benchmark = theirs.parameters["Benchmark"]
    assert beside is None or beside in benchmark
    config = sa.check(bicycle=theirs)["config"]["bicycle"]
    assert config["name"] == name
    assert config["parameters"] == {key: benchmark[key].nominal_value for key in sa.bicycle_keys()}
    if name == "Browser":
        assert config["uncertainties"]["mB"] == pytest.approx(benchmark["mB"].std_dev) and benchmark["mB"].std_dev > 0
    else:
        benchmark["IFzz"] = benchmark["IFzz"] * 2
        with pytest.warns(sa.ScenarioWarning, match="IFzz = .* is not IFxx"):
            sa.eigen(bicycle=theirs, speeds=[4.0])
    benchmark["mB"] = pytest.importorskip("uncertainties").ufloat(12.1, float("nan"))
    with pytest.raises(sa.ScenarioError, match="mB.*deviation") as raised:
        sa.check(bicycle=theirs)
    assert raised.value.key == "bicycle.mB"


def test_the_law_and_the_modes(sim_host):
    ours = sa.eigen(law="h")
    there = sim_host("eigen", "--law", "h")
    assert sa.document(ours)["eigenvalues"] == there["eigenvalues"]
    assert {"real_part", "imag_part", "mode_real", "mode_imag"} <= set(ours) and ours.real_part.units == "s-1"
    assert "weave" in ours.mode
    assert bool((ours.real_part.diff("root") <= 1e-12).all())


def test_a_rider_has_the_requested_number_of_roots():
    ours = sa.eigen(rider="young", speeds=[3.0, 4.0], roots=6)
    assert 6 <= ours.sizes["root"] <= 7
    with pytest.raises(sa.ScenarioError, match="backward|forward"):
        sa.eigen(law="h", speeds=[-1.0])
    with pytest.raises(sa.ScenarioError) as raised:
        sa.eigen(roots=3)
    assert raised.value.range == (4.0, 40.0)
