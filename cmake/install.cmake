# What `cmake --install` puts where others find it: the archives, the headers of the public calls with all that they
# include, the programs that were built, and the files that find_package(flatpose) and pkg-config read.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/flatpose)
set(libraries flatpose)
if(TARGET flatpose_fieldbus)
  list(APPEND libraries flatpose_fieldbus)
  set_target_properties(flatpose_fieldbus PROPERTIES EXPORT_NAME fieldbus)
endif()

if(TARGET flatpose_camera)
  list(APPEND libraries flatpose_camera)
  set(c_driver ${PROJECT_SOURCE_DIR}/examples/camera_driver.c)
endif()

# In the tree headers lie beside the sources; elsewhere in one folder.
foreach(library ${libraries})
  get_target_property(folders ${library} INTERFACE_INCLUDE_DIRECTORIES)
  set_target_properties(${library} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES
    "$<BUILD_INTERFACE:${folders}>;$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
endforeach()
install(TARGETS ${libraries} EXPORT flatposeTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT flatposeTargets NAMESPACE flatpose:: DESTINATION ${package_dir})
install(CODE "set(source_dir \"${PROJECT_SOURCE_DIR}\")\nset(include_dir \"${CMAKE_INSTALL_INCLUDEDIR}\")\nset(libraries \"${libraries}\")")
install(SCRIPT ${CMAKE_CURRENT_LIST_DIR}/install_headers.cmake)

install(FILES ${PROJECT_SOURCE_DIR}/examples/find_plate.c ${c_driver} DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)

foreach(program flatpose_tool flatposed flatpose_camera_replay)
  if(TARGET ${program} AND NOT FLATPOSE_BUILD_GUEST)  # where they are built to be tried, not to be used
    install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
  endif()
endforeach()

# What the daemon's service needs, in their places below the prefix /usr, which the unit names.
if(TARGET flatposed AND NOT FLATPOSE_BUILD_GUEST)
  set(linux ${PROJECT_SOURCE_DIR}/port/linux)
  install(FILES ${linux}/examples/flatposed.toml DESTINATION ${CMAKE_INSTALL_DATADIR}/flatpose COMPONENT programs)
  install(FILES ${linux}/systemd/flatposed.service DESTINATION lib/systemd/system COMPONENT programs)
  install(FILES ${linux}/systemd/60-flatpose.rules DESTINATION lib/udev/rules.d COMPONENT programs)
  install(FILES ${linux}/systemd/flatpose.sysusers DESTINATION lib/sysusers.d RENAME flatpose.conf COMPONENT programs)
endif()

# While the major version is 0 a minor one may break what the last one promised.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/flatposeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/flatposeConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/flatposeConfig.cmake INSTALL_DESTINATION ${package_dir})
install(FILES ${PROJECT_BINARY_DIR}/flatposeConfigVersion.cmake ${PROJECT_BINARY_DIR}/flatposeConfig.cmake
        DESTINATION ${package_dir})

# Relative to the file itself, so that the tree may be moved.
file(RELATIVE_PATH prefix_from_pkgconfig /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
foreach(library ${libraries})
  string(REPLACE _ - name ${library})
  configure_file(${CMAKE_CURRENT_LIST_DIR}/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endforeach()
