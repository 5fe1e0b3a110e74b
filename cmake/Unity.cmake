# raysheaf_unity(TARGET [ALONE REGEX...]): its sources are compiled some sixteen at a time, in order, so
# that the headers they share are read once: a build from nothing takes half as long. Sources include what
# they use all the same: tools/tidy compiles each by itself. Those that match a REGEX stand alone; so do
# those that Highway compiles once an instruction set (*_simd.cpp). What not every build has must stand
# alone.
option(RAYSHEAF_UNITY "Compile sources several at a time" ${PROJECT_IS_TOP_LEVEL})

# Of the library's sources, wherever they are compiled.
set(RAYSHEAF_ALONE "/(area_tree_cpu|bvh_cpu|gltf_draco|gltf_meshopt|image_decode|image_encode|no_cuda|webp_decode)\\.cpp$")

function(raysheaf_unity target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" ALONE)
  if(NOT RAYSHEAF_UNITY)
    return()
  endif()
  list(APPEND arg_ALONE "_simd\\.cpp$" "${RAYSHEAF_ALONE}")
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # Types of an anonymous namespace are in the main file of the sources one by one.
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)
  list(JOIN arg_ALONE "|" alone)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  list(FILTER sources EXCLUDE REGEX "${alone}")
  list(LENGTH sources count)
  math(EXPR groups "(${count} + 15) / 16")
  set(number 0)
  foreach(source IN LISTS sources)
    math(EXPR group "${number} * ${groups} / ${count}")
    set_source_files_properties("${source}" TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${group})
    math(EXPR number "${number} + 1")
  endforeach()
endfunction()
