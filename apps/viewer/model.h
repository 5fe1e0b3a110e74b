// The viewer without its window: turns input into a camera, settings, and requests to the tracer,
// and takes the results of the tracer. The caller passes the time, so that tests need no display
// and no waiting.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "camera_rig.h"
#include "file_browser.h"
#include "file_watch.h"
#include "input.h"
#include "picture.h"
#include "resolution.h"
#include "tracer.h"
#include "view_settings.h"

namespace raysheaf::viewer {

/// A sentence for the user.
struct Note {
  std::string text;
  bool failure = false;
  double time_s = 0;
};

/// Times and counts of an image, for the plots.
struct HistoryEntry {
  double total_ms = 0, raster_ms = 0, shade_ms = 0;
  StageTimes stages;  ///< over all batches
  double rays = 0, tests = 0;
};

class Model {
 public:
  /// `start`: the settings to begin with. `save_folder`: the folder of saved images.
  Model(const ViewSettings& start, Tracer& tracer, std::string save_folder = ".");

  void load(const std::string& path);
  /// Reads the scene again; the camera, the time and the settings stay.
  void reload();
  void set_window(Size pixels) { window_ = pixels; }
  /// `over_panel`: the cursor is over the interface, which takes buttons and scrolling; `typing`:
  /// the interface takes keys.
  void handle(const InputEvent& event, bool over_panel = false, bool typing = false);
  /// Called once per frame: flies on, takes the results of the tracer, and requests missing images.
  void update(double now_s);
  /// Saves an image in full quality, under the next free name of the folder or as `path`.
  void save(const std::string& path = "");
  void set_camera(std::size_t index);
  /// Looks from a side of the scene; none: from the front, slightly above and to the right.
  void look_from(std::optional<ViewSide> side);
  void toggle_orthographic();
  /// The first view of the next scene.
  void begin_from(std::optional<ViewSide> side, bool orthographic) {
    first_side_ = side;
    first_orthographic_ = orthographic;
  }
  void open_dialog(bool on);
  /// Enters the folder, or opens the file and closes the dialog.
  void choose_file(std::size_t entry);
  void select_file(std::size_t entry);
  void close() { quit_ = true; }
  /// Whether the caller can draw `mesh` with OpenGL, fast enough.
  void offer_preview(bool possible) { can_preview_ = possible; }
  void note(std::string text, bool failure = false);
  /// Plays, or pauses; at the end it starts again.
  void play(bool on);
  /// Moves to a time in seconds, clamped to the range of the scene, and pauses.
  void seek(double seconds);
  /// Moves to the next or the previous frame: of the sequence, or a 24th of a second away.
  void step(int frames);
  /// Throws `Error` (kNotFound).
  void set_clip(std::uint32_t clip);

  ViewSettings settings;  ///< may be changed at any time
  CameraRig rig;          ///< may be changed at any time

  [[nodiscard]] const std::optional<SceneFacts>& facts() const { return facts_; }
  [[nodiscard]] const Picture* picture() const { return picture_.get(); }
  /// The triangles of the scene; null: none, or too many.
  [[nodiscard]] const std::shared_ptr<const PreviewMesh>& mesh() const { return mesh_; }
  /// Whether `mesh` is that of the current time.
  [[nodiscard]] bool mesh_is_current() const;
  /// Whether to draw the preview, because no traced image is that of the current camera.
  [[nodiscard]] bool shows_preview() const;
  /// The traced image whose colours the preview takes over; null: none.
  [[nodiscard]] const Picture* reprojected() const;
  /// Whether nothing has changed for some time.
  [[nodiscard]] bool rests() const;
  /// Null: the dialog is closed.
  [[nodiscard]] const FileBrowser* dialog() const { return dialog_ ? &*dialog_ : nullptr; }
  [[nodiscard]] const std::optional<Pick>& picked() const { return pick_; }
  [[nodiscard]] const std::optional<BundleAnswer>& bundle() const { return bundle_; }
  [[nodiscard]] const std::deque<HistoryEntry>& history() const { return history_; }
  [[nodiscard]] const Note& last_note() const { return note_; }
  [[nodiscard]] Size window() const { return window_; }
  [[nodiscard]] std::size_t camera_index() const { return camera_index_; }
  [[nodiscard]] double now_s() const { return now_s_; }
  [[nodiscard]] double time_s() const { return time_s_; }
  [[nodiscard]] bool playing() const { return playing_; }
  [[nodiscard]] std::uint32_t clip() const { return clip_; }
  /// The range of the clip.
  [[nodiscard]] double end_s() const;
  [[nodiscard]] bool quit() const { return quit_; }
  [[nodiscard]] bool loading() const { return load_number_ != 0; }
  [[nodiscard]] bool saving() const { return tracer_.saving(); }
  /// Whether the next frame changes by itself, because something flies or plays.
  [[nodiscard]] bool moves() const;
  /// Whether the image matches the current camera and settings.
  [[nodiscard]] bool up_to_date() const;
  /// The same for images of any size.
  [[nodiscard]] bool shows_now() const;
  [[nodiscard]] bool bundle_up_to_date() const;
  /// Whether it also has all its samples.
  [[nodiscard]] bool refined() const { return up_to_date() && picture_->finished; }
  /// Whether a result that will change the view is still expected.
  [[nodiscard]] bool waits() const { return loading() || !refined() || tracer_.busy() || saving(); }
  /// Grows whenever the view has changed by itself: images, notes, scenes, bundles.
  [[nodiscard]] std::uint64_t version() const { return version_; }
  /// Counts received images, to tell which one was uploaded.
  [[nodiscard]] std::uint64_t picture_count() const { return picture_count_; }
  /// Counts loaded scenes.
  [[nodiscard]] std::uint64_t scene_count() const { return scene_count_; }
  /// A value for scripts, by name, as text: a setting, or a value that docs/viewer.md lists. Throws
  /// `Error` (kNotFound), which lists the names.
  [[nodiscard]] std::string value(const std::string& name) const;

 private:
  /// The action of a drag.
  enum class Drag : std::uint8_t { kOrbit, kLook, kPan, kZoom };

  void key_down(const InputEvent& event);
  /// Keys of the open dialog, which takes all keys; false without a dialog.
  bool dialog_key(const std::string& key);
  /// Keys that move the camera; true if the key can have no other action.
  bool view_key(const InputEvent& event);
  void setting_key(const InputEvent& event);
  [[nodiscard]] Drag drag_of(const InputEvent& event) const;
  void cursor_moved(const InputEvent& event);
  void click(const InputEvent& event);
  void fly(double seconds);
  void go_on(double seconds);
  [[nodiscard]] double shown_time() const;
  void take_all(double now_s);
  void take_scene(LoadedScene loaded);
  /// Whether moves of the camera are shown by the preview.
  [[nodiscard]] bool previews() const;
  void follow_up_axis();
  void reload_if_changed(double now_s);
  void take_picture(std::shared_ptr<const Picture> picture);
  void wish(double now_s);
  void wish_for_bundle();
  [[nodiscard]] BundleQuestion bundle_question() const;
  [[nodiscard]] ViewRequest request_of(Size size, bool refine) const;
  [[nodiscard]] bool same_wish(const ViewRequest& a, const ViewRequest& b) const;
  void resolve_pick();

  Tracer& tracer_;
  const std::string save_folder_;
  Size window_{1280, 800};
  std::optional<SceneFacts> facts_;
  std::shared_ptr<const Picture> picture_;
  std::uint64_t picture_count_ = 0, version_ = 0, scene_count_ = 0;
  std::shared_ptr<const PreviewMesh> mesh_;
  bool can_preview_ = false;
  std::optional<FileBrowser> dialog_;
  FileWatch watch_;
  std::string path_;              ///< of the scene
  std::optional<ViewSide> side_;  ///< that the camera last looked from
  std::optional<ViewSide> first_side_;
  bool first_orthographic_ = false;
  UpAxis up_ = UpAxis::kY;  ///< that `rig` has
  std::optional<Pick> pick_;
  std::optional<InputEvent> pending_pick_;
  std::optional<BundleAnswer> bundle_;
  std::optional<BundleQuestion> asked_;
  std::deque<HistoryEntry> history_;
  Note note_;
  Resolution resolution_;
  ViewRequest wished_;       ///< the last submitted request
  bool wished_any_ = false;  ///< whether any was submitted for this scene
  int stage_ = 0;            ///< 0: moving; 1: a larger image while the camera rests; 2: refinement
  double last_change_s_ = 0, now_s_ = 0;
  std::uint64_t load_number_ = 0;    ///< of the last requested scene; 0: it has arrived
  std::uint64_t reload_number_ = 0;  ///< the same if that scene is read again
  double time_s_ = 0;
  std::uint32_t clip_ = 0;
  bool playing_ = false;
  std::size_t camera_index_ = 0;
  std::set<std::string> held_;
  bool fast_ = false;
  int dragged_button_ = -1;
  bool drag_moved_ = false;
  Drag drag_ = Drag::kOrbit;
  float cursor_x_ = 0.5f, cursor_y_ = 0.5f, press_x_ = 0, press_y_ = 0;
  double last_click_s_ = -1;
  std::uint32_t saved_ = 0;
  bool quit_ = false;
};

/// "1 mesh", "2 meshes", "12 345 meshes".
[[nodiscard]] std::string count_text(std::uint64_t count, const char* one, const char* many);

/// A key and its action, for the help; without keys a heading.
struct KeyHelp {
  std::string keys, what;
};
[[nodiscard]] const std::vector<KeyHelp>& key_help();

}  // namespace raysheaf::viewer
