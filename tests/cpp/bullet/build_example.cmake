# Installs voxshell into WORK_DIR, builds the example against it with find_package alone, and runs it; asks for
# single components; then moves what was installed and builds the example with pkg-config alone.
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

# configure_with(COMPONENT TARGETS...): configures a project that asks for a component, and expects exactly TARGETS.
function(configure_with component)
  set(source "${WORK_DIR}/${component}")
  file(WRITE "${source}/CMakeLists.txt"
       "cmake_minimum_required(VERSION 3.22)\nproject(components LANGUAGES CXX)\n"
       "find_package(voxshell REQUIRED COMPONENTS ${component})\n"
       "foreach(target IN ITEMS core bullet bullet_float64)\n"
       "  if(TARGET voxshell::\${target})\n    list(APPEND found \${target})\n  endif()\n"
       "endforeach()\n"
       "if(NOT \"\${found}\" STREQUAL \"${ARGN}\")\n  message(FATAL_ERROR \"found '\${found}'\")\nendif()\n"
       "if(TARGET PkgConfig::BULLET AND \"${component}\" STREQUAL core)\n"
       "  message(FATAL_ERROR \"the core asked for Bullet\")\nendif()\n")
  execute_process(
    COMMAND "${CMAKE_COMMAND}" -S "${source}" -B "${source}/build" "-DCMAKE_CXX_COMPILER=${CXX}"
            "-DCMAKE_PREFIX_PATH=${WORK_DIR}/installed"
    RESULT_VARIABLE code ERROR_VARIABLE errors)
  set(code "${code}" PARENT_SCOPE)
  set(errors "${errors}" PARENT_SCOPE)
endfunction()
configure_with(core core)
if(code)
  message(FATAL_ERROR "the component core is not found: ${errors}")
endif()
configure_with(bullet core bullet)
if(code)
  message(FATAL_ERROR "the component bullet is not found: ${errors}")
endif()
configure_with(haptics)
if(NOT code OR NOT errors MATCHES "'haptics' is not[ \n]+installed; installed[ \n]+components: core")
  message(FATAL_ERROR "an unknown component is not refused: ${errors}")
endif()

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
