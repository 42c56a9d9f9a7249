# shellcheck shell=bash
# Part of ./dev: wheels and the sdist.

wheel() {
  local twice=OFF all=OFF aarch64=OFF option
  for option; do
    case $option in
      --twice) twice=ON ;;
      --all) all=ON ;;
      --aarch64) aarch64=ON ;;
      *) die "wheel takes --twice, --all and --aarch64, not '$option'" ;;
    esac
  done
  # What archives say of when: of the commit, or 1980, where zip begins.
  SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || say 315619200)}
  export SOURCE_DATE_EPOCH
  mkdir -p build
  need_system build
  [[ $aarch64 == OFF ]] || need_aarch64
  need_venv
  need_tools run wheel
  rm -rf build/dist build/wheel
  [[ $all == OFF ]] || link_for_older_systems
  phase sdist "making the sdist and, of it alone, a wheel" make_wheel
  phase repair "finding the wheel's platform" repair_wheel
  [[ $twice == OFF ]] || phase again "making the wheel a second time, elsewhere" make_wheel_again
  phase wheel-check "trying the wheel in a fresh environment" \
    .venv/bin/python tools/check_wheel.py build/dist/voxshell-*.whl tools/constraints.txt
  tail -n 1 build/logs/wheel-check.log
  [[ $twice == OFF ]] || say "a second build in another folder gave the same bytes"
  [[ $aarch64 == OFF ]] || wheels_of_aarch64
  [[ $all == OFF ]] || wheels_of_others
  phase studies "making the wheel of the studies" .venv/bin/python -m build --wheel --outdir build/dist studies
  ls -1 build/dist/*
}

# Of Python 3.10 and later: "VERSION INTERPRETER" for each that the path or pyenv has.
find_pythons() {
  local minor python
  for minor in 10 11 12 13 14 15; do
    for python in "$(command -v "python3.$minor" || :)" "${PYENV_ROOT:-$HOME/.pyenv}/versions/3.$minor".*/bin/python3; do
      if [[ -x $python ]] && "$python" -c '' 2>/dev/null; then
        say "3.$minor $python"
        break
      fi
    done
  done
}

# Lets wheels run on systems that are older than this one; the compiler stays this system's.
link_for_older_systems() {
  if [[ $(uname -m) != x86_64 ]] || ! grep -qx 'ID=debian' /etc/os-release || ! may_become_root debootstrap; then
    note "wheels will need a C library at least as new as this system's; Debian on x86-64 builds for older ones"
    return
  fi
  command -v debootstrap >/dev/null || phase packages "system packages" apt_install debootstrap
  phase sysroot "laying out an older C library" as_root env "PATH=$PATH" tools/make_sysroot.sh "$PWD/build/sysroot"
  CXXFLAGS=$(sed -n 's/^CXXFLAGS=//p' build/sysroot/flags) LDFLAGS=$(sed -n 's/^LDFLAGS=//p' build/sysroot/flags)
  export CXXFLAGS LDFLAGS
}

# Builds wheels for the Pythons that the one in .venv does not serve, and tries all wheels with all Pythons.
# That of 3.12 serves later ones.
wheels_of_others() {
  local own version python wheel
  own=$(.venv/bin/python -c 'import sys; print(f"3.{sys.version_info.minor}")')
  while read -r version python; do
    if [[ $version != "$own" ]] && ! compgen -G 'build/dist/voxshell-*-abi3-*.whl' >/dev/null; then
      phase "wheel-$version" "making the wheel for Python $version" make_wheel_with "$version" "$python"
    fi
    wheel=$(compgen -G "build/dist/voxshell-*-cp${version/./}-cp*.whl" || compgen -G 'build/dist/voxshell-*-abi3-*.whl')
    [[ $version == "$own" ]] || phase "wheel-check-$version" "trying $wheel with Python $version" \
      "$python" tools/check_wheel.py "$wheel" tools/constraints.txt
    [[ $version == "$own" ]] || tail -n 1 "build/logs/wheel-check-$version.log"
  done < <(find_pythons)
}

make_wheel_with() {
  make_unrepaired_wheel "$@" && find_platform build/dist "build/wheel/$1"/*.whl
}

# make_unrepaired_wheel NAME PYTHON [OPTION...]: of the sdist, in build/wheel/NAME. OPTIONs go to pip.
make_unrepaired_wheel() {
  PIP_CONSTRAINT="$PWD/tools/constraints.txt" PIP_BUILD_CONSTRAINT="$PWD/tools/constraints.txt" \
    "$2" -m pip wheel --disable-pip-version-check --no-input --verbose --no-deps --wheel-dir "build/wheel/$1" \
    "${@:3}" build/wheel/*.tar.gz
}

# Python "VERSION RELEASE": that of Debian's RELEASE, whose headers and interpreter wheels for aarch64 are built with and
# tried with. That of 3.13 serves 3.12 and all later ones.
readonly pythons_of_aarch64=("3.11 bookworm" "3.13 trixie")
readonly apt_aarch64=(debootstrap g++-aarch64-linux-gnu qemu-user)

need_aarch64() {
  local missing=()
  if [[ $(uname -m) != x86_64 ]] || ! grep -qx 'ID=debian' /etc/os-release || ! may_become_root debootstrap; then
    die "wheels for aarch64 are built on Debian on x86-64, as root or with sudo; on aarch64, run ./dev wheel"
  fi
  mapfile -t missing < <(not_installed "${apt_aarch64[@]}")
  ((${#missing[@]} == 0)) || phase packages "system packages" apt_install "${missing[@]}"
}

# Tries each emulated: its world must end with the same bits as that of the wheel of this processor.
wheels_of_aarch64() {
  local own version release python root name made=OFF
  own=$(compgen -G 'build/dist/voxshell-*_x86_64.whl')
  phase sysroot-aarch64 "laying out an older C library for aarch64" \
    as_root env "PATH=$PATH" tools/make_sysroot.sh "$PWD/build/sysroot-aarch64" aarch64
  while read -r version release; do
    python=$(find_pythons | sed -n "s/^$version //p")
    name=$version-aarch64 root=$PWD/build/$release-aarch64
    [[ -n $python ]] || { note "no wheel for aarch64 and Python $version: the path has no python$version" && continue; }
    phase "debian-$name" "unpacking Debian's Python $version for aarch64" as_root env "PATH=$PATH" \
      tools/unpack_debian.sh "$root" "$release" arm64 "python$version" "libpython$version-dev" python3-pip-whl
    phase "wheel-$name" "making the wheel for aarch64 and Python $version" \
      make_wheel_of_aarch64 "$name" "$python" "$version" "$root"
    phase "wheel-check-$name" "trying it under qemu" .venv/bin/python tools/check_emulated_wheel.py \
      "build/wheel/$name/repaired"/*.whl "$own" tools/constraints.txt "$root"
    tail -n 1 "build/logs/wheel-check-$name.log"
    cp "build/wheel/$name/repaired"/*.whl build/dist/
    made=ON
  done < <(printf '%s\n' "${pythons_of_aarch64[@]}")
  [[ $made == ON ]] || die "no Python of the path or pyenv builds wheels for aarch64; install python3.11 with its headers"
}

# make_wheel_of_aarch64 NAME PYTHON VERSION ROOT: PYTHON, of this processor, runs the build; ROOT has the other's headers.
make_wheel_of_aarch64() {
  local flags=build/sysroot-aarch64/flags
  CMAKE_TOOLCHAIN_FILE=$PWD/cmake/toolchains/aarch64-gcc.cmake \
    CXXFLAGS="$(sed -n 's/^CXXFLAGS=//p' "$flags") -idirafter $4/usr/include" \
    LDFLAGS="$(sed -n 's/^LDFLAGS=//p' "$flags") -s" \
    make_unrepaired_wheel "$1" "$2" --config-settings=cmake.define.Python_INCLUDE_DIR="$4/usr/include/python$3" \
    --config-settings=env._PYTHON_HOST_PLATFORM=linux-aarch64 \
    --config-settings=env.SETUPTOOLS_EXT_SUFFIX=".cpython-${3/./}-aarch64-linux-gnu.so" &&
    PATH="$PWD/.venv/bin:$PATH" .venv/bin/auditwheel repair --wheel-dir "build/wheel/$1/repaired" "build/wheel/$1"/*.whl
}

# `build` makes the sdist, unpacks it, and builds the wheel in an environment of its own.
make_wheel() {
  PIP_CONSTRAINT="$PWD/tools/constraints.txt" PIP_DISABLE_PIP_VERSION_CHECK=1 \
    .venv/bin/python -m build --outdir build/wheel .
}

repair_wheel() {
  find_platform build/dist build/wheel/*.whl && cp build/wheel/*.tar.gz build/dist/ &&
    .venv/bin/auditwheel show build/dist/*.whl
}

find_platform() { PATH="$PWD/.venv/bin:$PATH" .venv/bin/auditwheel repair --strip --wheel-dir "$@"; }

make_wheel_again() {
  local elsewhere
  elsewhere=$(mktemp --directory) && mkdir "$elsewhere/sources" &&
    tar --extract --file build/wheel/*.tar.gz --strip-components 1 --directory "$elsewhere/sources" &&
    PIP_CONSTRAINT="$PWD/tools/constraints.txt" PIP_DISABLE_PIP_VERSION_CHECK=1 \
      .venv/bin/python -m build --wheel --outdir "$elsewhere/wheel" "$elsewhere/sources" &&
    find_platform "$elsewhere/dist" "$elsewhere"/wheel/*.whl &&
    cmp "$elsewhere"/dist/*.whl build/dist/*.whl || return
  rm -rf "$elsewhere"
}
