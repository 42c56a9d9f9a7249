# Bullet of our own, as released, unchanged: static libraries pinned_bullet_float and pinned_bullet_float64, those
# that VOXSHELL_PINNED_BULLET names. Their symbols stay in the module that links them, and Bullet's classes for
# threads work in them. Take the definitions from these targets, as those of find_bullet.cmake.

# The source distribution of this release of pybullet holds Bullet 3.24 as its authors tagged it.
set(bullet_version 3.24)
set(bullet_release pybullet-3.2.4)
set(bullet_sha256 959e85bc0051324b9c4aba23d79365b77de216f9ceebc392f9d551fe63a0ebc6)
set(VOXSHELL_BULLET_ARCHIVE "" CACHE FILEPATH
    "${bullet_release}.tar.gz, to take Bullet from; where empty, pip downloads it once for each user")

# Has pip put the archive into `folder`: it checks the digest, and knows the user's mirrors and proxies.
function(download_bullet folder)
  find_package(Python 3.10 REQUIRED COMPONENTS Interpreter)
  set(work "${PROJECT_BINARY_DIR}/bullet-download")
  file(REMOVE_RECURSE "${work}")
  string(REPLACE "-" "==" requirement ${bullet_release})
  file(WRITE "${work}/requirements.txt" "${requirement} --hash=sha256:${bullet_sha256}\n")
  # pip asks the package what it is called before it keeps it, for which it needs setuptools.
  file(WRITE "${work}/constraints.txt" "setuptools==80.9.0\n")
  message(STATUS "Downloading ${bullet_release}.tar.gz (80 MB), for Bullet ${bullet_version}")
  execute_process(
    COMMAND
      "${CMAKE_COMMAND}" -E env "PIP_CONSTRAINT=${work}/constraints.txt"
      "PIP_BUILD_CONSTRAINT=${work}/constraints.txt" # pip 25.3 or later
      "${Python_EXECUTABLE}" -m pip download --disable-pip-version-check --no-input --quiet --no-cache-dir
      --no-deps --no-binary pybullet --require-hashes --requirement requirements.txt --dest .
    WORKING_DIRECTORY "${work}"
    OUTPUT_VARIABLE output
    ERROR_VARIABLE output
    RESULT_VARIABLE code)
  if(NOT code EQUAL 0)
    message(
      FATAL_ERROR
        "pip could not download ${bullet_release}.tar.gz, the sources of the Bullet that Python's World uses:\n"
        "${output}\n"
        "Without a network, either give the file, with -DVOXSHELL_BULLET_ARCHIVE=FILE, or put it into ${folder}; "
        "or build with the system's Bullet: -DVOXSHELL_PINNED_BULLET=OFF -DVOXSHELL_BUILD_BULLET=float64 "
        "(with ./dev: VOXSHELL_PINNED_BULLET=OFF in the environment).")
  endif()
  file(MAKE_DIRECTORY "${folder}")
  # Copied beside and renamed: what is there is whole.
  string(RANDOM LENGTH 8 part)
  file(COPY_FILE "${work}/${bullet_release}.tar.gz" "${folder}/${part}")
  file(RENAME "${folder}/${part}" "${folder}/${bullet_release}.tar.gz")
  file(REMOVE_RECURSE "${work}")
endfunction()

# Puts Bullet's sources into `folder`, once.
function(unpack_bullet folder)
  if(EXISTS "${folder}")
    return()
  endif()
  set(archive "${VOXSHELL_BULLET_ARCHIVE}")
  if(NOT archive)
    if(DEFINED ENV{XDG_CACHE_HOME})
      set(cache "$ENV{XDG_CACHE_HOME}/voxshell/sources")
    else()
      set(cache "$ENV{HOME}/.cache/voxshell/sources")
    endif()
    set(archive "${cache}/${bullet_release}.tar.gz")
    if(NOT EXISTS "${archive}")
      download_bullet("${cache}")
    endif()
  endif()
  file(SHA256 "${archive}" sha256)
  if(NOT sha256 STREQUAL bullet_sha256)
    message(FATAL_ERROR "${archive} is not ${bullet_release}.tar.gz as released: its SHA-256 is ${sha256}, "
                        "not ${bullet_sha256}. Replace or delete it, and configure again.")
  endif()
  file(REMOVE_RECURSE "${folder}.part")
  file(ARCHIVE_EXTRACT INPUT "${archive}" DESTINATION "${folder}.part"
       PATTERNS "*/src/LinearMath/*" "*/src/BulletCollision/*" "*/src/BulletDynamics/*" "*/src/btBullet*Common.h")
  file(RENAME "${folder}.part/${bullet_release}/src" "${folder}")
  file(REMOVE_RECURSE "${folder}.part")
endfunction()

set(bullet_sources_dir "${PROJECT_BINARY_DIR}/bullet-${bullet_version}")
unpack_bullet("${bullet_sources_dir}")
find_package(Threads REQUIRED)
file(GLOB_RECURSE bullet_sources "${bullet_sources_dir}/*.cpp")
foreach(precision IN LISTS VOXSHELL_PINNED_BULLET)
  if(NOT precision MATCHES "^float(64)?$")
    message(FATAL_ERROR "VOXSHELL_PINNED_BULLET takes OFF, float, float64 or both, not '${precision}'")
  endif()
  set(target pinned_bullet_${precision})
  add_library(${target} STATIC EXCLUDE_FROM_ALL ${bullet_sources})
  target_include_directories(${target} SYSTEM PUBLIC "${bullet_sources_dir}")
  target_compile_definitions(${target} PUBLIC BT_THREADSAFE=1
                                              $<$<STREQUAL:${precision},float64>:BT_USE_DOUBLE_PRECISION>)
  target_compile_options(${target} PRIVATE -w)
  # Twenty sources at a time: a source takes longest to compile for the headers that the others include as well.
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 20)
  target_link_libraries(${target} PUBLIC Threads::Threads)
  if(precision STREQUAL "float64")
    # Functions of the C library that give other last bits on other processors, replaced in all that links this target.
    set(replaced sin cos sincos atan2 acos asin pow hypot)
    list(TRANSFORM replaced PREPEND "LINKER:--wrap=")
    set(portable_functions "${PROJECT_SOURCE_DIR}/bullet/src/portable_functions.cpp")
    target_sources(${target} PRIVATE "${portable_functions}")
    set_source_files_properties("${portable_functions}" PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}/core/src")
    target_link_libraries(${target} PUBLIC voxshell::core)
    target_link_options(${target} INTERFACE ${replaced})
    target_compile_definitions(${target} INTERFACE VOXSHELL_PORTABLE_FUNCTIONS=1)
  endif()
endforeach()
