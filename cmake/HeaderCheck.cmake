# Checks that every header compiles by itself: one source file per header includes it twice and
# nothing else. Public headers are compiled without precompiled headers; for the others the standard
# library's are precompiled, which halves the time of the check. Highway's `-inl.h` files are left
# out, because they are compiled once per target by design.
file(GLOB_RECURSE headers RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/include/*.h ${PROJECT_SOURCE_DIR}/src/*.h ${PROJECT_SOURCE_DIR}/render/*.h ${PROJECT_SOURCE_DIR}/io/*.h
  ${PROJECT_SOURCE_DIR}/paper/*.h ${PROJECT_SOURCE_DIR}/emulated/*.h ${PROJECT_SOURCE_DIR}/lab/*.h ${PROJECT_SOURCE_DIR}/scenes/*.h
  ${PROJECT_SOURCE_DIR}/apps/*.h)
if(NOT RAYSHEAF_HAS_VIEWER)
  list(FILTER headers EXCLUDE REGEX "apps/viewer/theme\\.h$")  # it includes Dear ImGui
endif()
if(RAYSHEAF_HAS_PYTHON)
  file(GLOB python_headers RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS
    ${PROJECT_SOURCE_DIR}/python/src/*.h)
  list(APPEND headers ${python_headers})
endif()
list(FILTER headers EXCLUDE REGEX "-inl\\.h$|/exec/cuda/cuda_(device_templates|launch|memory)\\.h$")
set(header_sources "")
set(public_sources "")
foreach(header ${headers})
  string(REPLACE "/" "__" name ${header})
  set(source ${PROJECT_BINARY_DIR}/headers/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "#include \"${header}\"\n#include \"${header}\"\n")
  if(header MATCHES "^((lab|paper|render|scenes)/)?include/")
    list(APPEND public_sources ${source})
  else()
    list(APPEND header_sources ${source})
  endif()
endforeach()
function(check_headers name)
  add_library(${name} OBJECT ${ARGN})
  target_include_directories(${name} PRIVATE
    ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/apps/raysheaf
    ${PROJECT_SOURCE_DIR}/apps/viewer ${STB_HEADER_DIR})
  target_compile_options(${name} PRIVATE -O0 -g0 -Wno-unused-function)
  target_link_libraries(${name} PRIVATE
    raysheaf_render raysheaf_paper raysheaf_lab raysheaf_scenes raysheaf_options TBB::tbb hwy::hwy
    PkgConfig::EPOXY nlohmann_json::nlohmann_json)
endfunction()
check_headers(raysheaf_public_headers ${public_sources})
check_headers(raysheaf_headers ${header_sources})
# Only headers that most files include: precompiled headers take time to load, too.
target_precompile_headers(raysheaf_headers PRIVATE
  <array> <cmath> <cstdint> <cstring> <functional> <memory> <optional> <span> <string> <vector>)
if(RAYSHEAF_HAS_PYTHON)
  target_include_directories(raysheaf_headers SYSTEM PRIVATE ${NB_DIR}/include ${Python_INCLUDE_DIRS})
endif()
if(RAYSHEAF_HAS_VIEWER)
  target_link_libraries(raysheaf_headers PRIVATE PkgConfig::IMGUI)
endif()
