# Options for everything compiled below this directory, generated and third-party sources included.

if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  # The same bits on every machine and instruction set: no fused multiply-add that the source does not spell out,
  # no fast-math. No -march either: kernels choose their instruction set at run time.
  add_compile_options(-ffp-contract=off)
  add_compile_options(-fstack-protector-strong)
  # Fortify needs an optimizer and blinds the address sanitizer; some compilers predefine it, hence the -U.
  if(NOT VOXSHELL_SANITIZE)
    add_compile_options(
      "$<$<NOT:$<CONFIG:Debug>>:SHELL:-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2>")
  endif()
  # Bounds-checked operator[] where it costs nobody a haptic step.
  add_compile_options($<$<CONFIG:Debug>:-D_GLIBCXX_ASSERTIONS>)

  if(VOXSHELL_SANITIZE)
    add_compile_options(
      -fsanitize=${VOXSHELL_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -D_GLIBCXX_ASSERTIONS)
    add_link_options(-fsanitize=${VOXSHELL_SANITIZE})
  endif()
endif()

if(UNIX AND NOT APPLE)
  add_link_options(-Wl,-z,relro,-z,now,-z,noexecstack)
endif()
