# find_package(voxshell) for an installed tree: voxshell::core and, where built, voxshell::bullet[_float64],
# each a component of its own. The same for pkg-config: voxshell-core and voxshell-bullet[_float64].

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

# What a plain `cmake --install` brings. The Python modules are a component of their own, of which a
# wheel is made.
set(component COMPONENT development)

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/voxshell")
set(components "")
foreach(target IN LISTS targets)
  get_target_property(exported ${target} EXPORT_NAME)
  list(APPEND components ${exported})
  install(TARGETS ${target} EXPORT ${target}_targets
          ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" ${component}
          LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" ${component}
          INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
  install(EXPORT ${target}_targets NAMESPACE voxshell:: DESTINATION "${package_dir}" ${component})
endforeach()
install(DIRECTORY core/include/voxshell DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" ${component})
if(VOXSHELL_BUILD_BULLET)
  install(DIRECTORY bullet/include/voxshell DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" ${component})
endif()

configure_package_config_file(cmake/voxshell-config.cmake.in voxshell-config.cmake
                              INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file(voxshell-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/voxshell-config.cmake"
              "${CMAKE_CURRENT_BINARY_DIR}/voxshell-config-version.cmake"
              cmake/find_bullet.cmake
        DESTINATION "${package_dir}" ${component})

# The .pc files find their prefix from where they lie, so that an installed tree can be moved.
set(pkgconfig_dir "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
file(RELATIVE_PATH prefix_from_pkgconfig "/${pkgconfig_dir}" "/")
function(voxshell_add_pkgconfig name library description requires flags)
  configure_file(cmake/voxshell.pc.in "${name}.pc" @ONLY)
  install(FILES "${CMAKE_CURRENT_BINARY_DIR}/${name}.pc" DESTINATION "${pkgconfig_dir}" ${component})
endfunction()
voxshell_add_pkgconfig(voxshell-core voxshell_core "${PROJECT_DESCRIPTION}" "" "-pthread")
if(TARGET voxshell_bullet)
  voxshell_add_pkgconfig(voxshell-bullet voxshell_bullet "voxshell in Bullet, single precision"
                         "voxshell-core, bullet >= 3.0" "")
endif()
if(TARGET voxshell_bullet_float64)
  voxshell_add_pkgconfig(voxshell-bullet_float64 voxshell_bullet_float64
                         "voxshell in Bullet, double precision"
                         "voxshell-core, bullet-float64 >= 3.0" "")
endif()
