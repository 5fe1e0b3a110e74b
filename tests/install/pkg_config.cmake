# cmake -DSOURCE_DIR=... -DWORK_DIR=... -DLIBDIR=... -DPKG_CONFIG=... -DCXX=... -DCXX_FLAGS=... -P pkg_config.cmake
# Builds the consumer, and an example that only asks rays, without CMake, with the flags of pkg-config
# for WORK_DIR/prefix, and runs them.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)
set(ENV{PKG_CONFIG_PATH} ${WORK_DIR}/prefix/${LIBDIR}/pkgconfig)
execute_process(COMMAND ${PKG_CONFIG} --cflags --libs raysheaf-scenes raysheaf-lab OUTPUT_VARIABLE flags
  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
separate_arguments(flags UNIX_COMMAND "${flags}")
separate_arguments(CXX_FLAGS UNIX_COMMAND "${CXX_FLAGS}")
run(${CXX} -std=c++20 ${CXX_FLAGS} ${CMAKE_CURRENT_LIST_DIR}/consumer.cpp -o ${WORK_DIR}/by_hand
  ${flags} -Wl,-rpath,${WORK_DIR}/prefix/${LIBDIR})
run(${WORK_DIR}/by_hand)
# The first example only asks rays: the library of queries is enough.
execute_process(COMMAND ${PKG_CONFIG} --cflags --libs raysheaf OUTPUT_VARIABLE flags
  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
if(flags MATCHES "epoxy|raysheaf_render")
  message(SEND_ERROR "pkg-config raysheaf: ${flags}")
endif()
separate_arguments(flags UNIX_COMMAND "${flags}")
run(${CXX} -std=c++20 ${CXX_FLAGS} ${SOURCE_DIR}/examples/01_closest_hit.cpp -o ${WORK_DIR}/rays_by_hand
  ${flags} -Wl,-rpath,${WORK_DIR}/prefix/${LIBDIR})
run(${WORK_DIR}/rays_by_hand)
