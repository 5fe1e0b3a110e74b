# `cpack -G DEB` (or TGZ): two packages, one for running the program and one for building programs.
set(CPACK_PACKAGE_NAME raysheaf)
set(CPACK_PACKAGE_VENDOR "raysheaf")
set(CPACK_PACKAGE_CONTACT "raysheaf developers <developers@raysheaf.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "ray tracing through moving geometry")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR TGZ)
set(CPACK_COMPONENTS_ALL runtime development)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_ARCHIVE_COMPONENT_INSTALL ON)

set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
if(CMAKE_CROSSCOMPILING AND CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
endif()
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME raysheaf)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_RUNTIME_DESCRIPTION "Answers batches of rays against triangles that may change completely
 between two batches, exactly, and renders scenes that move.")

# OpenGL is loaded if available; this is Mesa's, which renders on the CPU without a driver.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS "libegl1, libopengl0, libgl1, libegl-mesa0, libgl1-mesa-dri")

# Programs that link the static library also link its dependencies.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libraysheaf-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "Closest, any and all hits of batches of rays against triangles that may
 change between any two of them: headers, library, CMake and pkg-config
 files.")
if(NOT BUILD_SHARED_LIBS)
  set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libtbb-dev, libhwy-dev, libepoxy-dev, libopenexr-dev, libpng-dev, libjpeg-dev, nlohmann-json3-dev, libzstd-dev, libdeflate-dev, libwebp-dev, libmeshoptimizer-dev, libdraco-dev, pkg-config")
else()
  set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "raysheaf (= ${PROJECT_VERSION})")
endif()

# Files that Debian requires in every package: copyright and changelog.
find_program(GZIP gzip)
if(GZIP AND UNIX AND NOT APPLE)
  # The changelog's date is SOURCE_DATE_EPOCH, which tools/release sets, or else that of CHANGELOG.md.
  set(date_format "%a, %d %b %Y %H:%M:%S +0000")
  if(DEFINED ENV{SOURCE_DATE_EPOCH})
    string(TIMESTAMP changelog_date "${date_format}" UTC)
  else()
    file(TIMESTAMP ${PROJECT_SOURCE_DIR}/CHANGELOG.md changelog_date "${date_format}" UTC)
  endif()
  configure_file(packaging/debian/changelog.in ${PROJECT_BINARY_DIR}/changelog @ONLY)
  set(changelog ${PROJECT_BINARY_DIR}/changelog.gz)
  add_custom_command(OUTPUT ${changelog}
    COMMAND ${GZIP} -9nc ${PROJECT_BINARY_DIR}/changelog > ${changelog}
    DEPENDS ${PROJECT_BINARY_DIR}/changelog VERBATIM)
  add_custom_target(raysheaf_changelog ALL DEPENDS ${changelog})
  foreach(pair "runtime=raysheaf" "development=libraysheaf-dev")
    string(REPLACE "=" ";" pair ${pair})
    list(GET pair 0 component)
    list(GET pair 1 name)
    install(FILES packaging/debian/copyright ${changelog}
      DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
  endforeach()
endif()

include(CPack)
