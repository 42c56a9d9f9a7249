# shellcheck shell=bash
# Part of ./dev: tests of the core on other processors.

# Each is a file in cmake/toolchains. The others are compared with the first.
readonly processors=(x86_64-gcc x86_64-gcc-nehalem x86_64-clang aarch64-gcc aarch64-clang riscv64-gcc s390x-gcc)
readonly may_differ='^(SameBits|Wide|LittleEndian|PortableMath|Checksum|OrdinaryFloats|.*PortableFunctions|.*Determinism)\.'
readonly apt_processors=(clang g++-aarch64-linux-gnu g++-riscv64-linux-gnu g++-s390x-linux-gnu googletest qemu-user)

processors() {
  local names=("${processors[@]}") name first=${processors[0]} tests=$may_differ rows=() failed=()
  [[ ${1:-} == --all ]] && tests=. && shift
  (($# > 0)) && names=("$@")
  for name in "${names[@]}"; do
    [[ " ${processors[*]} " == *" $name "* ]] || die "unknown processor '$name'; there are: ${processors[*]}"
  done
  [[ $(uname -m) == x86_64 ]] || die "processors compares with x86-64 and runs there, not on $(uname -m)"
  need_processors
  phase "processor-$first" "$first: building" processor_build "$first" voxshell_model_files
  write_model_files "$first" || die "$first cannot write model files"
  for name in "${names[@]}"; do
    phase "processor-$name" "$name: building" processor_build "$name" all
    say "$name: testing ..."
    rows+=("$(test_processor "$name" "$tests")") || failed+=("$name")
    say "${rows[-1]}"
  done
  printf '%-20s  %s\n' processor result
  printf '%s\n' "${rows[@]}"
  ((${#failed[@]} == 0)) || die "failed: ${failed[*]}; see build/processors/NAME/tests.log"
}

need_processors() {
  local missing=()
  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    die "processors takes cross compilers and qemu from Debian's or Ubuntu's packages; this system has no apt-get"
  fi
  mkdir -p build
  need_system build
  mapfile -t missing < <(not_installed "${apt_processors[@]}")
  ((${#missing[@]} == 0)) && return
  may_become_root "${missing[@]}" ||
    die "as root, run: apt-get update && apt-get install --no-install-recommends ${missing[*]}"
  say "installing with apt: ${missing[*]}" | fold -s -w 80
  phase packages "system packages" apt_install "${missing[@]}"
}

processor_build() {
  local dir=build/processors/$1 toolchain=$PWD/cmake/toolchains/$1.cmake
  cmake -S /usr/src/googletest -B "$dir/googletest" -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_GMOCK=OFF \
    -DCMAKE_TOOLCHAIN_FILE="$toolchain" -DCMAKE_INSTALL_PREFIX="$PWD/$dir/prefix" &&
    cmake --build "$dir/googletest" --target install &&
    cmake -S . -B "$dir" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_TOOLCHAIN_FILE="$toolchain" \
      -DGTest_ROOT="$PWD/$dir/prefix" -DVOXSHELL_BUILD_BULLET=OFF -DVOXSHELL_PINNED_BULLET=float64 \
      -DVOXSHELL_BUILD_TESTS=ON -DVOXSHELL_PROCESSOR_TESTS=ON -DVOXSHELL_WERROR=ON &&
    cmake --build "$dir" --target "$2"
}

# model_files NAME ARGUMENTS...: the program that writes and checks model files, on that processor.
model_files() {
  local name=$1 processor=${1%%-*} emulator=()
  shift
  case $name in
    x86_64-gcc-nehalem) emulator=(qemu-x86_64 -cpu Nehalem) ;;
    x86_64-*) ;;
    *) emulator=("qemu-$processor" -L "/usr/$processor-linux-gnu") ;;
  esac
  "${emulator[@]}" "build/processors/$name/tests/cpp/core/voxshell_model_files" "$@"
}

write_model_files() {
  mkdir -p "build/processors/$1/models" && model_files "$1" write "build/processors/$1/models" >/dev/null
}

# test_processor NAME TESTS: prints a line with what was found. TESTS are those that run where it is emulated.
test_processor() {
  local name=$1 regex=$2 dir=build/processors/$1 first=${processors[0]} start=$SECONDS
  local passed=true travel=equal tests failures skipped
  [[ $name == x86_64-gcc || $name == x86_64-clang ]] && regex=.
  rm -f "$dir/tests.xml"
  ctest --test-dir "$dir" --no-tests=error --output-on-failure --parallel "$(nproc)" \
    --tests-regex "$regex" \
    --output-junit "$PWD/$dir/tests.xml" >"$dir/tests.log" 2>&1 || passed=false
  tests=$(sed -n 's/^[[:space:]]*tests="\([0-9]*\)".*/\1/p' "$dir/tests.xml" | head -n 1)
  failures=$(sed -n 's/^[[:space:]]*failures="\([0-9]*\)".*/\1/p' "$dir/tests.xml" | head -n 1)
  skipped=$(sed -n 's/^[[:space:]]*skipped="\([0-9]*\)".*/\1/p' "$dir/tests.xml" | head -n 1)
  {
    write_model_files "$name" && model_files "$name" check "build/processors/$first/models" &&
      model_files "$first" check "$dir/models" && diff -r "build/processors/$first/models" "$dir/models"
  } >>"$dir/tests.log" 2>&1 || travel=DIFFERENT
  printf '%-20s  %d of %d tests passed, %d skipped; model files %s; %d s\n' "$name" \
    $((${tests:-0} - ${failures:-0} - ${skipped:-0})) "${tests:-0}" "${skipped:-0}" "$travel" $((SECONDS - start))
  [[ $passed == true && $travel == equal ]]
}
