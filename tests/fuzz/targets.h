// What is fuzzed: bytes in, nothing out; a crash, a leak, an exception that is no `Error`, or a
// wrong answer ends the program.
//
// `tools/fuzz` runs a target under libFuzzer with sanitizers; test_fuzz runs all of them over the
// seeds, what was found before, and a few thousand changed seeds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace raysheaf::fuzz {

using Input = std::span<const std::uint8_t>;

struct Target {
  const char* name;  ///< of its folder in seeds/, too
  void (*run)(Input input);
};

/// gltf, draco, obj, mtl, ply, stl, image, hdr, blocks, options, query.
[[nodiscard]] std::span<const Target> targets();

void run_gltf(Input input);
void run_draco(Input input);  ///< four bytes of counts, then what a primitive is packed in
void run_obj(Input input);
void run_mtl(Input input);
void run_ply(Input input);
void run_stl(Input input);
void run_image(Input input);
void run_hdr(Input input);
void run_blocks(Input input);
void run_options(Input input);
void run_query(Input input);

}  // namespace raysheaf::fuzz
