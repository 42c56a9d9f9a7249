# Installs voxshell into WORK_DIR, builds the example against it with find_package alone, and runs it; then
# moves what was installed and does the same with pkg-config alone.
# Wants BUILD_DIR, SOURCE_DIR (the example's), WORK_DIR, CXX and PKG_CONFIG.
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE "${WORK_DIR}")
run("${CMAKE_COMMAND}" --install "${BUILD_DIR}" --prefix "${WORK_DIR}/installed")
if(EXISTS "${WORK_DIR}/installed/voxshell")
  message(FATAL_ERROR "the Python modules were installed beside the libraries")
endif()
run("${CMAKE_COMMAND}" -S "${SOURCE_DIR}" -B "${WORK_DIR}/build" "-DCMAKE_BUILD_TYPE=Release"
    "-DCMAKE_CXX_COMPILER=${CXX}" "-DCMAKE_PREFIX_PATH=${WORK_DIR}/installed")
run("${CMAKE_COMMAND}" --build "${WORK_DIR}/build")
run("${WORK_DIR}/build/falling_ring")

file(RENAME "${WORK_DIR}/installed" "${WORK_DIR}/moved")
file(GLOB_RECURSE packages "${WORK_DIR}/moved/*/voxshell-*.pc")
list(LENGTH packages count)
if(count LESS 2)
  message(FATAL_ERROR "installed for pkg-config: '${packages}', not the core and an adapter")
endif()
foreach(package IN LISTS packages)
  cmake_path(GET package PARENT_PATH folder)
  cmake_path(GET package STEM name)
  execute_process(
    COMMAND "${CMAKE_COMMAND}" -E env "PKG_CONFIG_PATH=${folder}" "${PKG_CONFIG}" --cflags --libs ${name}
    OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  set(source "${SOURCE_DIR}/falling_ring.cpp")
  if(name STREQUAL voxshell-core)
    set(source "${WORK_DIR}/core.cpp")
    file(WRITE "${source}"
         "#include <voxshell/sphere_field.h>\n#include <voxshell/triangle_mesh.h>\n"
         "int main() { return voxshell::TriangleMesh::create({}, {}) ? 1 : 0; }\n")
  endif()
  run("${CXX}" -O1 "${source}" ${flags} -o "${WORK_DIR}/${name}")
  run("${WORK_DIR}/${name}")
endforeach()
