# raysheaf_unity(TARGET [ALONE REGEX...]): its sources are compiled eight at a time, so that the headers
# they share are read once: a build from nothing takes half as long. Sources include what they use all the
# same: tools/tidy compiles each by itself. Those that match a REGEX stand alone; so do those that Highway
# compiles once an instruction set (*_simd.cpp). What not every build has must stand alone, or come last: the
# others then meet in the same eights everywhere, and names that collide there collide here.
option(RAYSHEAF_UNITY "Compile sources several at a time" ${PROJECT_IS_TOP_LEVEL})

# Of the library's sources, wherever they are compiled.
set(RAYSHEAF_ALONE "/(area_tree_cpu|bvh_cpu|image_decode|image_encode|no_cuda)\\.cpp$")

function(raysheaf_unity target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" ALONE)
  if(NOT RAYSHEAF_UNITY)
    return()
  endif()
  list(APPEND arg_ALONE "_simd\\.cpp$" "${RAYSHEAF_ALONE}")
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  # Types of an anonymous namespace are in the main file of the sources one by one.
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)
  list(JOIN arg_ALONE "|" regex)
  get_target_property(alone ${target} SOURCES)
  list(FILTER alone INCLUDE REGEX "${regex}")
  set_source_files_properties(${alone} TARGET_DIRECTORY ${target} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
