#!/usr/bin/env bash
# Unpacks the programs, libraries and headers of a Debian with PACKAGEs into DIR. Nothing of it is run, so that it may be
# one for another processor: compilers find its headers and libraries, and qemu its programs.
#
# usage: tools/unpack_debian.sh DIR RELEASE ARCHITECTURE PACKAGE...
#
# Needs root and debootstrap. A copy that is there already stays.
set -euo pipefail

readonly root=$1 release=$2 architecture=$3
shift 3
[[ ! -e $root ]] || exit 0
rm -rf "$root.part"
debootstrap --foreign --arch="$architecture" --variant=minbase --include="$(IFS=, && echo "$*")" "$release" "$root.part"
# debootstrap leaves PACKAGEs to a second stage, which runs programs. Folders of packages may be links here.
for package in "$root.part"/var/cache/apt/archives/*.deb; do
  dpkg-deb --fsys-tarfile "$package" | tar --extract --keep-directory-symlink --directory "$root.part"
done
# The rest leads out of DIR, as dev/fd does to the files of whoever looks, or is large.
find "$root.part" -mindepth 1 -maxdepth 1 ! -name usr ! -name 'lib*' -exec rm -rf {} +
find "$root.part/usr/share" -mindepth 1 -maxdepth 1 ! -name python-wheels -exec rm -rf {} +
# Linkers and programs would follow absolute links to this system's files.
find "$root.part" -lname '/*' | while read -r link; do
  ln --symbolic --force --relative --no-dereference "$root.part$(readlink "$link")" "$link"
done
chown -R --reference="$PWD" "$root.part"
mv "$root.part" "$root"
