# voxshell::warnings: what our own sources compile with, and nobody else's.

add_library(voxshell_warnings INTERFACE)
add_library(voxshell::warnings ALIAS voxshell_warnings)
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  target_compile_options(voxshell_warnings INTERFACE
    -Wall
    -Wextra
    -Wpedantic
    -Wshadow
    -Wconversion
    -Wsign-conversion
    -Wdouble-promotion
    -Wold-style-cast
    -Wcast-align
    -Wnon-virtual-dtor
    -Woverloaded-virtual
    -Wimplicit-fallthrough
    $<$<CXX_COMPILER_ID:GNU>:-Wduplicated-cond>
    $<$<CXX_COMPILER_ID:GNU>:-Wduplicated-branches>
    $<$<CXX_COMPILER_ID:GNU>:-Wlogical-op>
    $<$<BOOL:${VOXSHELL_WERROR}>:-Werror>)
endif()

# Gives them to every target of a directory and of those below it, so that none is forgotten, save
# nanobind's library and our own Bullet. As options, not as a link: an exported target must not name
# a target that is not exported.
function(voxshell_add_warnings directory)
  get_property(targets DIRECTORY "${directory}" PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(type ${target} TYPE)
    if(type MATCHES "LIBRARY|EXECUTABLE" AND NOT type STREQUAL "INTERFACE_LIBRARY"
       AND NOT target MATCHES "^(nanobind|pinned_bullet)")
      target_compile_options(${target} PRIVATE
        $<TARGET_PROPERTY:voxshell_warnings,INTERFACE_COMPILE_OPTIONS>)
    endif()
  endforeach()
  get_property(subdirectories DIRECTORY "${directory}" PROPERTY SUBDIRECTORIES)
  foreach(subdirectory IN LISTS subdirectories)
    voxshell_add_warnings("${subdirectory}")
  endforeach()
endfunction()
