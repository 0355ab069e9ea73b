# What `cmake --install` puts where, and the Debian packages that `cpack` makes: patchlight has the tool, libpatchlight-dev
# the library.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(patchlight_config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/patchlight)
install(TARGETS patchlight_tool RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tool)
install(FILES docs/patchlight.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tool)
install(TARGETS patchlight_core patchlight_io EXPORT patchlightTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
install(DIRECTORY include/patchlight DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library)
install(EXPORT patchlightTargets NAMESPACE patchlight:: DESTINATION ${patchlight_config_folder} COMPONENT library)
string(REPLACE ";" " " PATCHLIGHT_VTK_COMPONENTS "${patchlight_vtk_components}")
configure_package_config_file(cmake/patchlightConfig.cmake.in ${PROJECT_BINARY_DIR}/patchlightConfig.cmake
                              INSTALL_DESTINATION ${patchlight_config_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/patchlightConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/patchlightConfig.cmake ${PROJECT_BINARY_DIR}/patchlightConfigVersion.cmake
        DESTINATION ${patchlight_config_folder} COMPONENT library)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/patchlight RENAME copyright COMPONENT tool)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libpatchlight-dev RENAME copyright COMPONENT library)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the patchlight authors <patchlight@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL tool library)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_TOOL_PACKAGE_NAME patchlight)
set(CPACK_DEBIAN_TOOL_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TOOL_PACKAGE_SHLIBDEPS ON)  # the libraries that the tool is linked with
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libpatchlight-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS
    "libeigen3-dev, libembree-dev, libopenmesh-dev, libgeos-dev, libtbb-dev, libboost-dev, libtinyobjloader-dev, libassimp-dev, libtinygltf-dev, libtomlplusplus-dev, nlohmann-json3-dev, libpugixml-dev, libdraco-dev, libmeshoptimizer-dev, libssl-dev, zlib1g-dev, libcairo2-dev, libopenexr-dev, pkg-config, libvtk9-dev")
include(CPack)
