# cmake -DSOURCE_DIR=... -DBUILD_DIR=... -DWORK_DIR=... ... -P shared.cmake
# Builds, installs and uses the shared library. It takes minutes, so only the long tests run it.
cmake_minimum_required(VERSION 3.25)
if(NOT "$ENV{RAYSHEAF_LONG}")
  message("SKIPPED: RAYSHEAF_LONG=1 runs it")
  return()
endif()
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)
set(shared_dir ${BUILD_DIR}/shared_test)
run(${CMAKE_COMMAND} -G Ninja -S ${SOURCE_DIR} -B ${shared_dir} -DBUILD_SHARED_LIBS=ON
  -DCMAKE_BUILD_TYPE=Release -DRAYSHEAF_TESTS=OFF -DRAYSHEAF_BENCH=OFF -DRAYSHEAF_CUDA=OFF -DRAYSHEAF_MPI=OFF -DRAYSHEAF_PYTHON=OFF
  -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_CXX_FLAGS=${CXX_FLAGS})
run(${CMAKE_COMMAND} --build ${shared_dir})
set(BUILD_DIR ${shared_dir})
set(WORK_DIR ${shared_dir}/install_test)
foreach(step prefix find_package pkg_config)
  include(${CMAKE_CURRENT_LIST_DIR}/${step}.cmake)
endforeach()
run(${WORK_DIR}/prefix/bin/raysheaf info builtin:cornell)
