# raysheaf_part(NAME SOURCE...): the library raysheaf::NAME next to raysheaf, whose internals it uses.
function(raysheaf_part name)
  add_library(raysheaf_${name} ${ARGN})
  add_library(raysheaf::${name} ALIAS raysheaf_${name})
  set_target_properties(raysheaf_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(raysheaf_${name}
    PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
    PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src)
endfunction()

# raysheaf_cuda_sources(TARGET SOURCE...): compiles CUDA sources separately, so that the library itself
# contains only C++: programs that link it do not need nvcc.
function(raysheaf_cuda_sources target)
  find_package(CUDAToolkit REQUIRED)
  add_library(${target}_cuda OBJECT ${ARGN})
  target_include_directories(${target}_cuda PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src
    ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/render/include ${PROJECT_BINARY_DIR}/include)
  target_link_libraries(${target}_cuda PRIVATE raysheaf_options)
  target_sources(${target} PRIVATE $<TARGET_OBJECTS:${target}_cuda>)
  target_link_libraries(${target} PRIVATE CUDA::cudart_static)
endfunction()
