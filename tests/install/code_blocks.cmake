# write_code_blocks(document prefix): writes every C++ block of a document as programs prefix_0.cpp,
# prefix_1.cpp ... A block with a `main` is a program. A block without one is the body of a function
# that has a scene, one of its meshes, rays, hits and the mesh's arrays; these form one program,
# prefix_bodies.cpp.
set(parameters "Scene& scene, MeshId mesh, const std::vector<Ray>& rays, std::vector<Hit>& hits,
          const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles")
set(before "
#include <raysheaf/hit_points.h>
#include <raysheaf/points.h>
#include <raysheaf/query.h>
#include <cstdio>
#include <vector>
using namespace raysheaf;
using Block = void(${parameters});
void run(Block* block) {
  const std::vector<Vec3> positions{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  const std::vector<Triangle> triangles{{0, 1, 2}};
  Scene scene;
  const MeshId mesh = scene.add(positions, triangles);
  scene.commit();
  const std::vector<Ray> rays{{{0.25f, 0.25f, 0}, 0, {0, 0, 1}}};
  std::vector<Hit> hits(rays.size());
  block(scene, mesh, rays, hits, positions, triangles);
}
")
function(write_code_blocks document prefix)
  file(READ ${document} text)
  set(number 0)
  set(bodies "")
  set(calls "")
  while(TRUE)
    string(FIND "${text}" "```cpp\n" start)
    if(start EQUAL -1)
      break()
    endif()
    math(EXPR start "${start} + 7")
    string(SUBSTRING "${text}" ${start} -1 text)
    string(FIND "${text}" "\n```" length)
    string(SUBSTRING "${text}" 0 ${length} block)
    string(SUBSTRING "${text}" ${length} -1 text)
    if(block MATCHES "int main")
      file(WRITE ${prefix}_${number}.cpp "${block}\n")
    else()
      string(APPEND bodies "void block_${number}(${parameters}) {\n"
        "(void)scene, (void)mesh, (void)rays, (void)hits, (void)positions, (void)triangles;\n${block}\n}\n")
      string(APPEND calls "  run(block_${number});\n")
    endif()
    math(EXPR number "${number} + 1")
  endwhile()
  if(number EQUAL 0)
    message(FATAL_ERROR "${document} shows no C++")
  endif()
  if(bodies)
    file(WRITE ${prefix}_bodies.cpp "${before}${bodies}int main() {\n${calls}}\n")
  endif()
endfunction()
