#!/usr/bin/env bash
# valgrind 3.19.0: of the two encodings of `vmovq` between registers, only one is decoded; a program with the other ends with an
# illegal instruction, although the processor executes both.
#
# LLVM takes the encoding with the source in the register field (66 0F D6) for a source in xmm8 to xmm15, which saves a byte. Optimised
# programs therefore end under callgrind and memcheck, with any tool, wherever the compiler clears the upper half of such a register.
# Seen with: Debian's valgrind 1:3.19.0-1 on x86-64 with AVX: the encoding F3 0F 7E ends with 0, 66 0F D6 with signal 4 (132).
# Fails when either is another.
set -euo pipefail
grep -qw avx /proc/cpuinfo || { echo "skipped: the processor has no AVX"; exit 0; }
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
chmod 755 .
apt-get download --quiet valgrind=1:3.19.0-1
dpkg -x valgrind_*.deb valgrind
cat >elf.py <<'PYTHON'
# A static program: one instruction, then exit(0).
import os
import struct
import sys

code = bytes.fromhex(sys.argv[2] + "31ff" + "b83c000000" + "0f05")
start = 0x400000
header = b"\x7fELF\x02\x01\x01".ljust(16, b"\0")
header += struct.pack("<HHIQQQIHHHHHH", 2, 62, 1, start + 120, 64, 0, 0, 64, 56, 1, 0, 0, 0)
size = 120 + len(code)
segment = struct.pack("<IIQQQQQQ", 1, 5, 0, start, start, size, size, 0x1000)
with open(sys.argv[1], "wb") as file:
    file.write(header + segment + code)
os.chmod(sys.argv[1], 0o755)
PYTHON
# vmovq xmm3, xmm11
python3 elf.py loaded c4c17a7edb
python3 elf.py stored c579d6db
ended() { "$@" >/dev/null 2>&1 && echo 0 || echo $?; }
under=(env VALGRIND_LIB="$place/valgrind/usr/libexec/valgrind" "$place/valgrind/usr/bin/valgrind" --tool=none)
"${under[@]}" --version
seen="$(ended ./loaded) $(ended ./stored) $(ended "${under[@]}" ./loaded) $(ended "${under[@]}" ./stored)"
echo "alone: F3 0F 7E, 66 0F D6; under valgrind: the same: $seen"
[ "$seen" = "0 0 0 132" ] || { echo "changed: was 0 0 0 132" >&2; exit 1; }
