// `_core.Film` renders a scene file or a built-in scene at any time into arrays of pixels.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "core.h"
#include "door.h"
#include "gil.h"
#include "interrupt.h"
#include "look.h"
#include "raysheaf/animation.h"
#include "raysheaf/backdrop.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/cameras.h"
#include "raysheaf/context.h"
#include "raysheaf/io.h"
#include "raysheaf/renderer.h"
#include "raysheaf/studio.h"

namespace raysheaf::python {
namespace {

using Pixels = nb::ndarray<const std::uint8_t, nb::shape<-1, -1, 4>, nb::c_contig, nb::device::cpu>;
using Layer = nb::ndarray<const float, nb::ndim<3>, nb::c_contig, nb::device::cpu>;

/// `moves`: whether to load animations; without them, the scene stays in its rest pose.
std::unique_ptr<Animation> animation_named(const std::string& name, bool moves) {
  const std::string prefix = "builtin:";
  if (name.starts_with(prefix)) return animate(builtin_scene(name.substr(prefix.size())));
  return moves ? load_animation(name) : animate(load_scene(name));
}

struct Rendered {
  RenderResult result;
  Image picture;
  std::vector<std::string> warnings;  ///< new ones of the scene, and of the request's environment
};

nb::dict arrays_of(Rendered* rendered) {
  const nb::capsule owner(rendered, [](void* at) noexcept { delete static_cast<Rendered*>(at); });
  const RenderResult& result = rendered->result;
  const std::size_t height = result.height, width = result.width;
  nb::dict arrays;
  arrays["rgba"] =
      array_over<std::uint8_t>(rendered->picture.rgba.data(), {height, width, 4}, owner);
  arrays["beauty"] = array_over<float>(result.beauty.data(), {height, width, 3}, owner);
  arrays["position"] = array_over<float>(result.position.data(), {height, width, 3}, owner);
  arrays["normal"] = array_over<float>(result.normal.data(), {height, width, 3}, owner);
  arrays["albedo"] = array_over<float>(result.albedo.data(), {height, width, 3}, owner);
  arrays["shadow"] = array_over<float>(result.shadow.data(), {height, width}, owner);
  arrays["ids"] = array_over<std::uint32_t>(result.ids.data(), {height, width, 3}, owner);
  arrays["exposure"] = result.exposure;
  arrays["warnings"] = rendered->warnings;
  const Gbuffer& targets = result.gbuffer;
  if (targets.position.empty()) return arrays;
  const auto texels = [&](const std::vector<Vec4>& target) {
    return array_over<float>(target.data(), {height, width, 4}, owner);
  };
  arrays["gbuffer"] = nb::make_tuple(texels(targets.position), texels(targets.normal),
                                     texels(targets.diffuse), texels(targets.specular));
  return arrays;
}

/// The side of the picture that is 0, where the other is given, follows from the camera's aspect
/// ratio.
RenderOptions completed(RenderOptions options, const Camera& camera) {
  const double shape = camera.aspect_ratio > 0 ? double{camera.aspect_ratio} : 1.0;
  const auto side = [](double pixels) {
    return static_cast<std::uint32_t>(std::clamp(std::round(pixels), 1.0, double{UINT16_MAX}));
  };
  if (options.width == 0 && options.height != 0) options.width = side(options.height * shape);
  if (options.height == 0 && options.width != 0) options.height = side(options.width / shape);
  return options;
}

void write_jpeg_of(const std::string& path, const Pixels& pixels) {
  Image image;
  image.height = static_cast<std::uint32_t>(pixels.shape(0));
  image.width = static_cast<std::uint32_t>(pixels.shape(1));
  image.rgba.assign(pixels.data(), pixels.data() + pixels.size());
  const WithoutGil released;
  write_jpeg(image, path);
}

/// Each layer has an array of one letter for each of its channels.
void write_exr_of(const std::string& path,
                  const std::vector<std::tuple<std::string, std::string, Layer>>& layers) {
  std::vector<ExrChannel> channels;
  std::uint32_t width = 0, height = 0;
  for (const auto& [prefix, letters, values] : layers) {
    height = static_cast<std::uint32_t>(values.shape(0));
    width = static_cast<std::uint32_t>(values.shape(1));
    for (std::size_t c = 0; c < letters.size(); ++c) {
      ExrChannel& channel = channels.emplace_back();
      channel.name = prefix + letters[c];
      for (std::size_t i = 0; i < std::size_t{width} * height; ++i)
        channel.values.push_back(values.data()[i * values.shape(2) + c]);
    }
  }
  const WithoutGil released;
  write_exr(width, height, std::move(channels), path);
}

/// The light from all directions; without a file and a sun, the scene's own.
struct Sky {
  std::string environment;  // a path, or empty
  // The direction to the sun; or, if it is placed, degrees north and east, and seconds since 1970.
  std::optional<std::array<double, 3>> sun;
  bool sun_is_placed = false;
  UpAxis up = UpAxis::kY;  // of the sun
  bool operator==(const Sky&) const = default;
};

/// The direction to a sky's sun.
Vec3 sun_of(const Sky& sky) {
  const auto [a, b, c] = *sky.sun;
  if (sky.sun_is_placed) return sun_direction(sun_position(a, b, c), sky.up);
  return {static_cast<float>(a), static_cast<float>(b), static_cast<float>(c)};
}

/// The options of a picture, apart from its time.
struct PictureRequest {
  RenderOptions options;
  std::optional<std::uint32_t> camera_number;  // if a number was given instead of a name
  Sky sky;
  Device device = Device::kCpu;
  Viewpoint viewpoint;
  bool has_viewpoint = false;  // use this viewpoint instead of the scene's cameras
  std::optional<std::array<std::uint8_t, 4>> background;
  bool has_ground = false;
  std::string seen_from;         // what the camera depends on: equal texts, equal cameras
  std::optional<Camera> camera;  // in none of the scene's
  std::optional<std::vector<Light>> lights;  // in the place of the scene's
};

using Triple = std::array<float, 3>;

/// `fov` is in radians.
void look_from(PictureRequest& request, const std::optional<std::string>& view,
               const std::optional<std::string>& up, const std::optional<Triple>& position,
               const std::optional<Triple>& look_at, const std::optional<float>& fov,
               bool orthographic, float zoom) {
  Viewpoint& v = request.viewpoint;
  const auto point = [](const Triple& p) { return Vec3{p[0], p[1], p[2]}; };
  if (view) v.view = view_from_string(*view);
  if (up) v.up = up_axis_from_string(*up);
  if (position) v.position = point(*position);
  if (look_at) v.look_at = point(*look_at);
  v.fov = fov;
  v.orthographic = orthographic;
  v.zoom = zoom;
  const RenderOptions& options = request.options;
  if (options.width > 0 && options.height > 0)
    v.aspect_ratio = static_cast<float>(options.width) / static_cast<float>(options.height);
  validate(v);
  request.has_viewpoint = view || up || position || look_at || fov || orthographic;
}

PictureRequest request_of(std::uint32_t width, std::uint32_t height, const std::string& camera,
                          const std::optional<std::uint32_t>& camera_number,
                          const std::string& method, bool raster, std::uint32_t bounces,
                          std::uint32_t threads, bool cuda, const std::optional<float>& exposure,
                          std::uint32_t samples, const std::optional<float>& aperture,
                          const std::optional<float>& focus, const std::string& environment) {
  PictureRequest request;
  RenderOptions& options = request.options;
  options.width = width;
  options.height = height;
  options.camera = camera;
  request.camera_number = camera_number;
  options.method = method_from_string(method);
  options.primary = raster ? Primary::kRaster : Primary::kTrace;
  options.bounces = bounces;
  options.threads = threads;
  options.exposure = exposure;
  options.samples = samples;
  options.aperture = aperture;
  options.focus = focus;
  request.sky.environment = environment;
  request.device = cuda ? Device::kCuda : Device::kCpu;
  return request;
}

/// A scene that may move, and a renderer that reuses what has not changed since the previous
/// picture. Only one Python thread renders at a time.
class Film {
 public:
  Film(const std::string& scene, bool moves)
      : moves_(moves), is_builtin_(scene.starts_with("builtin:")) {
    const WithoutGil released;
    animation_ = animation_named(scene, moves);
  }
  explicit Film(const nb::dict& scene) : moves_(false), is_builtin_(false) {
    SceneDescription description = description_of(scene);
    const WithoutGil released;
    validate(description);
    animation_ = animate(std::move(description));
  }

  /// Returns the result of `body` for the animation.
  template <class Body>
  auto at(const Body& body) {
    const WithoutGil released;
    const Door::Changing alone(door_, [&] { released.check_signals(); });
    return body(*animation_);
  }

  void play(std::uint32_t clip) {
    at([&](Animation& animation) {
      animation.play(clip);
      framed_.reset();
      ground_.reset();
    });
  }

  /// `time` is in seconds; without it, the scene stays as it is.
  [[nodiscard]] nb::dict render(PictureRequest request, const std::optional<double>& time) {
    auto rendered = std::make_unique<Rendered>();
    interruptible([&](const std::atomic<bool>& stop) {
      const Door::Changing alone(door_, [&stop] { give_up_if(stop); });
      if (request.lights) {
        animation_->scene().lights = *request.lights;
        is_studio_ = has_sun_ = false;
      }
      light_by(request.sky);
      choose(request.device, request.options.threads);
      if (is_framed(request)) frame(request);
      if (request.has_ground) request.options.ground = ground_below(request.viewpoint.up);
      if (time) {
        // A change is forgotten once the renderer has it.
        const bool leaves_vertices = is_shown_ && device_ == Device::kCuda;
        const SceneChanges changes =
            leaves_vertices ? animation_->seek_poses(*time) : animation_->seek(*time);
        if (changes.move_vertices) move_vertices_ = changes.move_vertices;
        // If the renderer does not take the changes, the next picture shows everything again.
        if (std::exchange(is_shown_, false)) {
          renderer_.show(animation_->scene(), changes);
          is_shown_ = true;
        }
      }
      if (!is_shown_) {
        if (move_vertices_) move_vertices_();
        renderer_.show(animation_->scene());
        is_shown_ = true;
      }
      request.options.progress = [&](const Progress&) { return !stop; };
      if (!request.background && animation_->scene().environment.empty())
        request.background = kNeutralBackground;
      std::optional<Backdrop> backdrop;
      if (request.background) backdrop.emplace(*request.background).watch(&request.options);
      if (!request.sky.environment.empty())
        rendered->warnings = animation_->scene().environment.warnings;
      rendered->result = result_of(request);
      rendered->picture =
          backdrop ? backdrop->picture(rendered->result) : tone_mapped(rendered->result);
      const std::vector<std::string>& all = animation_->scene().warnings;
      rendered->warnings.insert(rendered->warnings.end(), all.begin() + told_, all.end());
      told_ = std::ssize(all);
    });
    return arrays_of(rendered.release());
  }

 private:
  [[nodiscard]] RenderResult result_of(const PictureRequest& request) {
    const Camera camera = is_framed(request) ? framed_->camera : own_camera(request);
    light_for(camera, request);
    RenderOptions options = completed(request.options, camera);
    const bool by_chance =
        !animation_->scene().environment.empty() || options.aperture.value_or(camera.aperture) > 0;
    if (options.samples == 0 && !is_builtin_ && !by_chance) options.samples = kPictureSamples;
    return renderer_.render(options, camera);
  }

  /// Whether the picture uses none of the scene's cameras.
  [[nodiscard]] bool is_framed(const PictureRequest& request) {
    if (request.camera) return false;
    const bool names_none = request.options.camera.empty() && !request.camera_number;
    return request.has_viewpoint || (names_none && !has_showing_camera());
  }

  /// Whether the first camera is the default.
  [[nodiscard]] bool has_showing_camera() {
    const SceneDescription& scene = animation_->scene();
    if (!shows_ && moves_) {
      shows_ = first_camera_shows(*animation_);
      is_shown_ = false;  // that has moved the scene to other times
    }
    if (!shows_) shows_ = !scene.cameras.empty() && shows(scene.cameras.front(), scene);
    return *shows_;
  }

  /// A number that is a camera's index takes precedence over a camera of that name.
  [[nodiscard]] Camera own_camera(const PictureRequest& request) {
    if (request.camera) return zoomed(*request.camera, request.viewpoint.zoom);
    const std::vector<Camera>& cameras = animation_->scene().cameras;
    const std::size_t number = request.camera_number.value_or(cameras.size());
    return zoomed(number < cameras.size()
                      ? cameras[number]
                      : find_camera(animation_->scene(), request.options.camera),
                  request.viewpoint.zoom);
  }

  /// Finds the camera that sees the whole scene at all of its times.
  void frame(const PictureRequest& request) {
    const float aspect = request.viewpoint.aspect_ratio;
    if (framed_ && framed_->key == request.seen_from && framed_->aspect == aspect) return;
    Camera camera = moves_ ? framing_camera(*animation_, request.viewpoint)
                           : framing_camera(animation_->scene(), request.viewpoint);
    if (moves_) is_shown_ = false;  // framing has moved the scene to other times
    framed_ = Framed{std::move(camera), request.seen_from, aspect};
  }

  /// Finds the ground below the scene at all of its times.
  [[nodiscard]] Ground ground_below(UpAxis up) {
    if (!moves_) return {up, std::nullopt};
    if (!ground_ || ground_->up != up) {
      ground_ = ground_under(*animation_, up);
      is_shown_ = false;  // that has moved the scene to other times
    }
    return *ground_;
  }

  /// Lights a scene without lights for this camera; the lights stay in place until the viewpoint
  /// changes.
  void light_for(const Camera& camera, const PictureRequest& request) {
    SceneDescription& scene = animation_->scene();
    const std::string key =
        request.seen_from + request.options.camera +
        (request.camera_number ? " " + std::to_string(*request.camera_number) : std::string());
    if (is_studio_ && key == lit_for_) return;
    if (is_studio_) scene.lights.clear();
    if (!needs_light(scene)) return;
    if (move_vertices_) move_vertices_();  // the lights stand around them
    scene.lights = studio_lights(scene, camera);
    is_studio_ = true;
    lit_for_ = key;
  }

  /// Selects the device of the following pictures. On the CPU, each picture has its own number of
  /// threads.
  void choose(Device device, std::uint32_t threads) {
    if (device == device_ && (device == Device::kCpu || threads == threads_)) return;
    renderer_ = device == Device::kCuda
                    ? Renderer(Context(ContextOptions{.device = device, .threads = threads}))
                    : Renderer();
    device_ = device;
    threads_ = threads;
    is_shown_ = false;
  }

  void light_by(const Sky& sky) {
    if (is_lit_ && sky == *sky_) return;
    SceneDescription& scene = animation_->scene();
    if (!sky_) own_environment_ = scene.environment;
    if (is_studio_) scene.lights.clear();
    if (has_sun_) scene.lights.pop_back();
    is_shown_ = is_lit_ = is_studio_ = has_sun_ = false;
    scene.environment =
        sky.environment.empty() ? own_environment_ : load_environment(sky.environment);
    sky_ = sky;
    if (sky.sun) {
      add_sun_and_sky(scene, sun_of(sky), sky.up);
      has_sun_ = true;
    }
    is_lit_ = true;
  }

  struct Framed {
    Camera camera;
    std::string key;
    float aspect = 1;
  };

  const bool moves_, is_builtin_;
  std::optional<bool> shows_;  ///< whether the first camera shows the scene; the same for all clips
  Door door_;
  std::unique_ptr<Animation> animation_;
  Renderer renderer_;
  std::function<void()> move_vertices_;  ///< if a device has moved them by itself
  Device device_ = Device::kCpu;         ///< the device of the renderer
  std::uint32_t threads_ = 0;            ///< of the device's host
  Environment own_environment_;
  std::optional<Sky> sky_;  ///< of the previous picture
  std::optional<Framed> framed_;
  std::optional<Ground> ground_;
  std::string lit_for_;  ///< the picture's key for which the studio lights were placed
  bool is_lit_ = false, is_shown_ = false, is_studio_ = false;
  bool has_sun_ = false;     ///< the last of the lights
  std::ptrdiff_t told_ = 0;  ///< of the scene's warnings, which only grow
};

template <auto kMember>
auto asking() {
  return [](Film& film) {
    return film.at([](const Animation& animation) {
      return std::decay_t<decltype((animation.*kMember)())>((animation.*kMember)());
    });
  };
}

}  // namespace

void bind_render(nb::module_& module) {
  nb::class_<PictureRequest>(module, "PictureRequest")
      .def(nb::new_(&request_of), nb::arg("width"), nb::arg("height"), nb::arg("camera"),
           nb::arg("camera_number").none(), nb::arg("method"), nb::arg("raster"),
           nb::arg("bounces"), nb::arg("threads"), nb::arg("cuda"), nb::arg("exposure").none(),
           nb::arg("samples"), nb::arg("aperture").none(), nb::arg("focus").none(),
           nb::arg("environment"))
      .def("look_from", &look_from, nb::arg("view").none(), nb::arg("up").none(),
           nb::arg("position").none(), nb::arg("look_at").none(), nb::arg("fov").none(),
           nb::arg("orthographic"), nb::arg("zoom"))
      .def_rw("seen_from", &PictureRequest::seen_from)
      .def(
          "look_through",
          [](PictureRequest& request, const nb::dict& camera) {
            request.camera = camera_of(camera);
            validate_camera(*request.camera);
          },
          nb::arg("camera"))
      .def(
          "light_by",
          [](PictureRequest& request, const nb::list& lights) {
            request.lights.emplace();
            for (const nb::handle light : lights)
              request.lights->push_back(light_of(nb::cast<nb::dict>(light)));
          },
          nb::arg("lights"))
      .def(
          "shine",
          [](PictureRequest& request, const std::array<double, 3>& sun, bool is_placed) {
            request.sky.sun = sun;
            request.sky.sun_is_placed = is_placed;
            request.sky.up = request.viewpoint.up;
          },
          nb::arg("sun"), nb::arg("is_placed"))
      .def_prop_rw(
          "gbuffer", [](const PictureRequest& request) { return request.options.gbuffer; },
          [](PictureRequest& request, bool gbuffer) { request.options.gbuffer = gbuffer; },
          nb::arg("gbuffer"))
      .def_rw("has_ground", &PictureRequest::has_ground)
      .def_prop_rw(
          "background", [](const PictureRequest& request) { return request.background; },
          [](PictureRequest& request, const std::optional<std::array<std::uint8_t, 4>>& rgba) {
            request.background = rgba;
          },
          nb::arg("rgba").none());
  module.def("write_jpeg", write_jpeg_of, nb::arg("path"), nb::arg("rgba").noconvert());
  module.def("write_exr", write_exr_of, nb::arg("path"), nb::arg("layers"));
  nb::class_<Film>(module, "Film")
      .def(nb::init<const std::string&, bool>(), nb::arg("scene"), nb::arg("moves"))
      .def(nb::init<const nb::dict&>(), nb::arg("scene"))
      .def_prop_ro("start", asking<&Animation::start>())
      .def_prop_ro("end", asking<&Animation::end>())
      .def_prop_ro("frame_times", asking<&Animation::frame_times>())
      .def_prop_ro("clips", asking<&Animation::clips>())
      .def(
          "play", [](Film& film, std::uint32_t clip) { film.play(clip); }, nb::arg("clip"))
      .def("render", &Film::render, nb::arg("request"), nb::arg("time").none());
}

}  // namespace raysheaf::python
