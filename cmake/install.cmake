# Installation, and the Debian packages that `cpack` makes: patchlight has the tool, libpatchlight-dev the library,
# python3-patchlight the module for Python, patchlight-doc the pages of docs/ with the models that they use. What is not
# built is left out.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(CPACK_PACKAGE_CONTACT "the patchlight authors <patchlight@localhost>")

# As Debian wants manuals and changelogs: compressed, without name and time of the file.
function(patchlight_compress from to)
  execute_process(COMMAND gzip -9nc ${from} OUTPUT_FILE ${to} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# SOURCE_DATE_EPOCH gives the same bytes again.
string(TIMESTAMP patchlight_packed "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file(cmake/changelog.in ${PROJECT_BINARY_DIR}/changelog @ONLY)
patchlight_compress(${PROJECT_BINARY_DIR}/changelog ${PROJECT_BINARY_DIR}/changelog.gz)
set(patchlight_config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/patchlight)
if(PATCHLIGHT_TOOL)
  file(GLOB patchlight_manuals CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/docs/man/*.1)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${patchlight_manuals})
  set(patchlight_compressed_manuals)
  foreach(manual IN LISTS patchlight_manuals)
    get_filename_component(name ${manual} NAME)
    patchlight_compress(${manual} ${PROJECT_BINARY_DIR}/${name}.gz)
    list(APPEND patchlight_compressed_manuals ${PROJECT_BINARY_DIR}/${name}.gz)
  endforeach()
  install(TARGETS patchlight_tool RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tool)
  install(FILES docs/patchlight.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME patchlight COMPONENT tool)
  install(FILES ${patchlight_compressed_manuals} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tool)
  # The pages that `patchlight help TOPIC` prints.
  install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/patchlight/md COMPONENT tool
          FILES_MATCHING PATTERN *.md PATTERN figures EXCLUDE PATTERN man EXCLUDE)
endif()
if(PATCHLIGHT_IO)
  # The IFC reader's script with web-ifc, of which Node.js needs three files, for all that reads scenes.
  set(patchlight_ifc ${PROJECT_SOURCE_DIR}/src/input/ifc)
  set(patchlight_ifc_destination ${CMAKE_INSTALL_DATADIR}/patchlight/ifc)
  install(FILES ${patchlight_ifc}/read_ifc.mjs ${patchlight_ifc}/package.json DESTINATION ${patchlight_ifc_destination} COMPONENT tool)
  set(patchlight_web_ifc ${patchlight_ifc}/node_modules/web-ifc)
  install(FILES ${patchlight_web_ifc}/package.json ${patchlight_web_ifc}/web-ifc-api-node.js ${patchlight_web_ifc}/web-ifc-node.wasm
          DESTINATION ${patchlight_ifc_destination}/node_modules/web-ifc COMPONENT tool OPTIONAL)
  install(FILES ${patchlight_web_ifc}/LICENSE.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/patchlight
          RENAME web-ifc.copyright.md COMPONENT tool OPTIONAL)
endif()
install(TARGETS ${patchlight_libraries} EXPORT patchlightTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
if(NOT PATCHLIGHT_IO)
  set(patchlight_no_headers PATTERN input EXCLUDE PATTERN output EXCLUDE PATTERN patchlight.h EXCLUDE)
endif()
install(DIRECTORY include/patchlight DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library ${patchlight_no_headers})
install(EXPORT patchlightTargets NAMESPACE patchlight:: DESTINATION ${patchlight_config_folder} COMPONENT library)
# The packages of a target as lines of the file that find_package(patchlight) reads.
function(patchlight_find_lines result)
  set(lines ${ARGN})
  list(TRANSFORM lines REPLACE "^.+$" "find_dependency(\\0)")
  list(JOIN lines "\n" lines)
  set(${result} "${lines}" PARENT_SCOPE)
endfunction()
patchlight_find_lines(PATCHLIGHT_FIND_CORE ${patchlight_core_packages})
if(PATCHLIGHT_IO)
  patchlight_find_lines(PATCHLIGHT_FIND_IO ${patchlight_io_packages})
  foreach(module IN LISTS patchlight_io_modules)
    string(REGEX REPLACE ">=.*" "" name ${module})
    string(APPEND PATCHLIGHT_FIND_IO "\npkg_check_modules(${name} REQUIRED IMPORTED_TARGET ${module})")
  endforeach()
  string(REPLACE "\n" "\n  " PATCHLIGHT_FIND_IO "  ${PATCHLIGHT_FIND_IO}")
endif()
configure_package_config_file(cmake/patchlightConfig.cmake.in ${PROJECT_BINARY_DIR}/patchlightConfig.cmake
                              INSTALL_DESTINATION ${patchlight_config_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/patchlightConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/patchlightConfig.cmake ${PROJECT_BINARY_DIR}/patchlightConfigVersion.cmake
        DESTINATION ${patchlight_config_folder} COMPONENT library)
foreach(package_of_component patchlight:tool libpatchlight-dev:library patchlight-doc:doc python3-patchlight:python)
  string(REGEX MATCH "^(.*):(.*)$" both ${package_of_component})
  set(documents ${CMAKE_INSTALL_DATADIR}/doc/${CMAKE_MATCH_1})
  if((CMAKE_MATCH_2 STREQUAL python AND NOT PATCHLIGHT_PYTHON) OR (CMAKE_MATCH_2 STREQUAL tool AND NOT PATCHLIGHT_TOOL))
    continue()
  endif()
  install(FILES LICENSE DESTINATION ${documents} RENAME copyright COMPONENT ${CMAKE_MATCH_2})
  install(FILES ${PROJECT_BINARY_DIR}/changelog.gz DESTINATION ${documents} COMPONENT ${CMAKE_MATCH_2})
endforeach()

# The site if scripts/docs.sh has built it before CMake ran, else the pages in Markdown.
set(patchlight_documents ${CMAKE_INSTALL_DATADIR}/doc/patchlight-doc)
if(EXISTS ${PROJECT_BINARY_DIR}/docs/html/index.html)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/docs/html DESTINATION ${patchlight_documents} COMPONENT doc PATTERN .buildinfo EXCLUDE)
  # Sphinx brings its scripts along.
  file(WRITE ${PROJECT_BINARY_DIR}/doc.lintian-overrides "patchlight-doc: embedded-javascript-library\n")
  install(FILES ${PROJECT_BINARY_DIR}/doc.lintian-overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
          RENAME patchlight-doc COMPONENT doc)
else()
  install(DIRECTORY docs/ DESTINATION ${patchlight_documents}/markdown COMPONENT doc
          FILES_MATCHING PATTERN *.md PATTERN *.ipynb PATTERN *.bib PATTERN *.png PATTERN *.svg)
endif()
# The models and the script for ParaView that the pages name.
install(DIRECTORY meshes DESTINATION ${patchlight_documents}/examples COMPONENT doc)
install(FILES scripts/paraview_view.py DESTINATION ${patchlight_documents}/examples/scripts COMPONENT doc)

if(PATCHLIGHT_PYTHON)
  set(patchlight_python_destination lib/python3/dist-packages/patchlight)
  install(TARGETS patchlight_python LIBRARY DESTINATION ${patchlight_python_destination} COMPONENT python)
  install(DIRECTORY src/python/patchlight/ DESTINATION ${patchlight_python_destination} COMPONENT python FILES_MATCHING PATTERN *.py)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL library doc)
if(PATCHLIGHT_TOOL)
  list(PREPEND CPACK_COMPONENTS_ALL tool)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_TOOL_PACKAGE_NAME patchlight)
set(CPACK_DEBIAN_TOOL_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TOOL_DESCRIPTION "Lighting simulation for rooms and buildings
The tool reads a model and computes the light of lamps, luminaires, sun
and sky on all surfaces by finite-element radiosity. Every value has an
error bar. Results are tables, images, HTML pages, lightmaps, maps of
sensors, and files for ParaView.")
set(CPACK_DEBIAN_TOOL_PACKAGE_RECOMMENDS "nodejs (>= 18)")  # reads IFC files
set(CPACK_DEBIAN_TOOL_PACKAGE_SHLIBDEPS ON)  # the libraries that the tool is linked with
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libpatchlight-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS "patchlight")  # has the reader of IFC
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "Lighting simulation - C++ library
Static library, headers and CMake files: scenes, form factors, solvers,
error bars, readers, writers and images.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "libeigen3-dev, libembree-dev, libopenmesh-dev, libgeos-dev, libtbb-dev, libboost-dev")
if(PATCHLIGHT_IO)
  string(APPEND CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS
         ", libtinyobjloader-dev, libassimp-dev, libtinygltf-dev, libstb-dev, libtomlplusplus-dev, nlohmann-json3-dev, libpugixml-dev, libdraco-dev, libmeshoptimizer-dev, libssl-dev, zlib1g-dev, libcairo2-dev, libopenexr-dev, pkg-config, libvtk9-dev")
endif()
set(CPACK_DEBIAN_DOC_PACKAGE_NAME patchlight-doc)
set(CPACK_DEBIAN_DOC_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOC_PACKAGE_RECOMMENDS "libjs-mathjax")  # typesets the formulas of the pages
set(CPACK_DEBIAN_DOC_DESCRIPTION "Lighting simulation - documentation
Tutorials, guides, concepts, the reference of commands and formats, the
theory, benchmarks, and the sample models that the pages use.")
if(PATCHLIGHT_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-patchlight)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "Lighting simulation - Python module
Reads, changes and solves scenes. Solutions are NumPy arrays, form factors
a SciPy operator. Writes reports, images and HTML pages.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11), python3 (<< 3.12), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-scipy, patchlight")  # the latter has the reader of IFC
endif()
include(CPack)
