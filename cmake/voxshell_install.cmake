# find_package(voxshell) for an installed tree: voxshell::core and, where built, voxshell::bullet[_float64].

include(CMakePackageConfigHelpers)

set(targets voxshell_core)
foreach(target IN ITEMS voxshell_bullet voxshell_bullet_float64)
  if(TARGET ${target})
    list(APPEND targets ${target})
  endif()
endforeach()
foreach(target IN LISTS targets)
  string(REPLACE voxshell_ "" exported ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${exported})
  target_compile_features(${target} PUBLIC cxx_std_20)
endforeach()

# A Python wheel carries the modules alone.
set(component COMPONENT development)
if(DEFINED SKBUILD)
  list(APPEND component EXCLUDE_FROM_ALL)
endif()

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/voxshell")
install(TARGETS ${targets} EXPORT voxshell_targets
        ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" ${component}
        LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" ${component}
        INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(DIRECTORY core/include/voxshell DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" ${component})
if(VOXSHELL_BUILD_BULLET)
  install(DIRECTORY bullet/include/voxshell DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" ${component})
endif()
install(EXPORT voxshell_targets NAMESPACE voxshell:: DESTINATION "${package_dir}" ${component})

configure_package_config_file(cmake/voxshell-config.cmake.in voxshell-config.cmake
                              INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file(voxshell-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/voxshell-config.cmake"
              "${CMAKE_CURRENT_BINARY_DIR}/voxshell-config-version.cmake"
              cmake/find_bullet.cmake
        DESTINATION "${package_dir}" ${component})
