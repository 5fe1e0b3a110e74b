// The viewer without a window: requests and results, and that the latest request takes precedence.
#include "model.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "tests/support/process.h"
#include "tests/support/read_png.h"
#include "vec.h"

namespace raysheaf::viewer {
namespace {

/// The built-in box. In one clip it rises by 1 within a second, in another it falls within half a
/// second.
std::unique_ptr<Animation> rising_box() {
  SceneDescription scene = builtin_scene("cornell");
  Rig rig;
  rig.nodes.emplace_back();
  for (const Instance& instance : scene.instances) {
    RigNode& node = rig.nodes.emplace_back();
    node.parent = 0;
    node.matrix.emplace();
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 4; ++c)
        (*node.matrix)[r][c] = static_cast<double>(instance.to_world.m[r][c]);
    rig.instance_nodes.push_back(static_cast<std::uint32_t>(rig.nodes.size() - 1));
  }
  rig.camera_nodes.assign(scene.cameras.size(), kInvalidId);
  rig.light_nodes.assign(scene.lights.size(), kInvalidId);
  RigClip& clip = rig.clips.emplace_back();
  clip.curves.push_back({Interpolation::kLinear, {0, 1}, {0, 0, 0, 0, 1, 0}});
  clip.channels.push_back({RigPath::kTranslation, 0, 0});
  RigClip& other = rig.clips.emplace_back();
  other.curves.push_back({Interpolation::kLinear, {0, 0.5}, {0, 0, 0, 0, -1, 0}});
  other.channels.push_back({RigPath::kTranslation, 0, 0});
  return animate(std::move(scene), std::move(rig));
}

/// A built-in scene whose camera is far away.
std::unique_ptr<Animation> seen_from_afar() {
  SceneDescription scene = builtin_scene("cornell");
  scene.cameras.front().to_world.m[2][3] += 1e5f;
  return animate(std::move(scene));
}

std::unique_ptr<Animation> load(const std::string& name) {
  if (name == "far") return seen_from_afar();
  if (name == "rising") return rising_box();
  if (name.ends_with(".obj")) return load_animation(name);
  if (name == "broken") throw Error(ErrorCode::kInvalidData, "this is no scene", name);
  return animate(builtin_scene(name));
}

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A model that runs by itself, one step per millisecond.
class ModelTest : public testing::Test {
 protected:
  ModelTest() {
    model.settings.samples = 3;
    model.set_window({48, 32});
  }
  template <class Condition>
  bool until(const Condition& condition, double seconds = 60) {
    for (const double end = now_s() + seconds; now_s() < end;) {
      model.update(now_s());
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  bool open(const std::string& name) {
    model.load(name);
    return until([this] { return !model.loading(); });
  }
  void press(const std::string& key) {
    InputEvent event;
    event.type = InputEvent::Type::kKeyDown;
    event.control = key.starts_with("ctrl+");
    event.shift = key.starts_with("shift+");
    event.text = key.substr(event.control ? 5 : event.shift ? 6 : 0);
    model.handle(event);
    event.type = InputEvent::Type::kKeyUp;
    model.handle(event);
  }
  void hand(InputEvent::Type type, float x, float y, int button = 0) {
    InputEvent event;
    event.type = type;
    event.x = x;
    event.y = y;
    event.button = button;
    event.time_s = (clock_ += 1);
    model.handle(event);
  }

  const test::TemporaryFolder folder;
  Tracer tracer{{load, [] {}}};
  Model model{ViewSettings(), tracer, folder.path().string()};

 private:
  double clock_ = 0;
};

TEST_F(ModelTest, RefinesAStillViewToTheRenderersImage) {
  model.settings.samples = 1;
  ASSERT_TRUE(open("cornell"));
  ASSERT_TRUE(until([this] { return model.refined(); }));
  RenderOptions options;
  options.width = 48;
  options.height = 32;
  const Image expected = tone_mapped(render(builtin_scene("cornell"), options));
  EXPECT_EQ(model.picture()->sides[0].image.rgba, expected.rgba);
}

TEST_F(ModelTest, TheLatestRequestWins) {
  ASSERT_TRUE(open("office"));
  for (int i = 0; i < 200; ++i) {
    model.rig.orbit(0.01f, 0);
    model.update(now_s());
  }
  ASSERT_TRUE(until([this] { return model.refined(); }));
  EXPECT_EQ(model.picture()->samples, 3u);
  // Most requests were dropped, so there are fewer images than requests.
  EXPECT_LT(model.picture_count(), 100u);
  ASSERT_TRUE(until([this] { return !tracer.busy(); }));
}

TEST_F(ModelTest, MethodsGiveOnePictureAndOtherCounts) {
  ASSERT_TRUE(open("cornell"));
  model.settings.split = true;
  ASSERT_TRUE(until([this] { return model.refined(); }));
  const Picture split = *model.picture();
  EXPECT_EQ(split.sides[0].image.rgba, split.sides[1].image.rgba);
  EXPECT_NE(model.value("tests"), model.value("right-tests"));
  EXPECT_EQ(model.value("rays"), model.value("right-rays"));
  model.settings.layer = Layer::kTests;
  ASSERT_TRUE(until([this] { return model.refined(); }));
  EXPECT_NE(model.picture()->sides[0].image.rgba, model.picture()->sides[1].image.rgba);
}

TEST_F(ModelTest, BeginsWithAnAutomaticCameraIfTheFirstShowsTheSceneSmall) {
  ASSERT_TRUE(open("cornell"));
  EXPECT_EQ(model.camera_index(), 0u);
  ASSERT_TRUE(open("far"));
  EXPECT_EQ(model.camera_index(), 1u);
  press("c");
  EXPECT_EQ(model.camera_index(), 0u);
  press("r");
  EXPECT_EQ(model.camera_index(), 0u);
}

TEST_F(ModelTest, ABadSceneLeavesTheGoodOne) {
  ASSERT_TRUE(open("cornell"));
  ASSERT_TRUE(open("broken"));
  EXPECT_EQ(model.value("scene"), "cornell");
  EXPECT_TRUE(model.last_note().failure);
  EXPECT_EQ(model.last_note().text, "broken: this is no scene");
  ASSERT_TRUE(until([this] { return model.refined(); }));
  ASSERT_TRUE(open("office"));
  EXPECT_EQ(model.value("scene"), "office");
}

/// Scenes are dropped faster than they can be loaded: those in between are never started.
TEST_F(ModelTest, TheLastOfManyScenesIsShown) {
  for (int round = 0; round < 5; ++round) {
    for (const char* name : {"office", "cornell", "broken", "rising", "cornell", "office"})
      model.load(name);
    model.load("cornell");
    EXPECT_TRUE(model.loading());
    ASSERT_TRUE(until([this] { return !model.loading(); }, 20));
    EXPECT_EQ(model.value("scene"), "cornell");
    ASSERT_TRUE(until([this] { return model.shows_now(); }, 20));
  }
}

TEST_F(ModelTest, ABadSceneDoesNotEndARefinement) {
  model.settings.samples = 40;
  ASSERT_TRUE(open("cornell"));
  ASSERT_TRUE(until([this] { return model.up_to_date(); }));
  ASSERT_FALSE(model.refined());
  ASSERT_TRUE(open("broken"));
  EXPECT_TRUE(until([this] { return model.refined(); }));
  EXPECT_EQ(model.picture()->samples, 40u);
}

TEST_F(ModelTest, ClickingNamesTheObject) {
  ASSERT_TRUE(open("cornell"));
  ASSERT_TRUE(until([this] { return model.refined(); }));
  hand(InputEvent::Type::kButtonDown, 0.5f, 0.5f);
  hand(InputEvent::Type::kButtonUp, 0.5f, 0.5f);
  ASSERT_TRUE(model.picked());
  EXPECT_GT(std::stod(model.value("pick-t")), 0);
  EXPECT_NE(model.value("pick-mesh"), "nothing");
  press("escape");
  EXPECT_EQ(model.value("pick-mesh"), "nothing");
}

TEST_F(ModelTest, DraggingOrbitsAndDoesNotClick) {
  ASSERT_TRUE(open("cornell"));
  const float yaw = model.rig.yaw();
  hand(InputEvent::Type::kButtonDown, 0.5f, 0.5f);
  hand(InputEvent::Type::kMove, 0.6f, 0.5f);
  hand(InputEvent::Type::kButtonUp, 0.6f, 0.5f);
  EXPECT_NE(model.rig.yaw(), yaw);
  EXPECT_FALSE(model.picked());
  // Over the panel, a button has another meaning.
  const float turned = model.rig.yaw();
  InputEvent event;
  event.type = InputEvent::Type::kButtonDown;
  model.handle(event, true);
  hand(InputEvent::Type::kMove, 0.1f, 0.5f);
  EXPECT_EQ(model.rig.yaw(), turned);
}

TEST_F(ModelTest, FliesWhileAKeyIsHeld) {
  ASSERT_TRUE(open("cornell"));
  InputEvent event;
  event.type = InputEvent::Type::kKeyDown;
  event.text = "w";
  const Vec3 from = model.rig.eye();
  model.update(10);
  model.handle(event);
  EXPECT_TRUE(model.moves());
  model.update(10.05);
  EXPECT_GT(dot(model.rig.eye() - from, model.rig.forward()), 0);
  event.type = InputEvent::Type::kKeyUp;
  model.handle(event);
  const Vec3 there = model.rig.eye();
  model.update(10.1);
  EXPECT_EQ(length(model.rig.eye() - there), 0);
  EXPECT_FALSE(model.moves());
}

TEST_F(ModelTest, EveryKeyOfTheHelpDoesSomething) {
  ASSERT_TRUE(open("office"));
  for (const std::string key : {"m", "shift+2", "shift+3", "o", "b", "v", "[",   "]", "l",  "-",
                                "=", "z",       "g",       "x", "k", "u", "tab", "p", "f1", "h"}) {
    const ViewSettings before = model.settings;
    press(key);
    EXPECT_NE(model.settings, before) << key;
  }
  for (const std::string key : {"f", "home", "r", "enter", "1", "3", "7", "ctrl+1", "ctrl+3",
                                "ctrl+7", "9", "2", "8", "4", "6", "kp+", "kp-"}) {
    model.rig.fly(0.1f, 0.2f, 0.3f);
    const Vec3 before = model.rig.eye();
    press(key);
    EXPECT_GT(length(model.rig.eye() - before), 0) << key;
  }
}

TEST_F(ModelTest, ShowsTheBundleUnderTheCursor) {
  ASSERT_TRUE(open("cornell"));
  model.settings.bundle = true;
  model.settings.bundle_rays = LabRays::kReflection1;
  model.settings.left.method = Method::kCrsh;
  hand(InputEvent::Type::kMove, 0.4f, 0.6f);
  ASSERT_TRUE(until([this] { return model.bundle_up_to_date(); }));
  EXPECT_EQ(model.value("bundle-size"), "8");
  EXPECT_EQ(model.value("bundle-bounds"), "2");
  ASSERT_TRUE(until([this] { return model.refined(); }));  // rendering goes on after the question
}

TEST_F(ModelTest, SavesTheWholePicture) {
  ASSERT_TRUE(open("cornell"));
  model.save();
  ASSERT_TRUE(until([this] { return !model.saving(); }));
  model.save();  // uses the next free name
  ASSERT_TRUE(until([this] { return !model.saving(); }));
  EXPECT_EQ(folder.names().size(), 2u);
  ASSERT_TRUE(until([this] { return model.refined(); }));
  const Image saved = test::read_png(folder.file("raysheaf-0001.png"));
  EXPECT_EQ(saved.width, 48u);
  EXPECT_EQ(saved.rgba, model.picture()->sides[0].image.rgba);
  model.save("/nowhere/at/all.png");
  ASSERT_TRUE(until([this] { return !model.saving(); }));
  model.update(now_s());
  EXPECT_TRUE(model.last_note().failure) << model.last_note().text;
}

TEST_F(ModelTest, PlaysPausesAndScrubs) {
  ASSERT_TRUE(open("rising"));
  ASSERT_TRUE(until([this] { return model.refined(); }));
  const std::vector<std::uint8_t> first = model.picture()->sides[0].image.rgba;
  model.seek(0.5);
  EXPECT_FALSE(model.up_to_date());
  ASSERT_TRUE(until([this] { return model.refined(); }));
  EXPECT_NE(model.picture()->sides[0].image.rgba, first);
  model.seek(-3);
  EXPECT_EQ(model.time_s(), 0);
  ASSERT_TRUE(until([this] { return model.refined(); }));
  EXPECT_EQ(model.picture()->sides[0].image.rgba, first);
  press("space");
  EXPECT_TRUE(model.playing());
  EXPECT_TRUE(model.moves());
  ASSERT_TRUE(until([this] { return model.time_s() > 0.3; }));
  ASSERT_TRUE(until([this] { return model.time_s() < 0.3; }));  // the clip begins again
  press("space");
  const double stands = model.time_s();
  press(".");
  EXPECT_NEAR(model.time_s(), stands + 1.0 / 24, 1e-6);
  EXPECT_FALSE(model.playing());
}

/// Neither playing nor stopping elsewhere changes the brightness; a move of the camera may.
TEST_F(ModelTest, AnAnimationKeepsItsExposure) {
  ASSERT_TRUE(open("rising"));
  ASSERT_TRUE(until([this] { return model.refined(); }));
  const float exposure = model.picture()->exposure;
  press("space");
  ASSERT_TRUE(until([this] { return model.picture()->request.time_s > 0.3; }));
  EXPECT_EQ(model.picture()->exposure, exposure);
  model.seek(0.8);
  ASSERT_TRUE(until([this] { return model.refined(); }));
  EXPECT_EQ(model.picture()->exposure, exposure);
  model.save(folder.file("kept.png"));
  ASSERT_TRUE(until([this] { return !model.saving(); }));
  EXPECT_EQ(test::read_png(folder.file("kept.png")).rgba, model.picture()->sides[0].image.rgba);
  model.rig.orbit(1e-3f, 0);
  ASSERT_TRUE(until([this] { return model.refined(); }));
  EXPECT_NE(model.picture()->exposure, exposure);
}

/// While the camera moves, OpenGL draws the view, and nothing is traced.
TEST_F(ModelTest, TracesNothingBehindThePreview) {
  model.offer_preview(true);
  ASSERT_TRUE(open("cornell"));
  EXPECT_TRUE(model.mesh_is_current());
  EXPECT_TRUE(model.shows_preview());
  ASSERT_TRUE(until([this] { return model.refined(); }));
  EXPECT_FALSE(model.shows_preview());
  ASSERT_TRUE(until([this] { return !tracer.busy(); }));
  const std::uint64_t before = model.picture_count();
  for (int i = 0; i < 30; ++i) {
    model.rig.orbit(0.01f, 0);
    model.update(now_s());
    EXPECT_TRUE(model.shows_preview());
    EXPECT_FALSE(tracer.busy());
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_EQ(model.picture_count(), before);
  EXPECT_EQ(model.reprojected(), model.picture());
  ASSERT_TRUE(until([this] { return model.refined(); }));
  EXPECT_FALSE(model.shows_preview());
  // Other layers have no preview.
  model.settings.layer = Layer::kTests;
  model.rig.orbit(0.1f, 0);
  model.update(now_s());
  EXPECT_FALSE(model.shows_preview());
}

TEST_F(ModelTest, ThePreviewFollowsAnAnimationWhenItRests) {
  model.offer_preview(true);
  ASSERT_TRUE(open("rising"));
  model.seek(0.5);
  model.update(now_s());
  EXPECT_FALSE(model.mesh_is_current());
  EXPECT_FALSE(model.shows_preview());
  ASSERT_TRUE(until([this] { return model.mesh_is_current(); }));
}

TEST_F(ModelTest, ReadsAFileAgainWhenItChanges) {
  const std::string path = folder.file("quad.obj");
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
  test::write_file(path, square);
  ASSERT_TRUE(open(path));
  EXPECT_EQ(model.value("triangles"), "2");
  model.rig.orbit(0.5f, 0);
  const float yaw = model.rig.yaw();
  test::write_file(path, square + "v 2 2 0\nf 2 5 3\n");
  ASSERT_TRUE(until([this] { return model.value("triangles") == "3"; }));
  EXPECT_EQ(model.rig.yaw(), yaw);
  EXPECT_NE(model.last_note().text.find("read again"), std::string::npos);
  // A broken file leaves the scene; the next change is noticed again.
  test::write_file(path, "v 0 0\nf 1 2 9\n");
  ASSERT_TRUE(until([this] { return model.last_note().failure; }));
  EXPECT_EQ(model.value("triangles"), "3");
  test::write_file(path, square);
  ASSERT_TRUE(until([this] { return model.value("triangles") == "2"; }));
  model.settings.reload = false;
  test::write_file(path, square + "v 2 2 0\nf 2 5 3\n");
  EXPECT_FALSE(until([this] { return model.loading(); }, 2));
  press("f5");
  ASSERT_TRUE(until([this] { return model.value("triangles") == "3"; }));
}

TEST_F(ModelTest, OpensAFileInItsDialog) {
  std::filesystem::create_directory(folder.path() / "more");
  test::write_file(folder.file("more/tri.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  test::write_file(folder.file("notes.txt"), "no scene");
  test::write_file(folder.file("a.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  ASSERT_TRUE(open(folder.file("a.obj")));
  press("ctrl+o");
  ASSERT_NE(model.dialog(), nullptr);
  EXPECT_EQ(model.value("dialog"), folder.path().string());
  EXPECT_EQ(model.dialog()->entries().size(), 3u);  // "..", more, a.obj
  EXPECT_EQ(model.value("dialog-entry"), "more");
  press("enter");
  EXPECT_EQ(model.value("dialog-entry"), "tri.obj");
  press("backspace");
  EXPECT_EQ(model.value("dialog-entry"), "more");
  press("enter");
  press("enter");
  EXPECT_EQ(model.value("dialog"), "closed");
  ASSERT_TRUE(until([this] { return !model.loading(); }));
  EXPECT_NE(model.value("scene").find("tri"), std::string::npos) << model.value("scene");
  press("ctrl+o");
  press("escape");
  EXPECT_EQ(model.dialog(), nullptr);
}

TEST_F(ModelTest, DragsAsBlenderAndF3d) {
  ASSERT_TRUE(open("cornell"));
  const auto drag = [this](int button, bool shift, bool control) {
    InputEvent event;
    event.type = InputEvent::Type::kButtonDown;
    event.x = event.y = 0.5f;
    event.button = button;
    event.shift = shift;
    event.control = control;
    model.handle(event);
    hand(InputEvent::Type::kMove, 0.6f, 0.6f);
    hand(InputEvent::Type::kButtonUp, 0.6f, 0.6f, button);
  };
  const CameraRig before = model.rig;
  drag(2, false, false);
  EXPECT_EQ(model.rig.yaw(), before.yaw());
  EXPECT_GT(length(model.rig.eye() - before.eye()), 0);
  model.rig = before;
  model.settings.middle_drag = ViewSettings::MiddleDrag::kOrbit;
  drag(2, false, false);
  EXPECT_NE(model.rig.yaw(), before.yaw());
  model.rig = before;
  drag(2, true, false);
  EXPECT_EQ(model.rig.yaw(), before.yaw());
  model.rig = before;
  drag(0, false, true);
  EXPECT_EQ(model.rig.yaw(), before.yaw());
  EXPECT_GT(model.rig.distance(), before.distance());
}

TEST_F(ModelTest, PlaysAnotherClipToItsOwnEnd) {
  ASSERT_TRUE(open("rising"));
  model.seek(0.9);
  ASSERT_TRUE(until([this] { return model.refined(); }));
  const std::vector<std::uint8_t> up = model.picture()->sides[0].image.rgba;
  model.set_clip(1);
  EXPECT_EQ(model.end_s(), 0.5);
  EXPECT_EQ(model.time_s(), 0.5);
  EXPECT_FALSE(model.up_to_date());
  ASSERT_TRUE(until([this] { return model.refined(); }));
  EXPECT_NE(model.picture()->sides[0].image.rgba, up);
  EXPECT_THROW(model.set_clip(2), Error);
  model.set_clip(0);
  model.seek(0.9);
  ASSERT_TRUE(until([this] { return model.refined(); }));
  EXPECT_EQ(model.picture()->sides[0].image.rgba, up);
}

TEST_F(ModelTest, AStaticSceneDoesNotPlay) {
  ASSERT_TRUE(open("cornell"));
  press("space");
  EXPECT_FALSE(model.playing());
}

TEST_F(ModelTest, RefusesADeviceWithASentence) {
  ASSERT_TRUE(open("cornell"));
  model.settings.device = Device::kCuda;
  ASSERT_TRUE(until([this] { return model.last_note().failure; }));
  EXPECT_NE(model.last_note().text.find("device"), std::string::npos);
  model.settings.device = Device::kCpu;
  ASSERT_TRUE(until([this] { return model.refined(); }));
}

TEST_F(ModelTest, AnswersByNameAndRefusesOthers) {
  EXPECT_EQ(model.value("method"), "dual");
  EXPECT_EQ(model.value("scene"), "nothing");
  EXPECT_THROW((void)model.value("weather"), Error);
}

TEST(TracerThread, EndsInTheMiddleOfWork) {
  for (int ms = 0; ms < 40; ms += 8) {
    Tracer tracer({load, [] {}});
    tracer.load("office");
    ViewRequest request;
    request.camera = builtin_scene("office").cameras.front();
    request.settings.left.method = Method::kBrute;
    request.size = {256, 256};
    request.refine = true;
    tracer.submit(request);
    std::this_thread::sleep_for(std::chrono::milliseconds(ms));
  }
}

}  // namespace
}  // namespace raysheaf::viewer
