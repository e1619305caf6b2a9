//! Writes a file of sensor models.

use crate::plant::Sensor;
use crate::plant::sensor_file::{SensorFile, SensorNumbers, table_of};
use std::fmt::Write;

/// The file as TOML: the numbers used by the simulator, then the measured ones, one per line.
pub fn to_toml(file: &SensorFile) -> String {
    let quoted = |text: &str| toml::Value::from(text).to_string();
    let mut text = String::from(
        "# A model of real sensors, fitted to recordings; docs/sensors.md. SI units. `measured` has what it was made of,\n\
         # with 95 % intervals and how many seconds of recording each comes from.\n\n",
    );
    for (key, value) in [("source", &file.source), ("licence", &file.licence), ("command", &file.command)] {
        let _ = writeln!(text, "{key} = {}", quoted(value));
    }
    // Both wheels share one table.
    for (sensor, numbers) in file.tables().filter(|(sensor, _)| *sensor != Sensor::FrontWheel) {
        let _ = writeln!(text, "\n[{}]", table_of(sensor));
        table(&mut text, numbers);
    }
    text
}

fn table(text: &mut String, numbers: &SensorNumbers) {
    let list = |values: &[f64]| format!("{values:?}");
    let mut key = |key: &str, value: Option<String>| {
        let _ = value.map(|value| writeln!(text, "{key} = {value}"));
    };
    let one = |value: Option<f64>| value.map(|x| format!("{x:?}"));
    let some = |values: &[f64]| (!values.is_empty()).then(|| list(values));
    key("period_s", one(numbers.period_s));
    key("phase_s", one(numbers.phase_s));
    key("jitter_s", numbers.jitter_s.map(|jitter| list(&jitter)));
    key("delay_s", one(numbers.delay_s));
    key("window_s", one(numbers.window_s));
    key("pulses_per_turn", numbers.pulses_per_turn.map(|n| n.to_string()));
    key("quantum", some(&numbers.quantum));
    key("repeat", one(numbers.repeat));
    key("white_density", some(&numbers.white_density));
    key("walk", some(&numbers.walk));
    key("bias_spread", some(&numbers.bias_spread));
    key("vibration", (!numbers.vibration.is_empty()).then(|| format!("{:?}", numbers.vibration)));
    let quoted = |text: &str| toml::Value::from(text).to_string();
    if !numbers.measured.is_empty() {
        text.push_str("measured = [\n");
        for m in &numbers.measured {
            let axis =
                if m.axis.is_empty() { String::new() } else { format!("axis = {}, ", quoted(&m.axis)) };
            let (number, unit) = (quoted(&m.number), quoted(&m.unit));
            let (value, low, high, seconds) = (m.value, m.low, m.high, m.seconds);
            let _ = writeln!(
                text,
                "    {{ number = {number}, {axis}unit = {unit}, value = {value:?}, low = {low:?}, high = {high:?}, \
                 seconds = {seconds:?} }},"
            );
        }
        text.push_str("]\n");
    }
    if !numbers.left_out.is_empty() {
        text.push_str("left_out = [\n");
        for what in &numbers.left_out {
            let _ = writeln!(text, "    {},", quoted(what));
        }
        text.push_str("]\n");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::sensor_file::MeasuredNumber;

    #[test]
    fn what_is_written_is_read_again() {
        let measured = MeasuredNumber {
            number: "white noise \"riding\"".into(),
            axis: "x".into(),
            unit: "rad/s".into(),
            value: 1.5e-7,
            low: -1.0,
            high: 2.0,
            seconds: 3.5,
        };
        let gyro = SensorNumbers {
            period_s: Some(0.005),
            jitter_s: Some([1e-6, 2e-3]),
            repeat: Some(0.25),
            white_density: vec![1e-4, 2.0, 3.0],
            vibration: vec![[1.0, 2.0, 3.0, 4.0]; 3],
            measured: vec![measured.clone(), MeasuredNumber { axis: String::new(), ..measured }],
            left_out: vec!["phase: none".into()],
            ..SensorNumbers::default()
        };
        let wheel = SensorNumbers { pulses_per_turn: Some(16), ..SensorNumbers::default() };
        let file = SensorFile {
            source: "a \"place\"".into(),
            gyro: Some(gyro),
            wheel: Some(wheel),
            ..SensorFile::default()
        };
        assert_eq!(SensorFile::parse(&to_toml(&file)).unwrap(), file);
    }
}
