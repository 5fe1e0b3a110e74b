// Tests every point with every triangle: the reference for point queries.
#pragma once

#include "base/view.h"
#include "exec/executor.h"
#include "nearest/nearest.h"
#include "raysheaf/points.h"
#include "scene/triangle_source.h"

namespace raysheaf::brute {

/// The `k` nearest of each point; places are not set.
void nearest(const Executor& executor, const TriangleSource& source, View<const QueryPoint> points,
             std::size_t k, View<FoundTriangle> found);
/// By all six rays.
void contains(const Executor& executor, const TriangleSource& source, View<const QueryPoint> points,
              InsideRule rule, View<std::uint8_t> inside);

}  // namespace raysheaf::brute
