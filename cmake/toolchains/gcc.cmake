# For Linux on another `processor`: Debian's cross compiler, and programs that run under qemu.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR ${processor})
set(CMAKE_CXX_COMPILER ${processor}-linux-gnu-g++)
set(CMAKE_C_COMPILER ${processor}-linux-gnu-gcc)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-${processor};-L;/usr/${processor}-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
