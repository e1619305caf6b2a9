//! Serialized states of the controller: of constant size, the same rest of the ride, damaged ones.

use fmi::{Instance, MODEL_FILE, Model, Role, Setup, Table, token};
use proptest::prelude::*;
use sim_host::commands;
use sim_host::fmu::{Part, model};
use sim_host::scenario::Scenario;
use tempfile::TempDir;
use tests::draws::runner;

/// The flashed controller, with its variables.
fn product() -> (Setup, Table) {
    let scenario = Scenario::from_toml("preset = 'product'").unwrap();
    let setup = model(Part::Controller, &commands::Setup::new(&scenario).unwrap()).unwrap();
    let table = setup.table().unwrap();
    (setup, table)
}

/// Values of the inputs in period `k`: weaving a little at 4 m/s, fresh samples, the gyro lost once, the switch opened now and then.
fn inputs(table: &Table, k: u32) -> Vec<f64> {
    let t_s = f64::from(k) * 1e-3;
    let weave = |phase: f64| libm::sin(5.0 * t_s + phase);
    let variables = &table.variables()[table.of(Role::Input)];
    let value = |name: &str, start: f64| match name {
        "gyro_x_rad_s" => 0.01 * weave(0.0),
        "gyro_z_rad_s" => 0.02 * weave(1.0),
        "accel_y_m_s2" => 0.02 * weave(2.0),
        "steer_rad" => 0.005 * weave(1.0),
        "steer_rate_rad_s" => 0.025 * libm::cos(5.0 * t_s + 1.0),
        "gyro_age_ticks" if k > 50_000 && k < 50_100 => 65535.0,
        "engage" => f64::from(u8::from(k % 20_000 < 18_000)),
        _ => start,
    };
    variables.iter().map(|variable| value(&variable.name, variable.start)).collect()
}

/// Situation: the flashed controller in a ride of a minute in which the gyro is lost once and the switch opened now and then.
/// Action: serialize its state after 10 ms, and every 5 s; load the last ones into other instances, and ride on.
/// Must hold: the size of a state is that of the first within a tenth, some kilobytes; every output of the other instances is that of
/// the first, bit for bit, in which the modes changed; a state that was cut is refused.
#[test]
fn states_of_the_controller_do_not_grow() {
    let (setup, table) = product();
    let resources = TempDir::new().unwrap();
    let variables = table.fingerprint();
    let file = serde_json::to_vec(&serde_json::json!({ "model": &setup, "variables": variables })).unwrap();
    std::fs::write(resources.path().join(MODEL_FILE), &file).unwrap();
    let instance = || Instance::new(&token(&file), resources.path()).unwrap();
    let step = |instance: &mut Instance, k: u32| -> Vec<u64> {
        for (place, value) in table.of(Role::Input).zip(inputs(&table, k)) {
            instance.set(place as u32, |_| true, value).unwrap();
        }
        instance.step(f64::from(k) * 1e-3, 1e-3).unwrap();
        let outputs = table.of(Role::Output);
        outputs.map(|place| instance.get(place as u32, |_| true).unwrap().to_bits()).collect()
    };
    let mut first = instance();
    first.enter().unwrap();
    first.exit().unwrap();
    let (mut states, mut rows) = (Vec::new(), Vec::new());
    for k in 0..61_000 {
        if k == 10 || k % 5000 == 4999 {
            states.push((k, first.serialize(&first.save()).unwrap()));
        }
        rows.push(step(&mut first, k));
    }
    let small = states[0].1.len();
    assert!((2_000..12_000).contains(&small), "{small} bytes");
    for (k, state) in &states {
        assert!(state.len().abs_diff(small) < small / 10, "{k}: {} bytes, {small} at first", state.len());
    }
    for (from, state) in states.iter().rev().take(5) {
        let mut other = instance();
        let loaded = other.deserialize(state).unwrap();
        other.restore(&loaded).unwrap();
        for k in *from..(from + 6000).min(61_000) {
            assert!(step(&mut other, k) == rows[k as usize], "{from}: {k}");
        }
        assert!(other.deserialize(&state[..state.len() - 9]).is_err());
    }
    let mode =
        table.variables().iter().position(|v| v.name == "mode").unwrap() - table.of(Role::Output).start;
    let modes: std::collections::BTreeSet<u64> = rows.iter().map(|row| row[mode]).collect();
    assert!(modes.len() >= 5, "{modes:?}");
}

/// Situation: a state of the flashed controller with any of its bytes changed, or cut.
/// Action: load it, past the checksum, and ride on for 50 ms.
/// Must hold: refused, or the torque stays finite and within the limit of 7 N m.
#[test]
fn any_bytes_are_refused_or_harmless() {
    let (setup, table) = product();
    let parameters: Vec<f64> =
        table.variables()[table.of(Role::Parameter)].iter().map(|variable| variable.start).collect();
    let mut whole = Model::new(&setup).unwrap();
    whole.begin(&parameters).unwrap();
    (0..500).for_each(|k| drop(whole.step(&inputs(&table, k))));
    let bytes = whole.bytes();
    let count = table.of(Role::Output).len();
    let changes = proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6);
    let length = prop_oneof![3 => Just(bytes.len()), 1 => 0..=bytes.len()];
    runner(2000)
        .run(&(changes, length), |(changes, length)| {
            let mut changed = bytes.clone();
            changes.iter().for_each(|(place, byte)| changed[place.index(bytes.len())] = *byte);
            let mut model = Model::new(&setup).unwrap();
            model.begin(&parameters).unwrap();
            if model.load(&changed[..length]).is_err() {
                return Ok(());
            }
            for k in 500..550 {
                model.step(&inputs(&table, k));
                let mut outputs = vec![f64::NAN; count];
                model.outputs(&mut outputs);
                prop_assert!(outputs[0].abs() <= 7.0, "{}", outputs[0]);
            }
            Ok(())
        })
        .unwrap();
}
