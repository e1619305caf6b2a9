//! `data/derived_linear.toml`: linear models of shipped bicycles from a separate program.

use toml::{Table, Value};

const DERIVED: &str = include_str!("../../data/derived_linear.toml");

/// One bicycle's values.
#[derive(Clone, Debug)]
pub struct Derived {
    /// The shipped bicycle.
    pub name: String,
    /// M, C1, K0, K2, row by row.
    pub matrices: [[f64; 4]; 4],
    /// Double-root speed \[m/s\], if the file has it.
    pub v_d: Option<f64>,
    /// Weave speed \[m/s\].
    pub v_w: f64,
    /// Capsize speed \[m/s\], if there is one.
    pub v_c: Option<f64>,
    /// Speed \[m/s\] and the four eigenvalues there, (real, imaginary) \[1/s\].
    pub eigenvalues: Vec<(f64, [(f64, f64); 4])>,
}

/// All bicycles of the file.
///
/// # Panics
/// If the file has another form.
pub fn all() -> Vec<Derived> {
    let file: Table = DERIVED.parse().expect("data/derived_linear.toml is valid TOML");
    let bicycles = file.iter().filter_map(|(name, value)| Some((name, value.as_table()?)));
    bicycles.map(|(name, table)| one(name, table, &file)).collect()
}

fn one(name: &str, table: &Table, file: &Table) -> Derived {
    let rows = file.get(&format!("{name}_eigenvalues")).and_then(Value::as_array);
    let eigenvalues = rows.into_iter().flatten().map(|row| {
        let (re, im) = (floats(&row["re"]), floats(&row["im"]));
        (float(&row["v"]), std::array::from_fn(|i| (re[i], im[i])))
    });
    Derived {
        name: name.into(),
        matrices: ["M", "C1", "K0", "K2"].map(|key| {
            let rows = table[key].as_array().expect("a matrix");
            rows.iter().flat_map(floats).collect::<Vec<_>>().try_into().expect("2 x 2 numbers")
        }),
        v_d: table.get("v_d").map(float),
        v_w: float(&table["v_w"]),
        v_c: Some(float(&table["v_c"])).filter(|v| !v.is_nan()),
        eigenvalues: eigenvalues.collect(),
    }
}

fn float(value: &Value) -> f64 {
    value.as_float().expect("a decimal number")
}

fn floats(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(float).collect()
}
