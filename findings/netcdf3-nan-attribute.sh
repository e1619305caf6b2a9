#!/usr/bin/env bash
# netcdf3 0.6.1: a variable with an attribute that is NaN cannot be written.
#
# The writer looks variables up by their value, attributes included, and NaN is not equal to itself: every `write_var_...` of
# such a variable, `_FillValue = NaN` for example, gives `WriteError::Unexpected`. netcdf-writer 0.12.1 writes it.
# Seen with: netcdf3 0.6.1: Err(Unexpected).
# Fails when it says something else.
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
cargo init --quiet --name finding --vcs none
cargo add --quiet netcdf3@=0.6.1
cat >src/main.rs <<'RUST'
fn main() {
    let mut set = netcdf3::DataSet::new();
    set.add_fixed_dim("x", 1).unwrap();
    set.add_var_f64("y", &["x"]).unwrap();
    set.add_var_attr_f64("y", "_FillValue", vec![f64::NAN]).unwrap();
    let mut writer = netcdf3::FileWriter::open("y.nc").unwrap();
    writer.set_def(&set, netcdf3::Version::Classic, 0).unwrap();
    println!("{:?}", writer.write_var_f64("y", &[1.0]));
}
RUST
rustc --version
seen=$(cargo run --quiet)
echo "$seen"
[ "$seen" = "Err(Unexpected)" ] || { echo "changed: was Err(Unexpected)" >&2; exit 1; }
