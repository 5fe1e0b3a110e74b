# `cmake --install`: headers, library, command line, and the files for CMake and pkg-config. If the
# library is static, programs also link its private libraries, so the package file finds all of
# them.
include(CMakePackageConfigHelpers)

# Shared and static libraries have the same object files.
set(libraries raysheaf raysheaf_render raysheaf_paper raysheaf_scenes raysheaf_lab)
set_target_properties(${libraries} PROPERTIES DEFINE_SYMBOL "")
# Shared libraries of one minor version are interchangeable, and the program finds its library.
set_target_properties(${libraries} PROPERTIES
  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
if(TARGET raysheaf_app AND BUILD_SHARED_LIBS)
  file(RELATIVE_PATH lib_from_bin /p/${CMAKE_INSTALL_BINDIR} /p/${CMAKE_INSTALL_LIBDIR})
  set_target_properties(${RAYSHEAF_PROGRAMS} PROPERTIES INSTALL_RPATH "$ORIGIN/${lib_from_bin}")
endif()

# Two components: `runtime` for running programs, `development` for building them.
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/raysheaf)
install(TARGETS ${libraries} EXPORT raysheafTargets
  ARCHIVE COMPONENT development
  LIBRARY COMPONENT runtime NAMELINK_COMPONENT development)
install(DIRECTORY include/raysheaf lab/include/raysheaf paper/include/raysheaf render/include/raysheaf scenes/include/raysheaf
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development FILES_MATCHING PATTERN "*.h")
install(FILES ${PROJECT_BINARY_DIR}/include/raysheaf/version.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/raysheaf COMPONENT development)
install(EXPORT raysheafTargets NAMESPACE raysheaf:: DESTINATION ${package_dir}
  COMPONENT development)
if(TARGET raysheaf_app)
  install(TARGETS ${RAYSHEAF_PROGRAMS} COMPONENT runtime)
endif()
# The target that find_package provides for COMPONENTS mpi.
if(RAYSHEAF_HAS_MPI)
  set_target_properties(raysheaf_mpi PROPERTIES
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  install(TARGETS raysheaf_mpi EXPORT raysheafMpiTargets
    ARCHIVE COMPONENT development
    LIBRARY COMPONENT runtime NAMELINK_COMPONENT development)
  install(EXPORT raysheafMpiTargets NAMESPACE raysheaf:: DESTINATION ${package_dir}
    COMPONENT development)
endif()

configure_package_config_file(cmake/raysheafConfig.cmake.in ${PROJECT_BINARY_DIR}/raysheafConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/raysheafConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/raysheafConfig.cmake ${PROJECT_BINARY_DIR}/raysheafConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT development)

# The path from the .pc file to the prefix, so that an installed tree can be moved.
file(RELATIVE_PATH up_to_prefix /p/${CMAKE_INSTALL_LIBDIR}/pkgconfig /p)
# Programs that link a static library must also link its dependencies.
if(BUILD_SHARED_LIBS)
  set(pc_requires "")
  set(pc_libs "")
else()
  set(pc_requires "tbb libhwy-contrib libhwy OpenEXR libpng libjpeg")
  if(ZSTD_FOUND)
    string(APPEND pc_requires " libzstd")
  endif()
  if(DEFLATE_FOUND)
    string(APPEND pc_requires " libdeflate")
  endif()
  if(WEBP_FOUND)
    string(APPEND pc_requires " libwebp")
  endif()
  set(pc_libs "-lstdc++ -lm")
  if(meshoptimizer_FOUND)
    string(PREPEND pc_libs "-lmeshoptimizer ")
  endif()
  if(draco_FOUND)
    string(PREPEND pc_libs "-ldraco ")
  endif()
  if(RAYSHEAF_HAS_CUDA)
    find_package(CUDAToolkit REQUIRED)
    string(APPEND pc_libs " -L${CUDAToolkit_LIBRARY_DIR} -lcudart_static -lrt -lpthread -ldl")
  endif()
endif()
configure_file(cmake/raysheaf.pc.in ${PROJECT_BINARY_DIR}/raysheaf.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/raysheaf.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
  COMPONENT development)
# The libraries next to it.
set(render_text "The renderer of raysheaf")
set(render_requires raysheaf)
if(NOT BUILD_SHARED_LIBS)
  string(APPEND render_requires " epoxy")
endif()
set(paper_text "The methods rah, crsh and gl10 of raysheaf's renderer")
set(paper_requires raysheaf-render)
set(scenes_text "The built-in scenes of raysheaf")
set(scenes_requires raysheaf)
set(lab_text "The laboratory of raysheaf, and the checks of its promises")
set(lab_requires raysheaf-paper)
foreach(part render paper scenes lab)
  set(part_description "${${part}_text}")
  set(part_requires ${${part}_requires})
  configure_file(cmake/raysheaf-part.pc.in ${PROJECT_BINARY_DIR}/raysheaf-${part}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/raysheaf-${part}.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endforeach()
