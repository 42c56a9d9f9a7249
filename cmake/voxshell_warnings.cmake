# voxshell::warnings: what every target of this project compiles with, and no target of anybody else.
# Link it PRIVATE and for the build only, so that it does not appear in the exported targets:
#   target_link_libraries(voxshell_core PRIVATE $<BUILD_INTERFACE:voxshell::warnings>)

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
    -Wnull-dereference
    -Wformat=2
    -Wimplicit-fallthrough
    $<$<CXX_COMPILER_ID:GNU>:-Wduplicated-cond>
    $<$<CXX_COMPILER_ID:GNU>:-Wlogical-op>
    # GCC 11 and 12 see uninitialised and out-of-bounds reads in their own optimised standard library.
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<CONFIG:Release,RelWithDebInfo,MinSizeRel>>:-Wno-null-dereference>
    $<$<BOOL:${VOXSHELL_WERROR}>:-Werror>)
endif()
