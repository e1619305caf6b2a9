#!/usr/bin/env bash
# octave-netcdf 1.0.16: a string variable of a NetCDF-4 file cannot be read.
#
# `ncread` ends with `unknown type 12` (NC_STRING). Rows of letters, as in the classic format, are read,
# with the zero bytes at their ends: `strcmp` with the text fails until `deblank` takes them off.
# Seen with: Octave 7.3.0 and netcdf 1.0.16 (Debian 12): unknown type 12; 0 without deblank, 1 with it.
# Fails when it reads the string, or strips the zero bytes.
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
cat >strings.cdl <<'CDL'
netcdf strings { dimensions: x = 1 ; variables: string word(x) ; data: word = "roll" ; }
CDL
cat >letters.cdl <<'CDL'
netcdf letters { dimensions: x = 1 ; n = 8 ; variables: char word(x, n) ; data: word = "roll" ; }
CDL
ncgen -k nc4 -o strings.nc strings.cdl
ncgen -k classic -o letters.nc letters.cdl
cat >read.m <<'M'
pkg load netcdf
try
  ncread("strings.nc", "word"); disp("read")
catch e
  disp(e.message)
end
word = cellstr(ncread("letters.nc", "word")');
printf("%d %d\n", strcmp(word, "roll"), strcmp(deblank(word), "roll"));
M
octave-cli --version | head -n 1
seen=$(octave-cli --quiet read.m 2>/dev/null)
echo "$seen"
[ "$seen" = $'unknown type 12\n0 1' ] || { echo "changed: was unknown type 12, then 0 1" >&2; exit 1; }
