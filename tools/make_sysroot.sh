#!/usr/bin/env bash
# Lays out the C library of Debian 11 (glibc 2.31) in DIR, so that g++ links for it, or for another PROCESSOR Debian's cross
# compiler.
#
# usage: tools/make_sysroot.sh DIR [PROCESSOR]
#
# Needs root, debootstrap and the compiler, on x86-64; PROCESSOR is x86_64, the default, or aarch64. DIR/flags then holds two
# lines for the environment of a build, CXXFLAGS and LDFLAGS. A copy that is there already stays.
set -euo pipefail

readonly root=$1 processor=${2:-x86_64}
readonly triplet=$processor-linux-gnu
declare -Ar architectures=([x86_64]=amd64 [aarch64]=arm64)

if [[ ! -e $root/flags ]]; then
  rm -rf "$root"
  tools/unpack_debian.sh "$root" bullseye "${architectures[$processor]}" libc6-dev
fi
if [[ $processor == x86_64 ]]; then
  # Headers of Debian's Pythons lie half in this folder.
  find "/usr/include/$triplet" -maxdepth 1 -name 'python3*' -exec cp -r {} "$root/usr/include/$triplet/" \;
fi
"$triplet-gcc" -O2 -fPIC -fvisibility=hidden -c cmake/old_c_library.c -o "$root/old_c_library.o"
# Cross compilers would look first into their own folder with headers of a newer C library.
folders=$("$triplet-g++" --sysroot="$root" -x c++ -E -v /dev/null 2>&1 >/dev/null |
  sed -n '/^#include </,/^End/{s|^ | -isystem |p}' | grep -v "/$triplet/include$" | tr --delete '\n')
cat >"$root/flags" <<TXT
CXXFLAGS=--sysroot=$root -nostdinc$folders
LDFLAGS=--sysroot=$root -B$root/usr/lib/$triplet -L$root/usr/lib/$triplet -L$root/lib/$triplet -static-libstdc++ $root/old_c_library.o
TXT
chown -R --reference="$PWD" "$root"
