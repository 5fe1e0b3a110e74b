// Tests one node of the ray hierarchy with many triangles: the SIMD kernels of the traversal.
//
// A triangle is given by its sphere (four arrays: centre x, y, z, radius), by its corners (nine:
// corner 0 x, y, z, corner 1 x, ...), or by both (corners, then sphere), depending on the test.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "paper/ray_hierarchy/cone_sphere_body.h"
#include "paper/ray_hierarchy/finite_cone_body.h"
#include "paper/ray_hierarchy/frustum_box_body.h"

namespace raysheaf {

inline constexpr std::size_t kBallFields = 4;
inline constexpr std::size_t kCornerFields = 9;

template <std::size_t kFields>
using FieldPointers = std::array<const float*, kFields>;

/// Both must accept the triangle.
struct ShaftConeTest {
  BeamTest shaft;
  FiniteConeTest cone;
};

/// Write the numbers (from 0) of the triangles that `meets` accepts, ascending, and return how many
/// there are. `out` needs room for `count` rounded up to 16. The same answers on every SIMD target.
std::uint32_t filter(const ConeSphereTest& node, const FieldPointers<kBallFields>& fields,
                     std::uint32_t count, std::uint32_t* out);
std::uint32_t filter(const FiniteConeTest& node, const FieldPointers<kBallFields>& fields,
                     std::uint32_t count, std::uint32_t* out);
std::uint32_t filter(const BeamTest& node, const FieldPointers<kCornerFields>& fields,
                     std::uint32_t count, std::uint32_t* out);
std::uint32_t filter(const FrustumTest& node, const FieldPointers<kCornerFields>& fields,
                     std::uint32_t count, std::uint32_t* out);
std::uint32_t filter(const ShaftConeTest& node,
                     const FieldPointers<kCornerFields + kBallFields>& fields, std::uint32_t count,
                     std::uint32_t* out);

/// out[i] = from[index[i]].
void gather_floats(const float* from, const std::uint32_t* index, std::uint32_t count, float* out);

}  // namespace raysheaf
