# cmake -DBUILD_DIR=... -DWORK_DIR=... -P prefix.cmake
# Installs into WORK_DIR/first and moves that to WORK_DIR/prefix, because an installed tree must be
# relocatable.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)
file(REMOVE_RECURSE ${WORK_DIR})
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/first)
file(RENAME ${WORK_DIR}/first ${WORK_DIR}/prefix)
