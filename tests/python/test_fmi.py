"""The FMUs in FMPy: sim-host writes them, FMPy validates, couples, saves and restores them.

The environment variable SIM_HOST names the program. Run with pytest; `cargo test -p tests --test fmi` does it in a virtual
environment of its own.
"""

import csv
import functools
import json
import os
import stat
import subprocess
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE, fmi2CallbackAllocateMemoryTYPE, fmi2CallbackFreeMemoryTYPE
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

from fmi_container import FEW, container

PARTS = ["controller", "bicycle", "rider"]
STEP = 0.001


def sim_host(*arguments, cwd):
    """Runs the program, which must succeed."""
    done = subprocess.run([os.environ["SIM_HOST"], *arguments], cwd=cwd, capture_output=True, text=True)
    assert done.returncode == 0, f"{arguments}: {done.stderr}"
    return done.stdout


@pytest.fixture(scope="session")
def export(tmp_path_factory):
    """A function that exports and unpacks an FMU, once for the same arguments."""

    @functools.cache
    def exported(part, version, *options):
        folder = tmp_path_factory.mktemp(f"{part}-{version}")
        rider = ("--rider", "smart", "--law", "h") if part == "rider" and "--rider" not in options else ()
        sim_host("fmu", "export", part, "--fmi", version, "--out", "part.fmu", *rider, *options, cwd=folder)
        fmpy.extract(folder / "part.fmu", folder / "unpacked")
        return folder

    return exported


@pytest.fixture(scope="session")
def ride(tmp_path_factory):
    """A function that rides with the command line: its document, and its table as a dict of columns."""

    @functools.cache
    def ridden(*options):
        folder = tmp_path_factory.mktemp("ride")
        document = json.loads(sim_host("ride", *options, "--json", "-", "--csv", "ride.csv", cwd=folder))
        with open(folder / "ride.csv", newline="") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        return document, {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}

    return ridden


class Part:
    """An instance of an FMU, initialised; variables by name, log lines in `log`."""

    def __init__(self, folder, version, parameters=None, initialise=True):
        self.description = fmpy.read_model_description(folder / "unpacked")
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.log = []
        known = dict(
            guid=self.description.guid if version == "2" else self.description.instantiationToken,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            unzipDirectory=str(folder / "unpacked"),
            instanceName="part",
        )
        self.version = version
        if version == "2":
            self.fmu = FMU2Slave(**known)
            callbacks = fmi2CallbackFunctions()
            callbacks.logger = fmi2CallbackLoggerTYPE(lambda env, name, status, category, text: self.log.append(text.decode()))
            callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(lambda count, size: None)
            callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(lambda place: None)
            self.callbacks = callbacks
            self.fmu.instantiate(callbacks=callbacks, loggingOn=True)
            self.real, self.set_real = self.fmu.getReal, self.fmu.setReal
            self.save, self.restore = self.fmu.getFMUstate, self.fmu.setFMUstate
            self.free, self.serialized = self.fmu.freeFMUstate, self.fmu.serializeFMUstate
            self.deserialized = self.fmu.deSerializeFMUstate
        else:
            self.fmu = FMU3Slave(**known)
            self.fmu.instantiate(loggingOn=True, logMessage=lambda env, status, category, text: self.log.append(text.decode()))
            self.real, self.set_real = self.fmu.getFloat64, self.fmu.setFloat64
            self.save, self.restore = self.fmu.getFMUState, self.fmu.setFMUState
            self.free, self.serialized = self.fmu.freeFMUState, self.fmu.serializeFMUState
            self.deserialized = self.fmu.deserializeFMUState
        if initialise:
            self.start(parameters or {})

    def start(self, parameters):
        self.set_parameters(parameters)
        if self.version == "2":
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def set_parameters(self, parameters):
        for name, value in parameters.items():
            variable = self.variables[name]
            if variable.type in ("Real", "Float64"):
                self.set_real([variable.valueReference], [value])
            elif variable.type in ("Integer", "Int32") or (variable.type == "Enumeration" and self.version == "2"):
                (self.fmu.setInteger if self.version == "2" else self.fmu.setInt32)([variable.valueReference], [value])
            elif variable.type == "Enumeration":
                self.fmu.setInt64([variable.valueReference], [value])
            else:
                self.fmu.setBoolean([variable.valueReference], [value])

    def references(self, names):
        return [self.variables[name].valueReference for name in names]

    def get(self, *names):
        return self.real(self.references(names))

    def integers(self, *names):
        return (self.fmu.getInteger if self.version == "2" else self.fmu.getInt32)(self.references(names))

    def booleans(self, *names):
        return self.fmu.getBoolean(self.references(names))

    def step(self, k, step=STEP):
        self.fmu.doStep(currentCommunicationPoint=k * STEP, communicationStepSize=step)

    def close(self):
        self.fmu.terminate()
        self.fmu.freeInstance()


def shared(source, target):
    """Names of the numbers that `source` gives and `target` takes: equal names are connected."""
    outputs = [v.name for v in source.description.modelVariables if v.causality == "output" and v.type in ("Real", "Float64")]
    inputs = {v.name for v in target.description.modelVariables if v.causality == "input"}
    return [name for name in outputs if name in inputs]


class Coupled:
    """Controller, bicycle and rider, connected by their variables' names.

    In the order of a ride the controller is advanced first, with the bicycle's values of the instant, and the bicycle has its
    new torque; the rider and the bicycle are advanced with each other's values of the instant. Otherwise all are.
    """

    def __init__(self, bicycle, controller=None, rider=None, ordered=True):
        self.bicycle, self.controller, self.rider, self.ordered = bicycle, controller, rider, ordered
        pairs = [(a, b) for a in (bicycle, controller, rider) for b in (bicycle, controller, rider) if a and b and a is not b]
        self.links = {(a, b): (a.references(shared(a, b)), b.references(shared(a, b))) for a, b in pairs}

    def pass_on(self, source, target):
        if source and target and self.links[source, target][0]:
            outputs, inputs = self.links[source, target]
            target.set_real(inputs, source.real(outputs))

    def step(self, k):
        bicycle, controller, rider = self.bicycle, self.controller, self.rider
        self.pass_on(bicycle, controller)
        self.pass_on(rider, controller)
        if not self.ordered:
            self.pass_on(controller, bicycle)
        if controller:
            controller.step(k)
        if self.ordered:
            self.pass_on(controller, bicycle)
        self.pass_on(rider, bicycle)
        self.pass_on(bicycle, rider)
        if rider:
            rider.step(k)
        bicycle.step(k)

    def run(self, first, last, names):
        """Rides the periods `first` to `last`; the bicycle's values at their beginnings and the assist's torque."""
        rows = []
        for k in range(first, last):
            before = self.bicycle.get(*names)
            self.step(k)
            rows.append(before + (self.controller.get("assist_torque_nm") if self.controller else []))
        return np.array(rows)


# Columns of the command line's table, and the bicycle's variables.
COLUMNS = {
    "roll": "roll_rad",
    "steer": "steer_rad",
    "pitch": "pitch_rad",
    "roll_rate": "roll_rate_rad_s",
    "steer_rate": "steer_rate_rad_s",
    "yaw_rate": "yaw_rate_rad_s",
    "rear_wheel_rate": "rear_wheel_rate_rad_s",
    "front_speed": "front_wheel_m_s",
    "rear_speed": "rear_wheel_m_s",
}

HARD = ("--speed", "4", "--steer-rate", "5")


@pytest.mark.parametrize("version", ["2", "3"])
@pytest.mark.parametrize("part", PARTS)
def test_validates_without_remark(export, part, version):
    """Situation: an exported FMU. Action: FMPy validates it. Must hold: no remark, and start values that the instance has."""
    folder = export(part, version)
    assert validate_fmu(str(folder / "part.fmu")) == []
    instance = Part(folder, version)
    numbers = [v for v in instance.variables.values() if v.type in ("Real", "Float64") and v.start is not None]
    assert len(numbers) >= 3
    assert instance.get(*(v.name for v in numbers)) == [float(v.start) for v in numbers]
    assert instance.log == []
    instance.close()


@pytest.mark.parametrize("version", ["2", "3"])
@pytest.mark.parametrize("options", [(), ("--preset", "product"), ("--law", "cl2:4", "--imu", "body", "--schedule-speed", "rear"), ("--actuator", "viscous=0.5,stop=0.3")])
def test_ordered_coupling_has_the_bits_of_a_ride(export, ride, version, options):
    """Situation: controller and bicycle, the controller first. Action: ride 6 s. Must hold: every bit of `sim-host ride`."""
    document, table = ride(*HARD, *options)
    assert document["outcome"] != "fallen"
    bicycle = Part(export("bicycle", version, *HARD, *options), version)
    controller = Part(export("controller", version, *HARD, *options), version)
    rows = Coupled(bicycle, controller).run(0, len(table["t"]), COLUMNS.values())
    for i, name in enumerate([*COLUMNS, "torque"]):
        assert np.array_equal(rows[:, i], table[name]), name
    assert np.abs(table["torque"]).max() > 1.0
    assert controller.integers("causes_low", "causes_high", "limits") == [
        np.int32(np.uint32(table[name][-1])).item() for name in ("causes_low", "causes_high", "limits")
    ]
    bicycle.close()
    controller.close()


def test_a_fall_is_that_of_the_ride(export, ride):
    """Situation: a ride that falls through fast motion. Action: couple it. Must hold: fallen at the same instant, then still."""
    hopeless = ("--speed", "2", "--steer-rate", "12")
    document, table = ride(*hopeless)
    bicycle, controller = Part(export("bicycle", "3", *hopeless), "3"), Part(export("controller", "3", *hopeless), "3")
    coupled = Coupled(bicycle, controller)
    coupled.run(0, len(table["t"]) + 5, ["roll_rad"])
    assert bicycle.booleans("fallen") == [True]
    assert bicycle.get("time_to_fall_s") == [document["time_to_fall_s"]]
    still = bicycle.get(*COLUMNS.values())
    coupled.step(len(table["t"]) + 5)
    assert bicycle.get(*COLUMNS.values()) == still
    assert any("fallen after" in line for line in bicycle.log)


def test_unordered_coupling_is_a_delay_of_one_period(export, ride):
    """Situation: all FMUs advanced at once, as most tools do. Action: ride. Must hold: the bits of a ride whose sensors are one
    period late."""
    _, table = ride(*HARD, "--sensor-delay", "1ms")
    bicycle, controller = Part(export("bicycle", "3", *HARD), "3"), Part(export("controller", "3", *HARD), "3")
    rows = Coupled(bicycle, controller, ordered=False).run(0, len(table["t"]), COLUMNS.values())
    for i, name in enumerate(COLUMNS):
        assert np.array_equal(rows[:, i], table[name]), name


@pytest.mark.parametrize("signals", [None, FEW])
def test_the_compiled_master_of_fmpy_is_unordered(export, ride, tmp_path, signals):
    """Situation: controller and bicycle in FMPy's container, which steps both at 1 kHz; all signals, or those that the law
    reads. Action: ride 6 s with an output every 10 ms. Must hold: every tenth row of a ride whose sensors are one period late."""
    _, table = ride(*HARD, "--sensor-delay", "1ms")
    files = [str(export(part, "3", *HARD) / "part.fmu") for part in ("bicycle", "controller")]
    for part, file in zip(("bicycle", "controller"), files):
        (tmp_path / f"{part}.fmu").write_bytes(Path(file).read_bytes())
    file = container(tmp_path, tmp_path / "bicycle.fmu", tmp_path / "controller.fmu", ["roll_rad", "steer_rad"], signals)
    result = fmpy.simulate_fmu(str(file), stop_time=6.0, output_interval=0.01)
    for name in ("roll", "steer"):
        assert np.array_equal(result[f"{name}_rad"][:600], table[name][::10]), name


@pytest.mark.parametrize("law", ["none", "h"])
def test_a_rider_couples_to_a_small_error(export, ride, law):
    """Situation: a rider beside the bicycle, with and without the assist. Action: ride 6 s. Must hold: the ride of the command
    line up to the error of a torque that changes evenly over each period."""
    options = ("--rider", "smart", "--law", law, "--speed", "4", "--steer-rate", "1")
    document, table = ride(*options)
    assert document["outcome"] != "fallen"
    bicycle, rider = Part(export("bicycle", "3", *options), "3"), Part(export("rider", "3", *options), "3")
    controller = Part(export("controller", "3", *options), "3") if law != "none" else None
    rows = Coupled(bicycle, controller, rider).run(0, len(table["t"]), COLUMNS.values())
    error = max(np.abs(rows[:, i] - table[name]).max() / np.abs(table[name]).max() for i, name in enumerate(COLUMNS) if i in (0, 1))
    print(f"coupling error with law {law}: {error:.2e} of the largest angle")
    assert 1e-9 < error < 1e-4


@pytest.mark.parametrize("version", ["2", "3"])
@pytest.mark.parametrize("through_bytes", [False, True])
def test_saved_states_give_the_same_rest(export, version, through_bytes):
    """Situation: a ride of all three at 0.7 s. Action: save, ride on, restore, in other instances if `through_bytes`, ride on.
    Must hold: the same bits again."""
    options = ("--rider", "smart", "--law", "h", "--preset", "product", "--speed", "4", "--steer-rate", "1")
    make = lambda: [Part(export(part, version, *options), version) for part in ("bicycle", "controller", "rider")]
    parts = make()
    couple = lambda parts: Coupled(*parts)
    couple(parts).run(0, 700, ["roll_rad"])
    states = [part.save() for part in parts]
    rest = couple(parts).run(700, 1500, COLUMNS.values())
    assert np.ptp(rest[:, 0]) > 1e-4
    again = make() if through_bytes else parts
    for part, other, state in zip(parts, again, states):
        other.restore(other.deserialized(part.serialized(state)) if through_bytes else state)
    assert np.array_equal(couple(again).run(700, 1500, COLUMNS.values()), rest)
    for part, state in zip(parts, states):
        data = bytearray(part.serialized(state))
        data[len(data) // 2] ^= 1
        with pytest.raises(Exception):
            part.deserialized(bytes(data))
        assert "checksum" in part.log[-1]
        part.free(state)


def test_instances_do_not_disturb_each_other(export):
    """Situation: two rides from different disturbances. Action: one after the other, then period by period in turn. Must hold:
    the same bits; and the same after a reset."""
    starts = [{"start_steer_rate_rad_s": 1.0}, {"start_steer_rate_rad_s": -4.0, "start_speed_m_s": 5.0}]
    make = lambda start: (Part(export("bicycle", "3", *HARD), "3", start), Part(export("controller", "3", *HARD), "3", {k: v for k, v in start.items() if k == "start_speed_m_s"}))
    alone = []
    for start in starts:
        bicycle, controller = make(start)
        alone.append(Coupled(bicycle, controller).run(0, 500, COLUMNS.values()))
    assert not np.array_equal(*alone)
    pairs = [Coupled(bicycle, controller) for bicycle, controller in map(make, starts)]
    in_turn = [[], []]
    for k in range(500):
        for pair, rows in zip(pairs, in_turn):
            rows.append(pair.run(k, k + 1, COLUMNS.values())[0])
    assert all(np.array_equal(rows, one) for rows, one in zip(in_turn, alone))
    for part, start in ((pairs[0].bicycle, starts[0]), (pairs[0].controller, {})):
        part.fmu.reset()
        part.start(start)
    assert np.array_equal(pairs[0].run(0, 500, COLUMNS.values()), alone[0])


@pytest.mark.parametrize("version", ["2", "3"])
def test_wrong_calls_are_refused_by_name(export, version):
    """Situation: a controller and a bicycle. Action: calls with wrong values. Must hold: an error whose line in the log names
    variable, value and range; the instance goes on."""
    controller = Part(export("controller", version), version, initialise=False)
    bicycle = Part(export("bicycle", version), version)

    def refused(part, act, *words):
        count = len(part.log)
        with pytest.raises(Exception):
            act()
        assert len(part.log) == count + 1, part.log[count:]
        for word in words:
            assert word in part.log[-1], part.log[-1]

    torque = "limits.max_torque_nm"
    refused(controller, lambda: controller.set_parameters({torque: 500.0}), torque, "500", "is outside", "N m")
    refused(controller, lambda: controller.set_parameters({"law": 99}), "law = 99", "cl2")
    refused(controller, lambda: controller.set_parameters({"rate_hz": 100.0}), "rate_hz can't be set")
    refused(controller, lambda: controller.step(0), "not initialised")
    controller.set_parameters({"limits.window_on" if "limits.window_on" in controller.variables else f"{torque}_on": True})
    controller.start({torque: 5.0, f"{torque}_on": True})
    refused(controller, lambda: controller.set_parameters({torque: 6.0}), torque, "fixed")
    refused(bicycle, lambda: bicycle.set_parameters({"assist_torque_nm": float("nan")}), "assist_torque_nm = NaN")
    refused(bicycle, lambda: bicycle.set_parameters({"roll_rad": 0.1}), "roll_rad can't be set")
    for step in (0.0015, 0.0004, float("nan"), -0.001, 0.0):
        refused(bicycle, lambda: bicycle.step(0, step), "communication step", "0.001 s", "output_interval=0.001")
    refused(bicycle, lambda: bicycle.step(5), "communication point 0.005 s", "time, 0 s")
    bicycle.step(0, 0.008)
    assert "held over all of them" in bicycle.log[-1]
    bicycle.step(8)
    assert bicycle.get("time") == [0.009]


@pytest.mark.parametrize("version", ["2", "3"])
def test_initialisation_has_the_outputs_of_the_start(export, version):
    """Situation: a bicycle that is being initialised. Action: read its outputs, change its start. Must hold: the outputs of the
    instant after the initialisation with these parameters, not zeros."""
    names = ["front_wheel_m_s", "steer_rate_rad_s", "roll_acceleration_rad_s2", "accel_z_m_s2"]
    bicycle = Part(export("bicycle", version, *HARD), version, initialise=False)
    if version == "2":
        bicycle.fmu.setupExperiment(startTime=0.0)
    bicycle.fmu.enterInitializationMode()
    first = bicycle.get(*names)
    assert first[1] == 5.0 and first[0] == pytest.approx(4.0) and first[3] == pytest.approx(-9.81, abs=0.5) and abs(first[2]) > 0.1
    bicycle.set_parameters({"start_steer_rate_rad_s": 1.0})
    before = bicycle.get(*names)
    assert before[1] == 1.0
    bicycle.fmu.exitInitializationMode()
    assert bicycle.get(*names) == before


@pytest.mark.parametrize("version", ["2", "3"])
def test_states_of_other_fmus_are_refused(export, version):
    """Situation: a controller's state, and a fall within a long step. Must hold: the bicycle refuses the state and goes on; the
    long step is reported as well as the fall."""
    bicycle, controller = Part(export("bicycle", version, *HARD), version), Part(export("controller", version), version)
    state = controller.save()
    for act in (lambda: bicycle.restore(state), lambda: bicycle.serialized(state)):
        with pytest.raises(Exception):
            act()
        assert "another FMU" in bicycle.log[-1]
    controller.free(state)
    bicycle.step(0, 3.0)
    assert any("held over all of them" in line for line in bicycle.log)
    assert any("fallen" in line for line in bicycle.log)


def test_parameters_act_as_the_options_of_the_command_line(export, ride):
    """Situation: a controller exported without options. Action: set a law and a torque limit as FMI parameters. Must hold: the
    ride of the command line with these options."""
    _, table = ride(*HARD, "--law", "cl2:3", "--torque-limit", "4")
    laws = [item.name for item in Part(export("controller", "3", *HARD), "3").variables["law"].declaredType.items]
    controller = Part(
        export("controller", "3", *HARD),
        "3",
        {"law": laws.index("cl2"), "law_slope": 3.0, "limits.max_torque_nm": 4.0, "limits.max_torque_nm_on": True},
    )
    bicycle = Part(export("bicycle", "3", *HARD), "3")
    rows = Coupled(bicycle, controller).run(0, len(table["t"]), COLUMNS.values())
    assert np.array_equal(rows[:, -1], table["torque"]) and np.abs(table["torque"]).max() == 4.0


def test_a_lateral_force_and_a_roll_torque_push_to_their_side(export):
    """Situation: an upright bicycle. Action: push at the saddle for 0.1 s; or a roll torque. Must hold: it rolls to that side,
    at first as force times height over the roll inertia, between half and twice that."""
    for name, amount, moment in (("lateral_force_n", 20.0, 20.0 * 0.943), ("roll_torque_nm", -15.0, -15.0)):
        bicycle = Part(export("bicycle", "3", "--speed", "4"), "3")
        bicycle.set_parameters({name: amount})
        for k in range(100):
            bicycle.step(k)
        rate = bicycle.get("roll_rate_rad_s")[0]
        inertia = 94.0  # about the line of the contacts: about 94 kg of bicycle and rider, 1 m up
        assert 0.3 < rate / (moment * 0.1 / inertia) < 3.0, (name, rate)


def test_a_read_only_copy_works_and_a_mixed_one_is_refused(export, tmp_path):
    """Situation: an FMU unpacked read-only, and one with another's resources. Action: instantiate. Must hold: the first
    steps, the second is refused with both tokens."""
    folder = export("bicycle", "3", "--speed", "4")
    for path in [folder / "unpacked", *(folder / "unpacked").rglob("*")]:
        path.chmod(stat.S_IREAD | stat.S_IEXEC)
    bicycle = Part(folder, "3")
    bicycle.step(0)
    bicycle.close()
    fmpy.extract(folder / "part.fmu", tmp_path / "unpacked")
    other = export("bicycle", "3", "--speed", "5") / "unpacked/resources/model.json"
    (tmp_path / "unpacked/resources/model.json").write_bytes(other.read_bytes())
    with pytest.raises(Exception, match="instantiate"):
        Part(tmp_path, "3")


@pytest.mark.parametrize("version", ["2", "3"])
def test_fmpy_simulates_one_alone(export, version):
    """Situation: FMPy's own master. Action: `simulate_fmu` of the bicycle with its step. Must hold: 1 s in 1,000 steps."""
    result = fmpy.simulate_fmu(
        str(export("bicycle", version, *HARD) / "part.fmu"), stop_time=1.0, output_interval=STEP, output=["roll_rad", "fallen"]
    )
    assert len(result) == 1001 and result["time"][-1] == pytest.approx(1.0)
    assert 0.01 < abs(result["roll_rad"][-1]) < 2.0
