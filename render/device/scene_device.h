// A scene's surfaces and the sums of an image in a device's memory. For sources that include a
// device.
#pragma once

#include <vector>

#include "render/device/frame_stages.h"
#include "render/device/stage_loops_device.h"

namespace raysheaf {

template <class Device, class T>
void upload(Device& device, View<const T> from, DeviceBuffer<T>* to) {
  upload(device, "copy: scene", from, to);
}

template <class Device>
class SceneOnDevice {
 public:
  explicit SceneOnDevice(Device& device) : device_(device) {}

  /// Copies everything that belongs to the triangles except their corners.
  void set_geometry(const FlatScene& scene, const StagedScene& staged) {
    upload(device_, View<const std::uint32_t>(scene.mesh_of_triangle.data(), scene.triangle_count),
           &mesh_of_triangle_);
    upload(device_, View<const StagedMesh>(staged.meshes), &meshes_);
    upload(device_, View<const StagedTriangle>(staged.triangles), &triangles_);
    upload(device_, View<const Vec3>(staged.normals), &normals_);
    upload(device_, View<const Vec2>(staged.uvs), &uvs_);
    upload(device_, View<const Vec2>(staged.second_uvs), &second_uvs_);
    upload(device_, View<const Vec3>(staged.colors), &colors_);
    upload(device_, View<const float>(staged.alphas), &alphas_);
    upload(device_, View<const std::uint32_t>(staged.material_numbers), &material_numbers_);
    device_.synchronize("copy: scene");
  }

  /// Marks materials, textures and the environment as outdated.
  void forget_looks() { has_looks_ = false; }
  /// Copies materials, textures and the environment, unless they are up to date.
  void set_looks(const StagedScene& staged, const TextureTable& textures,
                 const EnvironmentView& environment) {
    if (has_looks_) return;
    upload(device_, View<const PlacedMaterial>(staged.materials), &materials_);
    set_textures(textures);
    set_environment(environment);
    device_.synchronize("copy: scene");
    has_looks_ = true;
  }

  [[nodiscard]] StagedSceneView view(View<const Vec3> corners) const {
    return {corners,
            mesh_of_triangle_.view_const(),
            meshes_.view_const(),
            triangles_.view_const(),
            normals_.view_const(),
            uvs_.view_const(),
            second_uvs_.view_const(),
            colors_.view_const(),
            alphas_.view_const(),
            material_numbers_.view_const(),
            materials_.view_const(),
            {textures_.view_const(), decoding_.data(), decoding_.data() + 256}};
  }

  /// The triangles of all meshes, one mesh after the other.
  [[nodiscard]] View<const StagedTriangle> triangles() const { return triangles_.view_const(); }
  /// One an instance, to be written by the device.
  [[nodiscard]] StagedMesh* meshes() { return meshes_.data(); }
  /// The meshes' vertices', likewise.
  [[nodiscard]] Vec3* normals() { return normals_.data(); }

  /// Without radiance where the scene has none.
  [[nodiscard]] const EnvironmentView& environment() const { return environment_; }

 private:
  void set_environment(const EnvironmentView& sky) {
    environment_ = {};
    const std::size_t texels = std::size_t{sky.width} * sky.height;
    const std::size_t chosen = sky.row_ends != nullptr ? texels : 0;
    const std::size_t rows = sky.row_ends != nullptr ? sky.height : 0;
    upload(device_, View<const Vec3>(sky.radiance, texels), &radiance_);
    upload(device_, View<const float>(sky.row_ends, rows), &row_ends_);
    upload(device_, View<const float>(sky.texel_ends, chosen), &texel_ends_);
    if (texels == 0) return;
    environment_ = sky;
    environment_.radiance = radiance_.data();
    environment_.row_ends = chosen != 0 ? row_ends_.data() : nullptr;
    environment_.texel_ends = chosen != 0 ? texel_ends_.data() : nullptr;
  }

  /// Copies the pixels of all textures consecutively, and the tables that decode bytes.
  void set_textures(const TextureTable& table) {
    std::vector<TextureView> views(table.textures.begin(), table.textures.end());
    const auto bytes_of = [](const TextureView& view) {
      return std::size_t{4} * view.width * view.height;
    };
    std::size_t bytes = 0;
    for (const TextureView& view : views) bytes += bytes_of(view);
    texels_.resize_uninitialized("copy: textures", bytes);
    std::uint8_t* at = texels_.data();
    for (TextureView& view : views) {
      device_.copy("copy: textures", at, view.rgba, bytes_of(view));
      view.rgba = at;
      at += bytes_of(view);
    }
    upload(device_, View<const TextureView>(views), &textures_);
    std::vector<float> decoding(table.from_srgb, table.from_srgb + 256);
    decoding.insert(decoding.end(), table.as_is, table.as_is + 256);
    upload(device_, View<const float>(decoding), &decoding_);
  }

  Device& device_;
  DeviceAllocator& memory_ = device_.allocator();
  DeviceBuffer<std::uint32_t> mesh_of_triangle_{memory_};
  DeviceBuffer<StagedMesh> meshes_{memory_};
  DeviceBuffer<StagedTriangle> triangles_{memory_};
  DeviceBuffer<Vec3> normals_{memory_};
  DeviceBuffer<Vec2> uvs_{memory_}, second_uvs_{memory_};
  DeviceBuffer<Vec3> colors_{memory_};
  DeviceBuffer<float> alphas_{memory_};
  DeviceBuffer<std::uint32_t> material_numbers_{memory_};
  DeviceBuffer<PlacedMaterial> materials_{memory_};
  DeviceBuffer<TextureView> textures_{memory_};
  DeviceBuffer<std::uint8_t> texels_{memory_};
  DeviceBuffer<float> decoding_{memory_};  ///< `from_srgb`, then `as_is`
  EnvironmentView environment_;
  bool has_looks_ = false;
  DeviceBuffer<Vec3> radiance_{memory_};
  DeviceBuffer<float> row_ends_{memory_}, texel_ends_{memory_};
};

/// Fragments on a device: the first `count` elements of the buffer.
struct DeviceSet : FragmentSet {
  explicit DeviceSet(DeviceAllocator& allocator)
      : fragments(allocator), radiance(allocator), going_on(allocator) {}
  [[nodiscard]] std::size_t size() const override { return count; }
  [[nodiscard]] View<const Fragment> view() const { return {fragments.data(), count}; }

  DeviceBuffer<Fragment> fragments;
  DeviceBuffer<Vec3> radiance;          ///< set by `glow`
  DeviceBuffer<std::uint8_t> going_on;  ///< bits (`bit_of`) of kinds; empty if all paths end
  std::size_t count = 0;
};

/// The counterpart of `Film` (render/picture/film.h).
template <class Device>
class FilmOnDevice {
 public:
  explicit FilmOnDevice(Device& device) : device_(device) {}

  void begin(std::uint32_t width, std::uint32_t height, bool count_tests) {
    width_ = width;
    height_ = height;
    samples_ = 0;
    for (DeviceBuffer<Vec3>* sums : {&beauty_, &position_, &normal_, &albedo_, &specular_}) {
      sums->resize_uninitialized("film", std::size_t{width} * height);
      device_.fill("film", sums->view(), 0);
    }
    for (DeviceBuffer<std::uint32_t>* counts : {&triangle_, &faced_, &arrived_}) {
      counts->resize_uninitialized("film", std::size_t{width} * height);
      device_.fill("film", counts->view(), 0);
    }
    tests_.resize_uninitialized("film", count_tests ? std::size_t{width} * height : 0);
    device_.fill("film", tests_.view(), 0);
    device_.synchronize("film");
  }

  void see(View<const Fragment> first_hits) {
    see_on(device_, first_hits, samples_++ == 0, view());
  }

  [[nodiscard]] DeviceFilm view() const {
    return {beauty_.data(),   position_.data(), normal_.data(), albedo_.data(),
            specular_.data(), triangle_.data(), faced_.data(),  arrived_.data()};
  }

  /// For each pixel; empty if no tests are counted.
  [[nodiscard]] View<std::uint64_t> tests() { return tests_.view(); }

  [[nodiscard]] FilmSums sums(const Executor& executor, const FlatScene& scene) {
    FilmSums film;
    RenderResult& result = film.result;
    result.width = width_;
    result.height = height_;
    result.samples = samples_;
    download(beauty_, &result.beauty);
    download(position_, &result.position);
    download(normal_, &result.normal);
    download(albedo_, &result.albedo);
    download(specular_, &result.specular);
    download(faced_, &film.faced);
    download(arrived_, &film.arrived);
    std::vector<std::uint32_t> seen;
    download(triangle_, &seen);
    std::vector<std::uint64_t> tests;
    download(tests_, &tests);
    device_.synchronize("copy: picture");
    result.tests.assign(tests.begin(), tests.end());
    result.ids.assign(seen.size(), {});
    executor.for_each(seen.size(), kCopyGrain, [&](std::size_t i) {
      if (seen[i] != kInvalidId) result.ids[i] = ids_of(scene, scene.at(seen[i]));
    });
    return film;
  }

 private:
  template <class T>
  void download(const DeviceBuffer<T>& from, std::vector<T>* to) {
    to->resize(from.size());
    device_.copy("copy: picture", to->data(), from.data(), from.size() * sizeof(T));
  }

  Device& device_;
  DeviceAllocator& memory_ = device_.allocator();
  std::uint32_t width_ = 0, height_ = 0, samples_ = 0;
  DeviceBuffer<Vec3> beauty_{memory_}, position_{memory_}, normal_{memory_}, albedo_{memory_},
      specular_{memory_};
  DeviceBuffer<std::uint32_t> triangle_{memory_}, faced_{memory_}, arrived_{memory_};
  DeviceBuffer<std::uint64_t> tests_{memory_};
};

}  // namespace raysheaf
