// The fuzz targets: each takes bytes and returns nothing. A crash, a leak, an exception other than
// `Error`, or a wrong answer ends the program.
//
// `tools/fuzz` runs a target under libFuzzer with sanitizers. test_fuzz runs all of them on the
// seeds, on earlier findings, and on a few thousand mutated seeds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace raysheaf::fuzz {

using Input = std::span<const std::uint8_t>;

struct Target {
  const char* name;  ///< also the name of its folder in seeds/
  void (*run)(Input input);
};

/// The targets gltf, draco, obj, mtl, ply, stl, image, exr, hdr, blocks, options, query.
[[nodiscard]] std::span<const Target> targets();

void run_gltf(Input input);
void run_draco(Input input);  ///< four bytes of counts, then a compressed primitive
void run_obj(Input input);
void run_mtl(Input input);
void run_ply(Input input);
void run_stl(Input input);
void run_image(Input input);
void run_exr(Input input);  ///< as a texture and as an environment
void run_hdr(Input input);
void run_blocks(Input input);
void run_options(Input input);
void run_query(Input input);

}  // namespace raysheaf::fuzz
