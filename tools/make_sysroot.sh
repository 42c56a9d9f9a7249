#!/usr/bin/env bash
# Lays out the C library of Debian 11 (glibc 2.31) in DIR, so that this system's g++ links for it.
#
# usage: tools/make_sysroot.sh DIR
#
# Needs root, debootstrap and g++ on x86-64. DIR/flags then holds two lines for the environment of a build, CXXFLAGS
# and LDFLAGS. A copy that is there already stays.
set -euo pipefail

readonly root=$1 sources=$PWD/cmake
triplet=$(g++ -dumpmachine)

if [[ ! -e $root/flags ]]; then
  rm -rf "$root"
  debootstrap --variant=minbase --include=libc6-dev bullseye "$root"
  # The linker would follow absolute links to this system's libraries.
  find "$root/usr/lib/$triplet" "$root/usr/lib64" -maxdepth 1 -lname '/*' | while read -r link; do
    ln --symbolic --force --relative --no-dereference "$root$(readlink "$link")" "$link"
  done
fi
# Headers of Debian's Pythons lie half in this folder.
find "/usr/include/$triplet" -maxdepth 1 -name 'python3*' -exec cp -r {} "$root/usr/include/$triplet/" \;
gcc -O2 -fPIC -fvisibility=hidden -c "$sources/old_c_library.c" -o "$root/old_c_library.o"
chown -R --reference="$PWD" "$root"
cat >"$root/flags" <<TXT
CXXFLAGS=--sysroot=$root -include $sources/old_c_library.h
LDFLAGS=--sysroot=$root -B$root/usr/lib/$triplet -L$root/usr/lib/$triplet -L$root/lib/$triplet -static-libstdc++ $root/old_c_library.o
TXT
