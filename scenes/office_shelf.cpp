#include <array>

#include "scenes/office.h"
#include "scenes/shapes.h"

namespace raysheaf::builtin {
namespace {

constexpr float kShelfWidth = 1.2f, kShelfHeight = 2.1f, kShelfDepth = 0.3f, kShelfBoard = 0.022f;
constexpr int kShelves = 5;
constexpr float kShelfPitch = (kShelfHeight - 0.1f - kShelfBoard) / kShelves;

struct Binding {
  std::uint32_t cover, bands;
};

constexpr std::array<Binding, 8> kBindings = {{{0x8e2b2a, 0xd9b25c},
                                               {0x234e70, 0xe8e2d0},
                                               {0x2f6b4f, 0xd9b25c},
                                               {0xd9a441, 0x5a3a1e},
                                               {0xe7dcc4, 0x8e2b2a},
                                               {0x51355c, 0xc7b6d6},
                                               {0xc8602f, 0xf0e0c0},
                                               {0x2b2d33, 0xb9bcc2}}};

/// Seen from above with the book's back downwards, counter-clockwise.
std::vector<Vec2> binding_outline() {
  std::vector<Vec2> outline = {{0.5f, 0.5f}, {-0.5f, 0.5f}};
  for (int i = 0; i <= 4; ++i) {
    const float angle = kPi * (1 + static_cast<float>(i) / 4);
    outline.push_back({0.5f * std::cos(angle), -0.42f + 0.08f * std::sin(angle)});
  }
  return outline;
}

std::uint32_t book(Stage& stage, const OfficeMaterials& m, const Binding& binding) {
  MeshBuilder builder("book");
  const auto upright = [](float y) {
    return compose(translation({0, y, 0}), rotation({1, 0, 0}, radians(-90)));
  };
  const auto outline = binding_outline();
  builder.use(stage.add(matte("book cover", binding.cover, 0.6f))).at(upright(0));
  add_prism(builder, outline, 1);
  builder.use(stage.add(matte("book bands", binding.bands, 0.5f)));
  for (const float y : {0.12f, 0.74f}) {
    builder.at(compose(upright(y), scaling({1.02f, 1.02f, 1})));
    add_sweep(builder, outline, {Affine{}, translation({0, 0, 0.07f})}, Ends::kOpen);
  }
  builder.use(m.paper).at(Affine{});
  add_box(builder, {-0.42f, 0.9f, -0.49f}, {0.42f, 1.003f, 0.4f});
  return stage.add(builder.take());
}

std::uint32_t carcass(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder builder("bookshelf carcass");
  builder.use(m.walnut);
  const float x = kShelfWidth / 2;
  add_rounded_box(builder, {-x - kShelfBoard, 0, 0}, {-x, kShelfHeight, kShelfDepth}, 0.003f);
  add_rounded_box(builder, {x, 0, 0}, {x + kShelfBoard, kShelfHeight, kShelfDepth}, 0.003f);
  add_box(builder, {-x, 0.03f, 0.004f}, {x, kShelfHeight - 0.01f, 0.012f});
  add_box(builder, {-x, 0, 0.25f}, {x, 0.08f, 0.265f});
  return stage.add(builder.take());
}

std::uint32_t shelf_board(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder builder("shelf board");
  builder.use(m.walnut);
  add_rounded_box(builder, {-kShelfWidth / 2 - 0.001f, 0, 0.01f},
                  {kShelfWidth / 2 + 0.001f, kShelfBoard, kShelfDepth - 0.004f}, 0.003f);
  return stage.add(builder.take());
}

Affine book_at(Vec3 foot, Vec3 size, float lean_degrees) {
  const Affine lean = rotation({0, 0, 1}, radians(lean_degrees));
  return compose(translation(foot), compose(lean, scaling(size)));
}

/// Books from the left to `until`, the last one leaning.
void fill_row(Kit& kit, Random& random, const std::vector<std::uint32_t>& books, float y,
              float from, float until) {
  float x = from;
  const float usual_height = random.uniform(0.21f, 0.29f);
  while (true) {
    const Vec3 size{random.uniform(0.02f, 0.052f), usual_height + random.uniform(-0.04f, 0.04f),
                    random.uniform(0.15f, 0.2f)};
    const bool last = x + size.x > until - 0.12f;
    const float z = kShelfDepth - 0.03f - size.z / 2 - random.uniform(0, 0.012f);
    const auto mesh = books[random.index(static_cast<std::uint32_t>(books.size()))];
    const float lean = last ? 15.0f : 0.0f;
    const float foot = x + size.x / 2 + (last ? 0.27f * size.y + 0.002f : 0);
    kit.parts.push_back(
        {mesh, book_at({foot, y + (last ? 0.13f * size.x : 0) + 0.001f, z}, size, lean)});
    if (last) return;
    x += size.x + 0.001f;
  }
}

}  // namespace

std::vector<std::uint32_t> books(Stage& stage, const OfficeMaterials& m) {
  std::vector<std::uint32_t> result;
  for (const Binding& binding : kBindings) result.push_back(book(stage, m, binding));
  return result;
}

Kit bookshelf(Stage& stage, const OfficeMaterials& m, const std::vector<std::uint32_t>& books,
              std::uint64_t seed) {
  const auto board = shelf_board(stage, m);
  Kit kit{"bookshelf", {{carcass(stage, m), {}}}};
  Random random(seed);
  for (int i = 0; i <= kShelves; ++i) {
    const float y = 0.08f + kShelfPitch * static_cast<float>(i);
    kit.parts.push_back({board, translation({0, y, 0})});
    if (i == kShelves) break;
    const float left = -kShelfWidth / 2 + 0.01f, right = kShelfWidth / 2 - 0.01f;
    fill_row(kit, random, books, y + kShelfBoard, left,
             left + random.uniform(0.6f, 1.0f) * (right - left));
  }
  return kit;
}

}  // namespace raysheaf::builtin
