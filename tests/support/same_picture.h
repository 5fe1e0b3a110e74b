// Compares two images.
#pragma once

#include <gtest/gtest.h>

#include "raysheaf/render.h"
#include "support/pictures.h"

namespace raysheaf::test {

/// Compares all layers bit for bit, but not the statistics.
inline void expect_same_picture(const RenderResult& there, const RenderResult& here) {
  EXPECT_EQ(there.width, here.width);
  EXPECT_EQ(there.height, here.height);
  EXPECT_EQ(there.samples, here.samples);
  EXPECT_TRUE(same_bits(there.beauty, here.beauty));
  EXPECT_TRUE(same_bits(there.position, here.position));
  EXPECT_TRUE(same_bits(there.normal, here.normal));
  EXPECT_TRUE(same_bits(there.albedo, here.albedo));
  EXPECT_TRUE(same_bits(there.specular, here.specular));
  EXPECT_EQ(there.shadow, here.shadow);
  EXPECT_EQ(there.exposure, here.exposure);
  EXPECT_TRUE(same_bits({there.ambient}, {here.ambient}));
  ASSERT_EQ(there.ids.size(), here.ids.size());
  for (std::size_t i = 0; i < here.ids.size(); ++i) {
    ASSERT_EQ(there.ids[i].geom_id, here.ids[i].geom_id) << i;
    ASSERT_EQ(there.ids[i].inst_id, here.ids[i].inst_id) << i;
    ASSERT_EQ(there.ids[i].prim_id, here.ids[i].prim_id) << i;
  }
}

}  // namespace raysheaf::test
