# cmake -DWORK_DIR=... -DLIBDIR=... -DPKG_CONFIG=... -DCXX=... -DCXX_FLAGS=... -P pkg_config.cmake
# Builds the consumer without CMake, with the flags of pkg-config for WORK_DIR/prefix, and runs it.
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
