# Tests that CMake and pkg-config find the installed library and can use it.
set(install_arguments -DSOURCE_DIR=${PROJECT_SOURCE_DIR} -DBUILD_DIR=${PROJECT_BINARY_DIR}
  -DWORK_DIR=${PROJECT_BINARY_DIR}/install_test -DLIBDIR=${CMAKE_INSTALL_LIBDIR}
  -DLAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER} -DPKG_CONFIG=${PKG_CONFIG_EXECUTABLE} -DCXX=${CMAKE_CXX_COMPILER} "-DCXX_FLAGS=${CMAKE_CXX_FLAGS}")
if(RAYSHEAF_LONG_TESTS)
  foreach(name prefix find_package pkg_config)
    add_test(NAME install/${name} COMMAND ${CMAKE_COMMAND} ${install_arguments}
      -P ${CMAKE_CURRENT_LIST_DIR}/${name}.cmake)
    set_tests_properties(install/${name} PROPERTIES FIXTURES_REQUIRED installed TIMEOUT 300 LABELS long)
  endforeach()
  set_tests_properties(install/prefix PROPERTIES FIXTURES_REQUIRED "" FIXTURES_SETUP installed)
  add_test(NAME install/shared COMMAND ${CMAKE_COMMAND} ${install_arguments}
    -P ${CMAKE_CURRENT_LIST_DIR}/shared.cmake)
  set_tests_properties(install/shared PROPERTIES SKIP_REGULAR_EXPRESSION "SKIPPED" TIMEOUT 3600 LABELS long)
endif()

# Tests the guards of cmake/Hardening.cmake: always in a small program, and in raysheaf if it is
# built with them.
find_program(READELF readelf)
find_program(OBJDUMP objdump)
if(READELF AND OBJDUMP AND UNIX AND NOT APPLE AND NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  add_executable(hardening_probe ${CMAKE_CURRENT_LIST_DIR}/hardening_probe.cpp)
  target_link_libraries(hardening_probe PRIVATE raysheaf_options raysheaf_hardening)
  set(hardened hardening_probe)
  if(RAYSHEAF_HARDENING AND TARGET raysheaf_app)
    list(APPEND hardened ${RAYSHEAF_PROGRAMS})
  endif()
  foreach(program ${hardened})
    add_test(NAME install/hardening_of_${program} COMMAND ${CMAKE_COMMAND}
      -DPROGRAM=$<TARGET_FILE:${program}> -DREADELF=${READELF} -DOBJDUMP=${OBJDUMP} -DPROCESSOR=${CMAKE_SYSTEM_PROCESSOR}
      -P ${CMAKE_CURRENT_LIST_DIR}/hardening.cmake)
  endforeach()
endif()

# Linking to no library of a window system, `raysheaf` runs without one; and queries need no OpenGL.
if(READELF AND TARGET raysheaf_app)
  add_test(NAME install/raysheaf_needs_no_window COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:raysheaf_app>
    "-DLIBRARIES=glfw|X11|xcb|wayland" -DREADELF=${READELF} -P ${CMAKE_CURRENT_LIST_DIR}/needs_no.cmake)
endif()
if(READELF AND RAYSHEAF_EXAMPLES)
  add_test(NAME install/queries_need_no_opengl COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:example_01_closest_hit>
    "-DLIBRARIES=epoxy|libGL|libEGL|raysheaf_render" -DREADELF=${READELF}
    -P ${CMAKE_CURRENT_LIST_DIR}/needs_no.cmake)
endif()

# The archive of tools/gpu for a bare machine runs in an empty root.
if(RAYSHEAF_HAS_CUDA AND TARGET raysheaf_app AND NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  add_test(NAME install/gpu_pack COMMAND ${CMAKE_CURRENT_LIST_DIR}/gpu_pack
    ${PROJECT_BINARY_DIR} ${PROJECT_BINARY_DIR}/gpu_pack_test)
  set_tests_properties(install/gpu_pack PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 300)
endif()

# Tests what tools/release refuses and the dates of packages, in a small checkout, and how tools/gpu
# --static parses the compiler's output, with a made-up text.
find_program(PYTHON3 python3)
if(PYTHON3)
  add_test(NAME install/release COMMAND ${PYTHON3} ${CMAKE_CURRENT_LIST_DIR}/release_files.py ${CMAKE_COMMAND})
  set_tests_properties(install/release PROPERTIES TIMEOUT 60)
  add_test(NAME install/gpu_static COMMAND ${PYTHON3} ${CMAKE_CURRENT_LIST_DIR}/gpu_static.py)
  set_tests_properties(install/gpu_static PROPERTIES TIMEOUT 60)
endif()
