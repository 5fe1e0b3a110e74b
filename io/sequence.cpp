// Animates sequences of files: each frame next to a static part.
#include "io/sequence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <future>
#include <iterator>
#include <system_error>
#include <utility>

#include "io/file.h"
#include "io/gltf_rules.h"
#include "io/load.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

namespace fs = std::filesystem;

constexpr double kUsualRate = 24;

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  static_assert(std::is_trivially_copyable_v<T>);
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same(const Affine& a, const Affine& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}
/// Whether the meshes differ at most in positions and normals.
bool same_but_for_shape(const Mesh& a, const Mesh& b) {
  return a.positions.size() == b.positions.size() && a.normals.size() == b.normals.size() &&
         same_bytes(a.triangles, b.triangles) && same_bytes(a.materials, b.materials) &&
         same_bytes(a.uvs, b.uvs) && same_bytes(a.second_uvs, b.second_uvs) &&
         same_bytes(a.colors, b.colors) && same_bytes(a.alphas, b.alphas);
}

/// Replaces the part of a list from `first` on. Returns whether anything changed.
template <class T, class Same>
bool replace_tail(std::vector<T>& list, std::size_t first, const std::vector<T>& tail,
                  const Same& same) {
  const auto begin = list.begin() + static_cast<std::ptrdiff_t>(first);
  if (std::equal(begin, list.end(), tail.begin(), tail.end(), same)) return false;
  list.erase(begin, list.end());
  list.insert(list.end(), tail.begin(), tail.end());
  return true;
}

/// Replaces the `*count` entries from `first` on and keeps the entries after them.
template <class T>
void replace_part(std::vector<T>& list, std::size_t first, std::size_t* count,
                  const std::vector<T>& part) {
  const auto begin = list.begin() + static_cast<std::ptrdiff_t>(first);
  const auto at = list.erase(begin, begin + static_cast<std::ptrdiff_t>(*count));
  list.insert(at, part.begin(), part.end());
  *count = part.size();
}

bool same_slot(const TextureSlot& a, const TextureSlot& b) {
  const auto numbers = [](const TextureSlot& s) {
    return std::array<float, 5>{s.offset.x, s.offset.y, s.scale.x, s.scale.y, s.rotation};
  };
  return a.texture == b.texture && a.second_uvs == b.second_uvs && numbers(a) == numbers(b);
}
bool same_material(const Material& a, const Material& b) {
  const auto numbers = [](const Material& m) {
    return std::array<float, 21>{m.base_color.x,     m.base_color.y,     m.base_color.z,
                                 m.base_color.w,     m.metallic,         m.roughness,
                                 m.emission.x,       m.emission.y,       m.emission.z,
                                 m.specular,         m.specular_color.x, m.specular_color.y,
                                 m.specular_color.z, m.transmission,     m.ior,
                                 m.thin ? 1.0f : 0,  m.unlit ? 1.0f : 0, m.double_sided ? 1.0f : 0,
                                 m.normal_scale,     m.alpha_cutoff,     m.alpha_blend ? 1.0f : 0};
  };
  return a.name == b.name && numbers(a) == numbers(b) &&
         same_slot(a.base_color_texture, b.base_color_texture) &&
         same_slot(a.metallic_roughness_texture, b.metallic_roughness_texture) &&
         same_slot(a.emission_texture, b.emission_texture) &&
         same_slot(a.normal_texture, b.normal_texture);
}
bool same_texture(const Texture& a, const Texture& b) {
  return a.image == b.image && a.wrap_u == b.wrap_u && a.wrap_v == b.wrap_v && a.filter == b.filter;
}
bool same_image(const Image& a, const Image& b) {
  return a.name == b.name && a.width == b.width && same_bytes(a.rgba, b.rgba);
}

/// The appearance of a frame, without its shapes.
struct Look {
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Image> images;

  explicit Look(SceneDescription&& frame)
      : materials(std::move(frame.materials)),
        textures(std::move(frame.textures)),
        images(std::move(frame.images)) {}

  [[nodiscard]] bool operator==(const Look& other) const {
    const auto same = [](const auto& a, const auto& b, const auto& same_one) {
      return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_one);
    };
    return same(materials, other.materials, same_material) &&
           same(textures, other.textures, same_texture) && same(images, other.images, same_image);
  }
};

/// Changes whenever the file changes.
struct FileStamp {
  fs::file_time_type written;
  std::uintmax_t bytes = 0;
  bool operator==(const FileStamp&) const = default;
};
FileStamp stamp_of(const std::string& path) {
  std::error_code failed;  // not a file: reading it reports the error
  return {fs::last_write_time(path, failed), fs::file_size(path, failed)};
}

/// How many of each the static part of the scene has.
struct Counts {
  std::size_t meshes = 0, instances = 0, materials = 0, textures = 0, images = 0, lights = 0,
              cameras = 0;
};

/// Shifts the indices of a frame behind those of the static part.
void shift(SceneDescription& frame, const Counts& still) {
  const auto add = [](std::uint32_t& index, std::size_t by) {
    if (index != kInvalidId) index += static_cast<std::uint32_t>(by);
  };
  for (Instance& instance : frame.instances) add(instance.mesh, still.meshes);
  for (Mesh& mesh : frame.meshes) {
    // A mesh without entries has no material, and stays without.
    for (std::uint32_t& material : mesh.materials) add(material, still.materials);
  }
  for (Material& material : frame.materials) {
    for (TextureSlot* slot : {&material.base_color_texture, &material.metallic_roughness_texture,
                              &material.emission_texture, &material.normal_texture})
      add(slot->texture, still.textures);
  }
  for (Texture& texture : frame.textures) add(texture.image, still.images);
}

class SequenceAnimation final : public Animation {
 public:
  SequenceAnimation(SequenceFiles files, const LoadOptions& options)
      : files_(std::move(files)), options_(options) {
    check();
    if (!files_.still.empty()) scene_ = io::load_part(files_.still, options_, &images_);
    scene_.files.insert(scene_.files.end(), files_.frames.begin(), files_.frames.end());
    if (!files_.name.empty()) scene_.name = files_.name;
    if (!files_.lights.empty()) scene_.lights = files_.lights;
    if (!files_.cameras.empty()) {
      Camera moving = files_.cameras.front();
      moving.name = "moving";
      scene_.cameras.insert(scene_.cameras.begin(), moving);
    }
    scene_.cameras.insert(scene_.cameras.end(), files_.still_cameras.begin(),
                          files_.still_cameras.end());
    still_ = {scene_.meshes.size(),   scene_.instances.size(), scene_.materials.size(),
              scene_.textures.size(), scene_.images.size(),    scene_.lights.size(),
              scene_.cameras.size()};
    if (files_.times.empty()) {
      for (std::size_t i = 0; i < files_.frames.size(); ++i)
        files_.times.push_back(static_cast<double>(i) / kUsualRate);
    }
    if (options_.preload) preload();
    show(0);
    validate(scene_);
  }

  SceneDescription& scene() override { return scene_; }
  [[nodiscard]] double start() const override { return files_.times.front(); }
  [[nodiscard]] double end() const override { return files_.times.back(); }
  [[nodiscard]] const std::vector<double>& frame_times() const override { return files_.times; }
  [[nodiscard]] const std::vector<std::string>& clips() const override { return names_; }
  void play(std::uint32_t clip) override {
    if (clip != 0) throw Error(ErrorCode::kNotFound, "a sequence has one clip, 0");
  }

  SceneChanges seek(double seconds) override {
    const auto after = std::upper_bound(files_.times.begin(), files_.times.end(), seconds);
    const auto index =
        static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - files_.times.begin() - 1, 0));
    if (index == shown_ && is_told_) return {};
    // If this call fails, the next one reports all changes.
    const bool was_told = std::exchange(is_told_, false);
    if (!was_told) look_ = kNone;  // the scene may have parts of another look
    SceneChanges changes =
        within_memory("there is not enough memory", "animation", [&] { return show(index); });
    changes.everything = changes.everything || !was_told;
    is_told_ = true;
    return changes;
  }

 private:
  void check() const {
    const auto per_frame = [&](const char* field, std::size_t count) {
      if (count == 0 || count == files_.frames.size()) return;
      throw Error(ErrorCode::kInvalidArgument,
                  "has " + std::to_string(count) + " entries for " +
                      std::to_string(files_.frames.size()) + " frames",
                  field);
    };
    if (files_.frames.empty())
      throw Error(ErrorCode::kInvalidArgument, "there are no frames", "frames");
    per_frame("times", files_.times.size());
    per_frame("cameras", files_.cameras.size());
    // Checked here, rather than after an hour of rendering.
    for (std::size_t i = 0; i < files_.frames.size(); ++i) {
      if (io::file_exists(files_.frames[i])) continue;
      throw Error(ErrorCode::kNotFound, "no such file \"" + io::printable(files_.frames[i]) + "\"",
                  "frames[" + std::to_string(i) + "]");
    }
    for (std::size_t i = 0; i < files_.times.size(); ++i) {
      if (std::isfinite(files_.times[i]) && (i == 0 || files_.times[i] > files_.times[i - 1]))
        continue;
      throw Error(ErrorCode::kInvalidArgument, "is not finite, or not later than the one before",
                  "times[" + std::to_string(i) + "]");
    }
  }

  /// The frame's own part, with indices shifted behind those of the static part.
  SceneDescription load(std::size_t index) {
    SceneDescription frame = io::load_part(files_.frames[index], options_, &images_);
    shift(frame, still_);
    return frame;
  }

  /// Frames with equal appearance share it, because images are large.
  void preload() {
    for (std::size_t i = 0; i < files_.frames.size(); ++i) {
      kept_.push_back(load(i));
      Look look(std::move(kept_.back()));
      const auto known = std::find(looks_.begin(), looks_.end(), look);
      look_of_.push_back(static_cast<std::size_t>(known - looks_.begin()));
      if (known == looks_.end()) looks_.push_back(std::move(look));
    }
  }

  SceneDescription read(std::size_t index) {
    if (ahead_.valid()) {
      ahead_.wait();  // `ahead_` uses the same image cache
      if (ahead_index_ == index && ahead_stamp_ == stamp_of(files_.frames[index]))
        return ahead_.get();
      ahead_ = {};
    }
    return load(index);
  }

  /// Starts to read the next frame, assuming that steps go on as the last one did. It is used when
  /// requested, unless the file has changed.
  void read_ahead(std::size_t index) {
    const std::size_t next = shown_ == kNone ? index + 1 : index + (index - shown_);
    if (next >= files_.frames.size() || !kept_.empty()) return;
    ahead_index_ = next;
    ahead_stamp_ = stamp_of(files_.frames[next]);
    try {
      ahead_ = std::async(std::launch::async, [this, next] { return load(next); });
    } catch (const std::system_error&) {
      // Without a thread, the frame is read when it is shown.
    }
  }

  SceneChanges show(std::size_t index) {
    if (!kept_.empty()) return show(index, kept_[index]);
    SceneDescription frame = read(index);
    return show(index, frame);
  }

  /// Returns whether anything changes its appearance.
  bool take_look(const Look& look) {
    return static_cast<bool>(
        replace_tail(scene_.materials, still_.materials, look.materials, same_material) |
        replace_tail(scene_.textures, still_.textures, look.textures, same_texture) |
        replace_tail(scene_.images, still_.images, look.images, same_image));
  }
  bool take_look(std::size_t index, SceneDescription& frame) {
    if (kept_.empty()) return take_look(Look(std::move(frame)));
    const std::size_t before = std::exchange(look_, look_of_[index]);
    return before != look_ && take_look(looks_[look_]);
  }

  /// Moves data out of the frame, unless it was preloaded.
  SceneChanges show(std::size_t index, SceneDescription& frame) {
    SceneChanges changes = take_meshes(frame);
    if (take_look(index, frame)) {
      SceneChanges everything;
      everything.everything = true;
      changes.add(everything);
    }
    replace_part(scene_.lights, still_.lights, &frame_lights_, frame.lights);
    replace_part(scene_.cameras, still_.cameras, &frame_cameras_, frame.cameras);
    if (!files_.cameras.empty()) {
      scene_.cameras[0] = files_.cameras[index];
      scene_.cameras[0].name = "moving";
    }
    for (const std::string& sentence : frame.warnings) {
      std::vector<std::string>& all = scene_.warnings;
      if (std::find(all.begin(), all.end(), sentence) == all.end()) all.push_back(sentence);
    }
    if (shown_ == kNone) {
      scene_.files.insert(scene_.files.end(), frame.files.begin() + 1, frame.files.end());
    }
    read_ahead(index);
    shown_ = index;
    return changes;
  }

  /// Moves a part of a frame, or copies it if the frames are preloaded.
  template <class T>
  [[nodiscard]] T taken(T& from) const {
    return kept_.empty() ? std::move(from) : T(from);
  }

  /// Meshes that differ from the previous frame only in positions and normals are reported as
  /// deformed. From the first mesh that differs otherwise, all are reported as replaced.
  SceneChanges take_meshes(SceneDescription& frame) {
    SceneChanges changes;
    const std::size_t before = scene_.meshes.size() - still_.meshes;
    std::size_t m = 0;
    for (; m < std::min(before, frame.meshes.size()); ++m) {
      Mesh& mesh = scene_.meshes[still_.meshes + m];
      Mesh& other = frame.meshes[m];
      if (!same_but_for_shape(mesh, other)) break;
      mesh.name = taken(other.name);
      if (same_bytes(mesh.positions, other.positions) && same_bytes(mesh.normals, other.normals))
        continue;
      changes.deformed.push_back(static_cast<std::uint32_t>(still_.meshes + m));
      mesh.positions = taken(other.positions);
      mesh.normals = taken(other.normals);
    }
    if (m < before || m < frame.meshes.size()) {
      changes.other_meshes_from = static_cast<std::uint32_t>(still_.meshes + m);
      scene_.meshes.resize(changes.other_meshes_from);
      for (; m < frame.meshes.size(); ++m) scene_.meshes.push_back(taken(frame.meshes[m]));
    }
    take_instances(frame.instances, &changes);
    return changes;
  }

  void take_instances(std::vector<Instance>& frame, SceneChanges* changes) {
    const std::size_t before = scene_.instances.size() - still_.instances;
    std::size_t i = 0;
    for (; i < std::min(before, frame.size()); ++i) {
      Instance& instance = scene_.instances[still_.instances + i];
      if (instance.mesh != frame[i].mesh) break;
      if (!same(instance.to_world, frame[i].to_world))
        changes->moved.push_back(static_cast<std::uint32_t>(still_.instances + i));
      instance = taken(frame[i]);
    }
    if (i == before && i == frame.size()) return;
    changes->other_instances_from = static_cast<std::uint32_t>(still_.instances + i);
    scene_.instances.resize(changes->other_instances_from);
    for (; i < frame.size(); ++i) scene_.instances.push_back(taken(frame[i]));
  }

  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  SequenceFiles files_;
  LoadOptions options_;
  io::ImageCache images_;
  SceneDescription scene_;
  Counts still_;
  std::size_t shown_ = kNone;
  /// Whether the changes of the last `seek` were returned.
  bool is_told_ = true;
  std::size_t frame_lights_ = 0, frame_cameras_ = 0;  ///< how many the frame added
  std::vector<std::string> names_{"sequence"};
  // If frames are preloaded: all of them without their appearance, and the index of each one's.
  std::vector<SceneDescription> kept_;
  std::vector<Look> looks_;
  std::vector<std::size_t> look_of_;
  std::size_t look_ = kNone;  ///< index of the one that is shown
  std::size_t ahead_index_ = kNone;
  FileStamp ahead_stamp_;
  /// Declared last: its task ends before the members that it uses are destroyed.
  std::future<SceneDescription> ahead_;
};

}  // namespace

std::unique_ptr<Animation> load_sequence(const SequenceFiles& files, const LoadOptions& options) {
  return std::make_unique<SequenceAnimation>(files, options);
}

}  // namespace raysheaf
