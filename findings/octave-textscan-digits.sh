#!/usr/bin/env bash
# Octave 7.3.0: `textscan` does not read the nearest double of a number with 16 or 17 digits.
#
# Of uniform random numbers printed with 17 digits most come back changed, by a few units in the last place. `str2double`
# reads all of them right. A table read by `textscan` is therefore not the same bits as the NetCDF file.
# Seen with: Octave 7.3.0 (Debian 12): textscan changes 719 of 1000 numbers, str2double none.
# Fails when textscan changes fewer than 100, or str2double any.
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
cat >digits.m <<'M'
rand("twister", 1);
x = rand(1000, 1);
f = fopen("x.csv", "w"); fprintf(f, "%.17g\n", x); fclose(f);
f = fopen("x.csv"); t = textscan(f, "%f", "Delimiter", ","); fclose(f);
other = str2double(strsplit(strtrim(fileread("x.csv")), "\n"))';
printf("%d %d\n", sum(t{1} != x), sum(other != x));
M
octave-cli --version | head -n 1
read -r scanned other < <(octave-cli --quiet digits.m 2>/dev/null)
echo "changed by textscan: $scanned, by str2double: $other, of 1000"
[ "$scanned" -ge 100 ] || { echo "changed: textscan was wrong for most" >&2; exit 1; }
[ "$other" = 0 ] || { echo "changed: str2double was right" >&2; exit 1; }
