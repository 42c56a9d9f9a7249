set(processor s390x)
include("${CMAKE_CURRENT_LIST_DIR}/gcc.cmake")
# GCC 12 is wrong about libstdc++'s comparison of vectors on big-endian machines.
set(CMAKE_CXX_FLAGS_INIT -Wno-stringop-overread)
