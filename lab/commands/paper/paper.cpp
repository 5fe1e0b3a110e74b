// Runs the experiment of the paper.
#include "lab/commands/paper/paper.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "lab/commands/paper/combinations.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::app {
namespace {

constexpr std::uint32_t kPaperSide = 512;
constexpr const char* kPaperScenes[] = {"office", "cornell", "sponza"};

struct Source {
  std::string name, path;  ///< without a path the scene is built in
};

std::vector<Source> sources(const std::string& folder) {
  std::vector<Source> all;
  if (folder.empty()) {
    for (const std::string& name : builtin_scene_names()) all.push_back({name, ""});
    return all;
  }
  namespace fs = std::filesystem;
  std::error_code ignored;
  fs::path place = folder;
  if (!fs::exists(place / "office.glb", ignored) && fs::is_directory(place / "paper", ignored))
    place /= "paper";
  for (const char* name : kPaperScenes)
    all.push_back({name, (place / (std::string(name) + ".glb")).string()});
  return all;
}

/// The paper has the reflections of CORNELL, but not those of the other scenes.
std::vector<LabRays> rays_in(const std::string& scene) {
  if (scene != "cornell") return {LabRays::kShadow};
  return {LabRays::kShadow, LabRays::kReflection1, LabRays::kReflection2};
}

RayKind kind_of(LabRays rays) {
  return rays == LabRays::kShadow ? RayKind::kShadow : RayKind::kReflection;
}

BatchStatistics brute_force_counts(LabRays rays, std::uint64_t ray_count, std::uint64_t triangles) {
  BatchStatistics counts;
  counts.kind = kind_of(rays);
  counts.bounce = rays == LabRays::kReflection2 ? 2 : 1;
  counts.rays = ray_count;
  counts.triangles = triangles;
  counts.final_tests = counts.brute_force_tests();
  return counts;
}

void add(const BatchStatistics& batch, BatchStatistics* sum) {
  sum->rays += batch.rays;
  sum->chunks += batch.chunks;
  sum->mesh_sphere_tests += batch.mesh_sphere_tests;
  sum->bound_tests += batch.bound_tests;
  sum->ray_bound_tests += batch.ray_bound_tests;
  sum->final_tests += batch.final_tests;
  sum->hits += batch.hits;
  sum->times_ms.add(batch.times_ms);
  for (std::size_t i = 0; i < std::min(sum->levels.size(), batch.levels.size()); ++i) {
    sum->levels[i].tests += batch.levels[i].tests;
    sum->levels[i].hits += batch.levels[i].hits;
  }
}

/// Combines the bounces of one scene, method and kind into one table.
void add_to_tables(const Measured& batch, std::vector<Measured>* tables) {
  for (Measured& table : *tables) {
    if (table.scene != batch.scene || table.method != batch.method ||
        table.counts.kind != batch.counts.kind)
      continue;
    add(batch.counts, &table.counts);
    table.counts.bounce = 0;
    return;
  }
  tables->push_back(batch);
}

class PaperBench {
 public:
  PaperBench(const BenchPaperCommand& command, const Tell& tell) : command_(command), tell_(tell) {
    report_.words = command.words;
    report_.builtin = command.scenes.empty();
    report_.checked = command.check;
    report_.width = command.width;
    report_.height = command.height;
    report_.threads = command.threads;
    report_.methods = command.methods.empty() ? paper_methods() : command.methods;
    if (!command.as_published) return;
    for (const Method method : {Method::kRah, Method::kCrsh}) {
      for (const Quirks& quirks : combinations_of(method))
        report_.combinations.push_back({method, quirks, {}, 0});
      for (const Quirks& quirks : phases()) report_.phases.push_back({method, quirks, {}, 0});
    }
  }

  PaperReport run() {
    const std::vector<Source> all = sources(command_.scenes);
    for (const Source& source : all)
      steps_ += rays_in(source.name).size() *
                (report_.methods.size() + report_.combinations.size() + report_.phases.size());
    for (const Source& source : all) measure(source);
    for (Combination& c : report_.combinations) c.deviation = mean_deviation(c);
    return std::move(report_);
  }

 private:
  void measure(const Source& source) {
    step(0);
    const SceneDescription scene =
        source.path.empty() ? builtin_scene(source.name) : load_scene(source.path);
    Laboratory laboratory(scene, command_.width, command_.height, command_.threads);
    report_.scenes.push_back(source.name);
    for (const LabRays rays : rays_in(source.name)) {
      for (const Method method : report_.methods)
        keep(measured(laboratory, rays, method, scene.triangle_count()), source.name, method);
      if (source.name == "cornell" && rays == LabRays::kShadow) sweep(laboratory);
      for (auto* list : {&report_.combinations, &report_.phases}) {
        for (Combination& c : *list) {
          Measured m;
          m.counts = laboratory.measure_as_published(rays, c.method, c.quirks);
          name(source.name, c.method, &m);
          add_to_tables(m, &c.tables);
          step(1);
        }
      }
    }
  }

  void sweep(Laboratory& laboratory) {
    if (!command_.as_published) return;
    for (const PublishedTable& table : published_sweep()) {
      Measured m;
      m.scene = "cornell";
      m.method = table.method;
      m.counts = laboratory.measure_as_published(LabRays::kShadow, table.method, {}, table.depth,
                                                 table.branching);
      if (compares(m.counts.triangles, table)) m.published = &table;
      report_.sweep.push_back(std::move(m));
      step(0);
    }
  }

  Measured measured(Laboratory& laboratory, LabRays rays, Method method, std::uint64_t triangles) {
    Measured m;
    if (method == Method::kBrute && !command_.check) {
      m.timed = false;
      m.counts = brute_force_counts(rays, laboratory.ray_count(rays), triangles);
    } else {
      m.counts = laboratory.measure(rays, method_settings(method), command_.check);
    }
    return m;
  }

  void keep(Measured m, const std::string& scene, Method method) {
    name(scene, method, &m);
    add_to_tables(m, &report_.tables);
    // The published figures of reflections are sums over both bounces.
    if (m.published != nullptr && m.published->bounces != 1) m.published = nullptr;
    report_.batches.push_back(std::move(m));
    step(1);
  }

  void name(const std::string& scene, Method method, Measured* m) const {
    m->scene = scene;
    m->builtin = report_.builtin;
    m->method = method;
    const PublishedTable* table = published_table(scene, method, m->counts.kind);
    if (table != nullptr && compares(m->counts.triangles, *table)) m->published = table;
  }

  /// Figures are comparable only at the paper's size and with the paper's scenes.
  [[nodiscard]] bool compares(std::uint64_t triangles, const PublishedTable& table) const {
    return !report_.builtin && report_.width == kPaperSide && report_.height == kPaperSide &&
           table.triangles == triangles;
  }

  static double mean_deviation(const Combination& combination) {
    double sum = 0;
    int tables = 0;
    for (const Measured& table : combination.tables) {
      if (table.published == nullptr) continue;
      sum += deviation(table);
      ++tables;
    }
    return tables > 0 ? sum / tables : 0;
  }

  void step(std::uint64_t steps) { tell_("measurements", done_ += steps, steps_); }

  const BenchPaperCommand& command_;
  const Tell& tell_;
  PaperReport report_;
  std::uint64_t done_ = 0, steps_ = 0;
};

}  // namespace

PaperReport measure_paper(const BenchPaperCommand& command, const Tell& tell) {
  return PaperBench(command, tell).run();
}

std::vector<Method> paper_methods() {
  std::vector<Method> all;
  for (const char* name : {"brute", "rah", "crsh", "gl10", "dual"}) {
    try {
      all.push_back(method_from_string(name));
    } catch (const Error&) {  // not in this build
    }
  }
  return all;
}

double ratio(std::uint64_t ours, const PublishedCount& published) {
  if (!published.value || *published.value == 0) return 0;
  return static_cast<double>(ours) / static_cast<double>(*published.value);
}

double total_ratio(const Measured& table) {
  if (table.published == nullptr) return 0;
  return ratio(table.counts.total_tests(), {table.published->total, false});
}

const PublishedLevel* published_level(const Measured& table, std::uint32_t level) {
  if (table.published == nullptr) return nullptr;
  for (const PublishedLevel& l : table.published->levels)
    if (l.level == level) return &l;
  return nullptr;
}

double deviation(const Measured& table) {
  double sum = 0;
  int known = 0;
  const auto add_ratio = [&](double r) {
    if (r <= 0) return;
    sum += std::fabs(std::log(r));
    ++known;
  };
  add_ratio(total_ratio(table));
  for (const LevelStatistics& level : table.counts.levels) {
    const PublishedLevel* published = published_level(table, level.level);
    if (published != nullptr) add_ratio(ratio(level.hits, published->hits));
  }
  return known > 0 ? sum / known : 0;
}

double SceneTotal::relative() const {
  return brute_force != 0 ? static_cast<double>(total) / static_cast<double>(brute_force) : 0;
}

double SceneTotal::published_relative() const {
  return published_brute_force != 0
             ? static_cast<double>(published_total) / static_cast<double>(published_brute_force)
             : 0;
}

std::vector<SceneTotal> scene_totals(const std::vector<Measured>& tables) {
  std::vector<SceneTotal> all;
  std::vector<bool> known;
  for (const Measured& m : tables) {
    auto at = std::find_if(all.begin(), all.end(), [&](const SceneTotal& t) {
      return t.scene == m.scene && t.method == m.method;
    });
    if (at == all.end()) {
      at = all.insert(all.end(), SceneTotal{m.scene, m.method, 0, 0, 0, 0});
      known.push_back(true);
    }
    const auto place = static_cast<std::size_t>(at - all.begin());
    at->total += m.counts.total_tests();
    at->brute_force += m.counts.brute_force_tests();
    known[place] = known[place] && m.published != nullptr;
    if (m.published != nullptr) {
      at->published_total += m.published->total;
      at->published_brute_force += m.published->brute_force_tests();
    }
  }
  for (std::size_t i = 0; i < all.size(); ++i)
    if (!known[i]) all[i].published_total = all[i].published_brute_force = 0;
  return all;
}

}  // namespace raysheaf::app
