# What our own sources compile with, and nobody else's.

set(voxshell_warning_options "")
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  list(APPEND voxshell_warning_options
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
    $<$<CXX_COMPILER_ID:GNU>:-Wlogical-op>)
  if(VOXSHELL_WERROR)
    list(APPEND voxshell_warning_options -Werror)
  endif()
endif()

# Every target of a directory and of those below it, so that no target can be forgotten; the
# binding library that nanobind adds to the directory keeps its own ways.
function(voxshell_add_warnings directory)
  get_property(targets DIRECTORY "${directory}" PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(type ${target} TYPE)
    if(type MATCHES "LIBRARY|EXECUTABLE" AND NOT type STREQUAL "INTERFACE_LIBRARY"
       AND NOT target MATCHES "^nanobind")
      target_compile_options(${target} PRIVATE ${voxshell_warning_options})
    endif()
  endforeach()
  get_property(subdirectories DIRECTORY "${directory}" PROPERTY SUBDIRECTORIES)
  foreach(subdirectory IN LISTS subdirectories)
    voxshell_add_warnings("${subdirectory}")
  endforeach()
endfunction()
