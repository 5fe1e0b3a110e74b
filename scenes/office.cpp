// An office on a sunny morning: the positions of its furniture.
#include "scenes/office.h"

#include "scenes/scenes.h"
#include "scenes/shapes.h"

namespace raysheaf::builtin {
namespace {

constexpr float kDeskTop = 0.75f;

/// Furniture that is used several times and made once.
struct Furniture {
  Kit desk, monitor, keyboard, blue_chair, orange_chair, lamp, white_mug, red_mug, pens, papers;
  Kit plant, tall_plant, bin, ball, drop;
};

Furniture make_furniture(Stage& stage, const OfficeMaterials& m) {
  return {.desk = desk(stage, m),
          .monitor = monitor(stage, m),
          .keyboard = keyboard_and_mouse(stage, m),
          .blue_chair = chair(stage, m, m.blue_fabric),
          .orange_chair = chair(stage, m, m.orange_fabric),
          .lamp = desk_lamp(stage, m),
          .white_mug = mug(stage, m, m.porcelain),
          .red_mug = mug(stage, m, m.red_glaze),
          .pens = pen_cup(stage, m),
          .papers = paper_stack(stage, m),
          .plant = small_plant(stage, m),
          .tall_plant = tall_plant(stage, m),
          .bin = waste_bin(stage, m),
          .ball = glass_ball(stage, m),
          .drop = glass_drop(stage, m)};
}

/// Places things in the frame of a desk or of the room.
class Place {
 public:
  Place(Stage& stage, const Affine& frame) : stage_(stage), frame_(frame) {}
  void put(const Kit& kit, Vec3 position, float degrees = 0) {
    stage_.place(kit, compose(frame_, placed(position, degrees)));
  }

 private:
  Stage& stage_;
  Affine frame_;
};

/// Two desks back to back on the rug.
void furnish_middle(Stage& stage, const Furniture& f) {
  Place front(stage, placed({-0.75f, 0, -1.35f}));
  front.put(f.desk, {0, 0, 0});
  front.put(f.monitor, {-0.05f, kDeskTop, -0.2f}, 6);
  front.put(f.keyboard, {-0.05f, kDeskTop, 0.14f}, 3);
  front.put(f.lamp, {-0.62f, kDeskTop, -0.2f}, -20);
  front.put(f.white_mug, {0.5f, kDeskTop, 0.1f}, 40);
  front.put(f.papers, {0.52f, kDeskTop, -0.15f}, 20);
  front.put(f.orange_chair, {0.05f, 0, 0.72f}, 152);

  Place rear(stage, placed({-0.75f, 0, -2.17f}, 180));
  rear.put(f.desk, {0, 0, 0});
  rear.put(f.monitor, {0.1f, kDeskTop, -0.15f}, -5);
  rear.put(f.keyboard, {0.1f, kDeskTop, 0.16f});
  rear.put(f.pens, {-0.5f, kDeskTop, -0.2f});
  rear.put(f.plant, {-0.62f, kDeskTop, -0.24f}, 60);
  rear.put(f.blue_chair, {0.1f, 0, 0.75f}, 200);
}

/// The desk next to the camera, with the glass on it.
void furnish_foreground(Stage& stage, const Furniture& f) {
  Place desk(stage, placed({0.88f, 0, 1.12f}, 30));
  desk.put(f.desk, {0, 0, 0});
  desk.put(f.ball, {0.02f, kDeskTop, 0.02f});
  desk.put(f.drop, {0.36f, kDeskTop, 0.08f}, 15);
  desk.put(f.red_mug, {-0.3f, kDeskTop, 0.08f}, 200);
  desk.put(f.papers, {-0.55f, kDeskTop, -0.05f}, 75);
  desk.put(f.pens, {-0.38f, kDeskTop, -0.25f});
  desk.put(f.lamp, {0.62f, kDeskTop, -0.22f}, 160);
  desk.put(f.keyboard, {-0.02f, kDeskTop, 0.28f}, -4);
}

void furnish_walls(Stage& stage, const OfficeMaterials& m, const Furniture& f) {
  const auto volumes = books(stage, m);
  Place room(stage, {});
  room.put(bookshelf(stage, m, volumes, 5), {-kRoomHalfWidth, 0, -3.1f}, 90);
  room.put(bookshelf(stage, m, volumes, 8), {kRoomHalfWidth, 0, -3.1f}, -90);
  room.put(f.tall_plant, {1.56f, 0, -3.35f}, 30);
  room.put(f.plant, {-0.35f, 0.97f, kRoomBack + 0.06f});
  room.put(f.plant, {1.2f, 0.97f, kRoomBack + 0.06f}, 140);
  room.put(f.bin, {-1.95f, 0, -1.1f});
}

void lay_rug(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder rug("rug");
  rug.use(m.rug);
  const Vec3 size{3.0f, 0.012f, 2.9f};
  add_box(rug, {-size.x / 2, 0, -size.z / 2}, {size.x / 2, size.y, size.z / 2});
  Mesh mesh = rug.take();
  for (Vec2& uv : mesh.uvs) uv = {uv.x / size.x, uv.y / size.z};
  stage.place(stage.add(std::move(mesh)), translation({-0.7f, 0, -1.55f}), "rug");
}

void light_up(Stage& stage) {
  Light lamp;
  lamp.name = "ceiling lamp";
  lamp.position = {0.35f, 2.46f, -0.75f};
  lamp.intensity = {11.5f, 10.8f, 9.6f};
  lamp.radius = 0.08f;  // below the glowing bowl
  Light sun;
  sun.name = "sun";
  sun.type = Light::Type::kDirectional;
  sun.direction = normalized({-0.02f, -0.42f, 0.8f});
  sun.intensity = {3.4f, 3.0f, 2.3f};
  stage.scene.lights = {lamp, sun};

  Camera camera;
  camera.name = "desk";
  camera.to_world = look_at({2.0f, 1.5f, 2.5f}, {-0.55f, 0.78f, -1.4f}, {0, 1, 0});
  stage.scene.cameras.push_back(camera);
}

}  // namespace

SceneDescription office() {
  Stage stage("office");
  const OfficeMaterials m = office_materials(stage);
  build_room(stage, m);
  hang_on_walls(stage, m);
  lay_rug(stage, m);
  const Furniture furniture = make_furniture(stage, m);
  furnish_middle(stage, furniture);
  furnish_foreground(stage, furniture);
  furnish_walls(stage, m, furniture);
  stage.place(ceiling_lamp(stage, m), translation({0.35f, kRoomHeight, -0.75f}));
  light_up(stage);
  return std::move(stage.scene);
}

}  // namespace raysheaf::builtin
