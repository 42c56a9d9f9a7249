# As gcc.cmake, but clang with that compiler's libraries.
include("${CMAKE_CURRENT_LIST_DIR}/gcc.cmake")
set(CMAKE_CXX_COMPILER clang++)
set(CMAKE_C_COMPILER clang)
set(CMAKE_CXX_COMPILER_TARGET ${processor}-linux-gnu)
set(CMAKE_C_COMPILER_TARGET ${processor}-linux-gnu)
