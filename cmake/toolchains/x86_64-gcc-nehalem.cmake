# A processor without AVX2 and fused multiply-add.
include("${CMAKE_CURRENT_LIST_DIR}/x86_64-gcc.cmake")
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-x86_64;-cpu;Nehalem)
