# CPack: a Debian package of the program with shared libraries, and a portable archive of the one that holds them. `./run package`
# makes both.
if(source_version MATCHES "^v[0-9.]+(-dirty)?$" OR source_version STREQUAL "")
  set(package_version ${PROJECT_VERSION})
elseif(source_version MATCHES "^v[0-9.]+-([0-9]+)-(g[0-9a-f]+)")
  set(package_version ${PROJECT_VERSION}+${CMAKE_MATCH_1}.${CMAKE_MATCH_2})
else()
  string(REPLACE "-dirty" "" package_version ${PROJECT_VERSION}~${source_version})  # before the first tag: older than it
endif()
set(CPACK_PACKAGE_NAME candela)
set(CPACK_PACKAGE_VERSION ${package_version})
set(CPACK_PACKAGE_VENDOR "The candela authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "headless renderer and benchmark of glTF scenes")
set(CPACK_PACKAGE_DESCRIPTION "Renders frame N of a glTF scene without a window, on any Vulkan 1.3 device or on the processor,
to EXR and PNG, and tells what every pass cost. Films, thousands of lights,
a path-traced reference, image comparison and goldens for CI.")
set(CPACK_RESOURCE_FILE_LICENSE ${CMAKE_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_SOURCE_DIR}/cmake/package_options.cmake)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "The candela authors <candela@localhost>")
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_ARCHIVE_COMPONENT_INSTALL ON)
set(CPACK_ARCHIVE_FILE_NAME candela-${package_version}-linux-${CMAKE_SYSTEM_PROCESSOR})
set(CPACK_PACKAGE_FILE_NAME ${CPACK_ARCHIVE_FILE_NAME})
set(CPACK_THREADS 0)
# Read by package_options.cmake.
set(CPACK_CANDELA_BUILD_FOLDER ${CMAKE_BINARY_DIR})
include(CPack)
