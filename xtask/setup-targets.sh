#!/usr/bin/env bash
# Gives the installed rustc the `core` and `alloc` of a bare-metal target, compiled once from
# Debian's `rust-src` package of exactly the same release: what `rustup target add` would download,
# for machines where rustup's servers can't be reached.
#
# usage: setup-targets.sh TARGET...     needs rustc, cargo, apt-get, dpkg-deb, python3; about a minute
# Does nothing for a target that is there. `rm -rf $(rustc --print sysroot)/lib/rustlib/TARGET` undoes it.
set -euo pipefail
fail() { echo "setup-targets: $*" >&2; exit 1; }
[ $# -gt 0 ] || fail "name at least one target, e.g. thumbv7em-none-eabihf"

release=$(rustc -vV | sed -n 's/^release: //p')
sysroot=$(rustc --print sysroot)
missing=()
for target in "$@"; do
  compgen -G "$sysroot/lib/rustlib/$target/lib/libcore-*.rlib" >/dev/null || missing+=("$target")
done
[ ${#missing[@]} -gt 0 ] || exit 0
for tool in cargo apt-get dpkg-deb python3; do
  command -v "$tool" >/dev/null || fail "$tool is missing; it is needed to build ${missing[*]} from Debian's rust-src"
done

work=${XDG_CACHE_HOME:-$HOME/.cache}/rust-bare-targets/$release
mkdir -p "$work"

# 1. The library source of exactly this release: one already on the machine, else Debian's package.
source=""
for dir in "$sysroot/lib/rustlib/src/rust/library" "/usr/src/rustc-$release/library" \
           "$work/src/usr/src/rustc-$release/library"; do
  if [ -f "$dir/core/Cargo.toml" ] && [ -d "$dir/vendor" ]; then source=$dir; break; fi
done
if [ -z "$source" ]; then
  # A private apt state: the machine's own package sources stay as they are, nothing is installed.
  site=$(apt-get update --print-uris 2>/dev/null | sed -n "s#^'\(.*/debian\)/dists/.*#\1#p" | sort -u | head -1 || true)
  [ -n "$site" ] || fail "apt has no Debian source to take rust-src from; with access to rustup's servers:
  rustup target add ${missing[*]}"
  keyring=/usr/share/keyrings/debian-archive-keyring.gpg
  [ -f "$keyring" ] || fail "$keyring is missing: apt-get install debian-archive-keyring"
  apt=$work/apt
  mkdir -p "$apt"/{parts,lists/partial,cache/archives/partial}
  options=(-o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts="$apt/parts" -o Dir::State::lists="$apt/lists"
           -o Dir::Cache="$apt/cache" -o Acquire::Languages=none -o Acquire::Retries=3 -o APT::Sandbox::User=root)
  for suite in trixie-backports forky sid experimental; do
    printf 'Types: deb\nURIs: %s\nSuites: %s\nComponents: main\nSigned-By: %s\n' \
      "$site" "$suite" "$keyring" >"$apt/parts/rust.sources"
    apt-get "${options[@]}" -qq update || continue
    version=$(apt-cache "${options[@]}" madison rust-src | awk '{print $3}' | grep -m1 -F "$release+") || continue
    echo "setup-targets: rust-src $version from Debian $suite"
    (cd "$work" && rm -f rust-src_*.deb && apt-get "${options[@]}" -qq download "rust-src=$version")
    mkdir -p "$work/src"
    dpkg-deb --fsys-tarfile "$work"/rust-src_*.deb | tar x -C "$work/src" --wildcards './usr/src/rustc-*/library/*'
    rm -f "$work"/rust-src_*.deb
    source=$work/src/usr/src/rustc-$release/library
    break
  done
fi
[ -n "$source" ] || fail "Debian has no rust-src $release (looked in trixie-backports, forky, sid, experimental):
  use a toolchain whose release Debian has, or, with access to rustup's servers: rustup target add ${missing[*]}"

# 2. A copy that resolves offline. Debian vendors the dependencies for building, not those for
# testing: drop dev-dependencies, the optional `cc`, the test crates and the lock file.
library=$work/library
rm -rf "$library"
cp -r "$source" "$library"
python3 - "$library" <<'PY'
import pathlib, re, sys
library = pathlib.Path(sys.argv[1])
def edit(path, change):
    path.write_text(change(path.read_text()))
for manifest in library.glob('*/Cargo.toml'):
    edit(manifest, lambda s: re.sub(r'(?ms)^\[dev-dependencies\]\n.*?(?=^\[|\Z)', '', s))
for manifest in (library/'compiler-builtins/compiler-builtins/Cargo.toml', library/'profiler_builtins/Cargo.toml'):
    edit(manifest, lambda s: re.sub(r'(?m)^cc = .*\n', '', s).replace('c = ["dep:cc"]', 'c = []'))
edit(library/'Cargo.toml', lambda s: s.replace('  "coretests",\n', '').replace('  "alloctests",\n', ''))
(library/'Cargo.lock').unlink(missing_ok=True)
PY

# 3. Build and install. `alloc` brings `core` and `compiler_builtins` with it. Nobody's own settings count: the same
# bytes on every machine.
unset ${!CARGO_PROFILE_@} CARGO_INCREMENTAL RUSTC_WORKSPACE_WRAPPER
for target in "${missing[@]}"; do
  echo "setup-targets: building core and alloc for $target"
  env -u CARGO_ENCODED_RUSTFLAGS -u RUSTC_WRAPPER RUSTC_BOOTSTRAP=1 \
      RUSTFLAGS="-Zforce-unstable-if-unmarked -Cembed-bitcode=yes --remap-path-prefix=$library=/rustc/library" \
      CARGO_PROFILE_RELEASE_DEBUG=1 CARGO_PROFILE_RELEASE_CODEGEN_UNITS=1 \
    cargo build -q --offline --release --manifest-path "$library/Cargo.toml" -p alloc \
      --features compiler-builtins-mem --target "$target" --target-dir "$work/target" \
      --config 'source.crates-io.replace-with="vendored"' --config "source.vendored.directory=\"$library/vendor\""
  installed=$sysroot/lib/rustlib/$target/lib
  rm -rf "$installed.new"
  mkdir -p "$installed.new"
  cp "$work/target/$target"/release/deps/lib*.rlib "$installed.new/"
  rm -rf "$installed"
  mv "$installed.new" "$installed"
  echo "setup-targets: installed $sysroot/lib/rustlib/$target"
done
rm -rf "$work/target" "$library"
