# Finds all dependencies of raysheaf once. The comments name the Debian packages.
find_package(TBB REQUIRED CONFIG)     # libtbb-dev
find_package(hwy REQUIRED CONFIG)     # libhwy-dev
find_package(PkgConfig REQUIRED)      # pkg-config
pkg_check_modules(EPOXY REQUIRED IMPORTED_TARGET epoxy)  # libepoxy-dev

find_package(OpenEXR 3.1 REQUIRED CONFIG)    # libopenexr-dev
find_package(PNG REQUIRED)                   # libpng-dev
find_package(JPEG REQUIRED)                  # libjpeg-dev, of libjpeg-turbo
find_package(nlohmann_json REQUIRED CONFIG)  # nlohmann-json3-dev
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)      # libxxhash-dev
find_path(STB_HEADER_DIR stb_image.h PATH_SUFFIXES stb REQUIRED)  # libstb-dev

pkg_check_modules(ZSTD QUIET IMPORTED_TARGET libzstd)  # libzstd-dev
if(NOT ZSTD_FOUND)
  message(STATUS "Zstandard not found: block files are neither compressed nor read where they are")
endif()

pkg_check_modules(DEFLATE QUIET IMPORTED_TARGET libdeflate)  # libdeflate-dev
if(NOT DEFLATE_FOUND)
  message(STATUS "libdeflate not found: PNG files are compressed by stb, which takes longer")
endif()

pkg_check_modules(WEBP QUIET IMPORTED_TARGET libwebp)  # libwebp-dev
if(NOT WEBP_FOUND)
  message(STATUS "libwebp not found: textures in WebP are not read, films in WebP not written")
endif()

find_package(meshoptimizer QUIET CONFIG)  # libmeshoptimizer-dev
if(NOT meshoptimizer_FOUND)
  message(STATUS "meshoptimizer not found: glTF with EXT_meshopt_compression is not read")
endif()

find_package(draco QUIET CONFIG)  # libdraco-dev
if(NOT draco_FOUND)
  message(STATUS "Draco not found: glTF with KHR_draco_mesh_compression is not read")
endif()

if(RAYSHEAF_APP)
  find_package(CLI11 REQUIRED CONFIG)  # libcli11-dev
  find_package(fmt REQUIRED CONFIG)    # libfmt-dev
  find_path(MUSTACHE_INCLUDE_DIR kainjow/mustache.hpp REQUIRED)  # libkainjow-mustache-dev
endif()
set(RAYSHEAF_HAS_VIEWER OFF)
if(RAYSHEAF_APP AND RAYSHEAF_VIEWER)
  find_package(glfw3 3.3 QUIET CONFIG)  # libglfw3-dev
  pkg_check_modules(IMGUI QUIET IMPORTED_TARGET imgui)  # libimgui-dev, with its back ends
  if(glfw3_FOUND AND IMGUI_FOUND)
    set(RAYSHEAF_HAS_VIEWER ON)
  else()
    message(STATUS "GLFW or Dear ImGui not found: `raysheaf view` is left out")
  endif()
endif()
if(RAYSHEAF_TESTS)
  find_package(GTest REQUIRED CONFIG)  # libgtest-dev
endif()
if(RAYSHEAF_BENCH)
  find_package(benchmark CONFIG)  # libbenchmark-dev
  if(NOT benchmark_FOUND)
    message(STATUS "Google Benchmark not found: bench/ is left out")
    set(RAYSHEAF_BENCH OFF)
  endif()
endif()
