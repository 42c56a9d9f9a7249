#!/usr/bin/env bash
# Tries a wheel on an older system: Debian 11 (glibc 2.31), with a Python 3.11 that is built there.
#
# usage: tools/check_older_system.sh [WHEELS [DIR]]
#
# In that system, installs the wheel in the folder WHEELS, by default build/dist, with the extra for replays, into a new
# environment, and runs the ten lines of README.md and tools/try_installed.py. Needs root and debootstrap, on x86-64.
# DIR, by default build/bullseye, keeps the system (1.6 GB), which takes four minutes to make.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly wheels=${1:-build/dist} root=${2:-build/bullseye}
readonly log=$root.log home=$root/root

say() { printf '%s\n' "$*"; }

# inside DIR: runs the commands of standard input in the system that DIR holds. Nobody else sees its /proc.
inside() {
  # shellcheck disable=SC2016 # the inner shell expands them
  unshare --mount bash -c 'mount --types proc proc "$1/proc" && exec chroot "$@"' bash "$1" \
    /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
    PIP_CERT=/etc/ssl/certs/ca-certificates.crt /bin/bash -euo pipefail -c "cd; $(cat)"
}

make_system() {
  debootstrap --variant=buildd --include=ca-certificates,libffi-dev,libssl-dev,zlib1g-dev bullseye "$1" || return
  say "deb-src http://deb.debian.org/debian bookworm main" >"$1/etc/apt/sources.list.d/sources.list"
  cp /etc/resolv.conf "$1/etc/"
  cp /etc/ssl/certs/ca-certificates.crt "$1/etc/ssl/certs/" # a proxy of this system may have its own
  say "building Python 3.11 in it ..." >&3
  # Debian 11 has Python 3.9. These are the sources of Debian 12, without its changes, which expect its own packages.
  inside "$1" <<'TXT'
apt-get update
apt-get source --download-only python3.11
tar --extract --file python3.11_*.orig.tar.*
cd Python-3.11*/
./configure --quiet --prefix=/opt/python --disable-test-modules
make --quiet --jobs="$(nproc)"
make --quiet install
TXT
}

if [[ ! -e $root ]]; then
  say "unpacking Debian 11 (log: $log) ..."
  rm -rf "$root.part"
  mkdir -p "$(dirname "$root")"
  make_system "$root.part" 3>&1 >"$log" 2>&1 || { tail -n 30 "$log" >&2 && exit 1; }
  mv "$root.part" "$root"
fi
say "trying the wheels of $wheels in it ..."
rm -rf "$home/wheels" "$home/tools" "$home/env"
cp -r "$wheels" "$home/wheels"
mkdir "$home/tools"
cp tools/try_readme.py tools/try_installed.py "$home/tools/"
cp README.md "$home/"
inside "$root" <<'TXT'
/opt/python/bin/python3.11 -m venv env
env/bin/pip install --quiet --disable-pip-version-check --only-binary :all: --find-links wheels "voxshell[viewer]"
env/bin/python -I tools/try_readme.py
env/bin/python -I tools/try_installed.py >/dev/null
echo "voxshell $(env/bin/voxshell --version) works with $(env/bin/python --version) and $(ldd --version | head -n 1)"
TXT
