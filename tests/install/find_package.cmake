# cmake -DSOURCE_DIR=... -DWORK_DIR=... -DCXX=... -DCXX_FLAGS=... -P find_package.cmake
# Builds the consumer, and all C++ code in README.md and the pages, with the library that is
# installed in WORK_DIR/prefix, and runs them.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/code_blocks.cmake)
file(REMOVE_RECURSE ${WORK_DIR}/blocks ${WORK_DIR}/build)
write_code_blocks(${SOURCE_DIR}/README.md ${WORK_DIR}/blocks/readme)
foreach(page index get-started library cookbook)
  write_code_blocks(${SOURCE_DIR}/docs/${page}.md ${WORK_DIR}/blocks/${page})
endforeach()
write_code_blocks(${SOURCE_DIR}/docs/api/cpp.md ${WORK_DIR}/blocks/api)
run(${CMAKE_COMMAND} -G Ninja -S ${CMAKE_CURRENT_LIST_DIR} -B ${WORK_DIR}/build
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix -DBLOCKS=${WORK_DIR}/blocks
  -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${CXX_FLAGS})
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
run(${CMAKE_CTEST_COMMAND} --test-dir ${WORK_DIR}/build --output-on-failure)
