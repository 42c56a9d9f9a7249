# shellcheck shell=bash
# Part of ./dev: what the system must have, and its packages.

readonly apt_build=(build-essential ca-certificates cmake git glmark2-data libbullet-extras-dev
  ninja-build pkg-config python3 python3-dev python3-venv)
readonly apt_test=(libbullet-dev libgtest-dev)
readonly apt_bench=(libbenchmark-dev)
readonly apt_fuzz=(clang xz-utils)
readonly browsers=(chromium chromium-browser google-chrome google-chrome-stable)

find_browser() {
  local browser
  for browser in ${VOXSHELL_BROWSER:+"$VOXSHELL_BROWSER"} "${browsers[@]}"; do
    # On Ubuntu a stub stands in for a browser that is not there.
    if browser=$(command -v "$browser") && "$browser" --version >/dev/null 2>&1; then
      printf '%s\n' "$browser"
      return
    fi
  done
  return 1
}

python_works() {
  "$1" - 2>/dev/null <<'PY'
import os, sys, sysconfig
import ensurepip, venv
header = os.path.join(sysconfig.get_path("include"), "Python.h")
sys.exit(not (sys.version_info >= (3, 10) and os.path.exists(header)))
PY
}

find_python() {
  local candidate
  for candidate in python3 /usr/bin/python3; do
    if candidate=$(command -v "$candidate") && python_works "$candidate"; then
      printf '%s\n' "$candidate"
      return
    fi
  done
  return 1
}

at_least() { [[ $(printf '%s\n' "$1" "$2" | sort -V | head -n 1) == "$1" ]]; }

pkg_config_finds() { command -v pkg-config >/dev/null && pkg-config --exists "$@"; }

links_fuzzers() {
  say 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }' |
    clang++ -x c++ -fsanitize=fuzzer,address - -o /dev/null 2>/dev/null
}

# Prints one line for each thing that the system lacks. An argument "test", "bench" or "fuzz" adds what those need.
lacking() {
  command -v "${CXX:-c++}" >/dev/null || say "a C++20 compiler (g++ 11 or later, clang 14 or later)"
  if ! command -v cmake >/dev/null || ! at_least 3.22 "$(cmake --version | sed -n 's/^cmake version //p')"; then
    say "cmake 3.22 or later"
  fi
  command -v ninja >/dev/null || say "ninja"
  command -v pkg-config >/dev/null || say "pkg-config"
  find_python >/dev/null || say "Python 3.10 or later with venv, pip and headers (Python.h)"
  # shellcheck disable=SC2154  # dev sets it
  if [[ ${1:-} == test || $pinned_bullet == OFF ]] && ! pkg_config_finds bullet bullet-float64; then
    say "Bullet 3 with its headers in single and double precision (bullet.pc and bullet-float64.pc)"
  fi
  if [[ ${1:-} == test ]] && ! pkg_config_finds gtest; then say "GoogleTest"; fi
  if [[ ${1:-} == bench ]] && ! pkg_config_finds benchmark; then say "google-benchmark"; fi
  if [[ ${1:-} == fuzz ]] && ! links_fuzzers; then say "clang++ 14 or later with libFuzzer"; fi
}

# Prints those of the named apt packages that are not installed.
not_installed() {
  local package
  for package; do
    dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || say "$package"
  done
}

as_root() { if ((EUID == 0)); then "$@"; else sudo "$@"; fi; }

may_become_root() {
  ((EUID == 0)) && return
  command -v sudo >/dev/null || return
  sudo -n true 2>/dev/null && return
  # sudo will ask for a password: only where somebody can answer, and before any progress is drawn.
  [[ -t 0 && -t 1 ]] && say "sudo is needed to install: $*" && sudo -v
}

apt_install() {
  local packages=("$@")
  # Finishes what an interrupted installation left behind.
  as_root dpkg --configure -a || return
  # A broken third-party source must not stop us: what matters is whether the packages can be had.
  as_root apt-get update || say "apt-get update failed; trying with the lists that are here"
  as_root env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 install --yes \
    --no-install-recommends "${packages[@]}"
}

# Installs the system packages for GROUP: build, or test, bench or fuzz (which include build).
need_system() {
  local group=$1 wanted=("${apt_build[@]}") missing=() lacks
  [[ $group == test ]] && wanted+=("${apt_test[@]}")
  [[ $group == bench ]] && wanted+=("${apt_bench[@]}")
  if [[ $group == fuzz ]]; then
    wanted+=("${apt_fuzz[@]}")
    # Of newer releases a package of its own, whose name says which clang it is for.
    if command -v clang++ >/dev/null && ! links_fuzzers; then
      wanted+=("libclang-rt-$(clang++ -dumpversion | cut -d. -f1)-dev")
    fi
  fi
  if command -v apt-get >/dev/null && command -v dpkg-query >/dev/null; then
    # Ubuntu's package of that name only leads to a snap.
    if [[ $group == test ]] && ! grep -qx 'ID=ubuntu' /etc/os-release && ! find_browser >/dev/null; then
      wanted+=(chromium)
    fi
    mapfile -t missing < <(not_installed "${wanted[@]}")
    ((${#missing[@]} == 0)) && return
    if may_become_root "${missing[@]}"; then
      say "installing with apt: ${missing[*]}" | fold -s -w 80
      phase packages "system packages" apt_install "${missing[@]}"
      return
    fi
  fi
  lacks=$(lacking "$group")
  [[ -z $lacks ]] && return
  {
    say "dev: this system lacks what the build needs:"
    say "$lacks" | sed 's/^/  - /'
    if ((${#missing[@]} > 0)); then
      say "As root, run:"
      say "  apt-get update && apt-get install --no-install-recommends ${missing[*]}"
    else
      say "Install these with your system's package manager, then run the same command again."
      say "(Their names on Debian and Ubuntu: ${wanted[*]})"
    fi
  } >&2
  exit 1
}
