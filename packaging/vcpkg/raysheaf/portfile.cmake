# An overlay port of the checkout that contains it: `vcpkg install raysheaf
# --overlay-ports=packaging/vcpkg`.
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

vcpkg_check_features(OUT_FEATURE_OPTIONS features FEATURES tools RAYSHEAF_APP)
vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS ${features} -DRAYSHEAF_TESTS=OFF -DRAYSHEAF_BENCH=OFF -DRAYSHEAF_EXAMPLES=OFF
          -DRAYSHEAF_VIEWER=OFF -DRAYSHEAF_CUDA=OFF -DRAYSHEAF_MPI=OFF -DRAYSHEAF_PYTHON=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/raysheaf)
vcpkg_fixup_pkgconfig()
if("tools" IN_LIST FEATURES)
  vcpkg_copy_tools(TOOL_NAMES raysheaf AUTO_CLEAN)
endif()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
