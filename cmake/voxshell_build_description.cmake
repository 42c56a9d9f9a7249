# Tells a source of the current directory which compiler builds it, and with which flags, as strings.
function(voxshell_describe_build source)
  string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
  string(STRIP "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type}} -ffp-contract=off" flags)
  set_property(
    SOURCE ${source}
    APPEND
    PROPERTY COMPILE_DEFINITIONS "VOXSHELL_COMPILER=\"${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}\""
             "VOXSHELL_FLAGS=\"${flags}\"")
endfunction()
