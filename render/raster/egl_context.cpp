#include "render/raster/egl_context.h"

#include <dlfcn.h>

#define EGL_NO_X11
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "raysheaf/error.h"

namespace raysheaf {
namespace {

/// Contexts compute on CUDA's first device (exec/cuda/cuda_device.h).
constexpr EGLAttrib kCudaDevice = 0;

struct Candidate {
  std::string name;
  EGLDisplay display = EGL_NO_DISPLAY;
};

[[noreturn]] void fail(const std::string& tried) {
  throw Error(ErrorCode::kNoGraphics, "no headless OpenGL 4.5 core context is available (" + tried +
                                          "); with `trace` as `primary` none is needed");
}

bool has_word(const char* words, std::string_view word) {
  std::string_view rest = words != nullptr ? words : "";
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    if (rest.substr(0, end) == word) return true;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return false;
}

std::string with_egl_error(const char* call) {
  std::array<char, 80> text;
  std::snprintf(text.data(), text.size(), "%s failed with 0x%04x", call,
                static_cast<unsigned>(eglGetError()));
  return text.data();
}

bool can_load(const char* library) {
  void* const handle = dlopen(library, RTLD_LAZY | RTLD_LOCAL);
  if (handle != nullptr) dlclose(handle);
  return handle != nullptr;
}

/// epoxy ends the process if these libraries are missing, so this checks for them first.
void require_libraries() {
  const char* const off = std::getenv("RAYSHEAF_NO_GL");
  if (off != nullptr && *off != '\0' && std::string_view(off) != "0") fail("RAYSHEAF_NO_GL is set");
  if (!can_load("libEGL.so.1")) fail("tried to load libEGL.so.1");
  if (!can_load("libOpenGL.so.0") && !can_load("libGL.so.1")) {
    fail("tried to load libOpenGL.so.0 and libGL.so.1");
  }
}

/// Mesa creates a cache of shaders in the user's folder, also where that folder does not exist. The
/// few shaders of raysheaf compile in milliseconds. A user who wants the cache sets the variable or
/// names a folder.
void do_without_shader_cache() {
  constexpr const char* kDisable = "MESA_SHADER_CACHE_DISABLE";
  for (const char* name :
       {kDisable, "MESA_SHADER_CACHE_DIR", "MESA_GLSL_CACHE_DISABLE", "MESA_GLSL_CACHE_DIR"})
    if (std::getenv(name) != nullptr) return;
  setenv(kDisable, "true", 0);
}

/// Not through epoxy, which ends the process if an entry point is missing.
template <class Function>
Function entry_point(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

/// CUDA's number of the device in this process, including CUDA_VISIBLE_DEVICES
/// (EGL_NV_device_cuda); -1: none.
EGLAttrib cuda_number(EGLDeviceEXT device, const char* extensions) {
  const auto query = entry_point<PFNEGLQUERYDEVICEATTRIBEXTPROC>("eglQueryDeviceAttribEXT");
  EGLAttrib number = -1;
  if (query == nullptr || !has_word(extensions, "EGL_NV_device_cuda")) return -1;
  return query(device, EGL_CUDA_DEVICE_NV, &number) ? number : -1;
}

/// Adds the device on which CUDA computes first, so that it can read what is drawn.
void add_devices(PFNEGLGETPLATFORMDISPLAYEXTPROC get_display, bool software,
                 std::vector<Candidate>& candidates) {
  const auto query = entry_point<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto query_string = entry_point<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  if (query == nullptr || query_string == nullptr) return;
  std::array<EGLDeviceEXT, 32> devices;
  EGLint count = 0;
  if (!query(static_cast<EGLint>(devices.size()), devices.data(), &count)) return;
  for (EGLint i = 0; i < count; ++i) {
    const EGLDeviceEXT device = devices[static_cast<std::size_t>(i)];
    const char* const extensions = query_string(device, EGL_EXTENSIONS);
    if (has_word(extensions, "EGL_MESA_device_software") != software) continue;
    candidates.insert(
        cuda_number(device, extensions) == kCudaDevice ? candidates.begin() : candidates.end(),
        {"EGL device " + std::to_string(i), get_display(EGL_PLATFORM_DEVICE_EXT, device, nullptr)});
  }
}

/// Hardware devices, Mesa's surfaceless platform (a render node, or llvmpipe), software devices,
/// and the environment's default.
std::vector<Candidate> candidates() {
  std::vector<Candidate> list;
  const char* const client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  const auto get_display =
      has_word(client, "EGL_EXT_platform_base")
          ? entry_point<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT")
          : nullptr;
  const bool devices =
      get_display != nullptr && has_word(client, "EGL_EXT_platform_device") &&
      (has_word(client, "EGL_EXT_device_base") || (has_word(client, "EGL_EXT_device_query") &&
                                                   has_word(client, "EGL_EXT_device_enumeration")));
  if (devices) add_devices(get_display, false, list);
  if (get_display != nullptr && has_word(client, "EGL_MESA_platform_surfaceless")) {
    list.push_back({"Mesa's surfaceless platform",
                    get_display(EGL_PLATFORM_SURFACELESS_MESA,
                                reinterpret_cast<void*>(EGL_DEFAULT_DISPLAY), nullptr)});
  }
  if (devices) add_devices(get_display, true, list);
  list.push_back({"the default display", eglGetDisplay(EGL_DEFAULT_DISPLAY)});
  return list;
}

/// Returns a context, or none and a `reason`.
EGLContext create_context(EGLDisplay display, std::string& reason) {
  EGLint major = 0, minor = 0;
  if (display == EGL_NO_DISPLAY) {
    reason = "no such display";
    return EGL_NO_CONTEXT;
  }
  if (!eglInitialize(display, &major, &minor)) {
    reason = with_egl_error("eglInitialize");
    return EGL_NO_CONTEXT;
  }
  const char* const extensions = eglQueryString(display, EGL_EXTENSIONS);
  const bool versions = major > 1 || minor >= 5 || has_word(extensions, "EGL_KHR_create_context");
  const bool bare = has_word(extensions, "EGL_KHR_surfaceless_context") &&
                    (has_word(extensions, "EGL_KHR_no_config_context") ||
                     has_word(extensions, "EGL_MESA_configless_context"));
  if (!versions || !bare) {
    reason = "no contexts without surfaces";
    return EGL_NO_CONTEXT;
  }
  const std::array<EGLint, 7> wanted = {EGL_CONTEXT_MAJOR_VERSION,
                                        4,
                                        EGL_CONTEXT_MINOR_VERSION,
                                        5,
                                        EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                        EGL_NONE};
  const EGLContext context =
      eglBindAPI(EGL_OPENGL_API)
          ? eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted.data())
          : EGL_NO_CONTEXT;
  if (context == EGL_NO_CONTEXT) reason = with_egl_error("eglCreateContext");
  return context;
}

}  // namespace

EglContext::EglContext() {
  require_libraries();
  do_without_shader_cache();
  const EGLenum api = eglQueryAPI();
  std::string tried;
  for (const Candidate& candidate : candidates()) {
    std::string reason;
    const EGLContext context = create_context(candidate.display, reason);
    if (context != EGL_NO_CONTEXT) {
      display_ = candidate.display;
      context_ = context;
      break;
    }
    tried += (tried.empty() ? "tried " : ", ") + candidate.name + ": " + reason;
  }
  eglBindAPI(api);
  if (context_ == nullptr) fail(tried);
}

EglContext::~EglContext() {
  eglDestroyContext(display_, context_);
}

EglContext::Current::Current(const EglContext& context) : context_(context), api_(eglQueryAPI()) {
  eglBindAPI(EGL_OPENGL_API);
  display_ = eglGetCurrentDisplay();
  draw_ = eglGetCurrentSurface(EGL_DRAW);
  read_ = eglGetCurrentSurface(EGL_READ);
  previous_ = eglGetCurrentContext();
  if (eglMakeCurrent(context.display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context.context_)) return;
  const std::string reason = with_egl_error("eglMakeCurrent");
  eglBindAPI(api_);
  fail(reason);
}

EglContext::Current::~Current() {
  eglBindAPI(EGL_OPENGL_API);
  if (previous_ != EGL_NO_CONTEXT) {
    eglMakeCurrent(display_, draw_, read_, previous_);
  } else {
    eglMakeCurrent(context_.display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }
  eglBindAPI(api_);
}

}  // namespace raysheaf
