// Every ray with every triangle of a view, one after the other: what all else is checked against.
#pragma once

#include "engine/engine.h"

namespace raysheaf::brute {

/// As the queries of `Engine`.
void closest_hit(const Executor& executor, const TriangleSource& source, View<const Ray> rays,
                 View<EngineHit> hits);
void any_hit(const Executor& executor, const TriangleSource& source, View<const Ray> rays,
             View<std::uint8_t> occluded);
[[nodiscard]] EngineHitRows all_hits(const Executor& executor, const TriangleSource& source,
                                     View<const Ray> rays);

}  // namespace raysheaf::brute
