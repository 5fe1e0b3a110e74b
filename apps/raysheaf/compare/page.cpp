#include "compare/page.h"

#include <fmt/format.h>

#include <algorithm>

#include "compare/plots.h"
#include "console.h"
#include "plot/svg.h"
#include "table.h"

namespace raysheaf::app {
namespace {

template <typename Word>
std::vector<Word> chosen(const std::vector<Word>& given, std::vector<Word> all) {
  return given.empty() ? all : given;
}

std::vector<CompareMode> modes_of(const CompareReport& report) {
  return chosen(report.command.modes, all_compare_modes());
}

std::vector<CompareKind> kinds_of(const CompareReport& report) {
  return chosen(report.command.kinds, all_compare_kinds());
}

const char* kind_text(CompareKind kind) {
  switch (kind) {
    case CompareKind::kShadow:
      return "shadow";
    case CompareKind::kMirror:
      return "mirror reflection";
    case CompareKind::kSecond:
      return "second bounce";
    case CompareKind::kAmbientOcclusion:
      return "ambient occlusion";
    case CompareKind::kRandom:
      break;
  }
  return "random";
}

const char* mode_text(CompareMode mode) {
  switch (mode) {
    case CompareMode::kRebuild:
      return "Rebuild: new vertices and indices in every frame";
    case CompareMode::kRefit:
      return "Refit: new vertices in every frame, the same indices";
    case CompareMode::kStatic:
      break;
  }
  return "Static: only the rays are new";
}

std::vector<std::string> scenes_of(const CompareReport& report) {
  std::vector<std::string> names;
  for (const CompareCase& c : report.cases)
    if (std::find(names.begin(), names.end(), label_of(c)) == names.end())
      names.push_back(label_of(c));
  return names;
}

/// The sizes, if several were compared; otherwise one empty text.
std::vector<std::string> sizes_of(const CompareReport& report) {
  std::vector<std::string> sizes;
  for (const CompareCase& c : report.cases) {
    const std::string size = c.one_of_sizes ? size_text(c.size) : "";
    if (std::find(sizes.begin(), sizes.end(), size) == sizes.end()) sizes.push_back(size);
  }
  return sizes;
}

const CompareCase* find_case(const CompareReport& report, const std::string& scene,
                             CompareMode mode, CompareKind kind) {
  for (const CompareCase& c : report.cases)
    if (label_of(c) == scene && c.mode == mode && c.kind == kind) return &c;
  return nullptr;
}

std::uint64_t triangles_of(const CompareReport& report, const std::string& scene) {
  for (const CompareCase& c : report.cases)
    if (label_of(c) == scene) return c.triangles;
  return 0;
}

/// "0.42", "**0.62** (0.5)" above its limit, with "≠" where hits differ.
std::string ratio_cell(const CompareCase* c) {
  if (c == nullptr) return "";
  std::string text = three_digits(c->peer.ratio);
  if (misses_limit(*c)) text = fmt::format("**{}** ({:g})", text, *limit_of(*c));
  return c->peer.hits.equal() ? text : text + " ≠";
}

std::string peer_text(const PeerResult& peer) {
  return peer.version + " " + peer.way;
}

std::string heading(const CompareReport& report) {
  std::string line = "| Scene | Triangles |", rule = "|---|---:|";
  for (const CompareKind kind : kinds_of(report)) {
    line += fmt::format(" {} |", kind_text(kind));
    rule += "---:|";
  }
  return line + "\n" + rule + "\n";
}

std::string mean_row(const CompareReport& report, const std::string& row, const std::string& name) {
  std::string line = fmt::format("| *{}* | |", name);
  bool any = false;
  for (const CompareKind kind : kinds_of(report)) {
    const double mean = mean_ratio(
        report.cases, [&](const CompareCase& c) { return row_of(c) == row && c.kind == kind; });
    any = any || mean > 0;
    line += mean > 0 ? fmt::format(" *{}* |", three_digits(mean)) : " |";
  }
  return any ? line + "\n" : "";
}

std::string ratio_table(const CompareReport& report, CompareMode mode) {
  std::string text = heading(report);
  for (const std::string& scene : scenes_of(report)) {
    text += fmt::format("| {} | {} |", printable(scene), triangles_of(report, scene));
    for (const CompareKind kind : kinds_of(report))
      text += fmt::format(" {} |", ratio_cell(find_case(report, scene, mode, kind)));
    text += "\n";
  }
  for (const std::string& size : sizes_of(report)) {
    const std::string row = size.empty() ? "" : "_" + size, name = size.empty() ? "" : " " + size;
    text += mean_row(report, to_string(mode) + row, "geometric mean" + name);
    if (mode == CompareMode::kRebuild)
      text +=
          mean_row(report, "rebuild_large" + row, "geometric mean, 1 M triangles and more" + name);
  }
  return text + "\n";
}

std::string time_table(const CompareReport& report, CompareMode mode) {
  std::string text =
      "| Scene | Rays | Update | Order | Hierarchy | Trace | raysheaf, all | Plan | Embree: build "
      "| Trace | Embree, all | Embree's call "
      "|\n|---|---|---:|---:|---:|---:|---:|---|---:|---:|---:|---|\n";
  for (const CompareCase& c : report.cases) {
    if (c.mode != mode) continue;
    text += fmt::format("| {} | {} {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
                        printable(label_of(c)), c.rays, to_string(c.kind),
                        three_digits(c.ours_ms.update), three_digits(c.ours_ms.order),
                        three_digits(c.ours_ms.hierarchy), three_digits(c.ours_ms.trace),
                        three_digits(c.ours_ms.total), short_plan(c.plan),
                        three_digits(c.peer.ms.build), three_digits(c.peer.ms.trace),
                        three_digits(c.peer.ms.total), peer_text(c.peer));
  }
  return text + "\n";
}

std::string hits_paragraph(const CompareReport& report) {
  std::uint64_t compared = 0, mismatches = 0, sampled = 0, wrong = 0, unequal = 0;
  std::uint64_t settled = 0, ours_right = 0, peer_right = 0;
  for (const CompareCase& c : report.cases) {
    compared += c.peer.hits.compared;
    mismatches += c.peer.hits.mismatches;
    settled += c.peer.hits.settled;
    ours_right += c.peer.hits.ours_right;
    peer_right += c.peer.hits.peer_right;
    sampled += c.peer.hits.sampled;
    wrong += c.peer.hits.sample_mismatches;
    unequal += c.peer.hits.equal() ? 0 : 1;
  }
  return fmt::format(
      "**Hits.** Embree answers {} of {} rays differently. Exact arithmetic on the floats as given "
      "decided {} of these: raysheaf is right in {}, Embree in {}. The hits of a case count as "
      "equal if at most one ray in 10 000 "
      "differs; {} cases exceed this (marked ≠). Brute force answered {} of the rays too; {} "
      "differ.\n\n",
      mismatches, compared, settled, ours_right, peer_right,
      unequal == 0 ? "no" : std::to_string(unequal), sampled,
      wrong == 0 ? "none" : std::to_string(wrong));
}

std::string limits_paragraph(const CompareReport& report) {
  std::uint64_t held = 0, missed = 0;
  for (const CompareCase& c : report.cases)
    if (limit_of(c)) ++(misses_limit(c) ? missed : held);
  if (held + missed == 0) return "";
  return fmt::format(
      "**Limits.** The project sets itself a limit for most cases. {} cases keep it; {} exceed it "
      "and "
      "are bold, with the limit in brackets.\n\n",
      held, missed);
}

std::string memory_table(const CompareReport& report) {
  std::string text =
      "| Scene | Mode | raysheaf, MiB | bytes a triangle | Embree, MiB | bytes a triangle |\n"
      "|---|---|---:|---:|---:|---:|\n";
  for (const std::string& scene : scenes_of(report)) {
    for (const CompareMode mode : modes_of(report)) {
      std::uint64_t ours = 0, peer = 0;
      for (const CompareCase& c : report.cases) {
        if (label_of(c) != scene || c.mode != mode) continue;
        ours = std::max(ours, c.our_bytes);
        peer = std::max(peer, c.peer.bytes);
      }
      if (ours + peer == 0) continue;
      const double count = static_cast<double>(triangles_of(report, scene));
      const auto mebibytes = [](std::uint64_t b) { return static_cast<double>(b) / (1 << 20); };
      text += fmt::format("| {} | {} | {:.1f} | {:.0f} | {:.1f} | {:.0f} |\n", printable(scene),
                          to_string(mode), mebibytes(ours), static_cast<double>(ours) / count,
                          mebibytes(peer), static_cast<double>(peer) / count);
    }
  }
  return "## Memory\n\nraysheaf's figure includes buffers that queries keep for the next query, "
         "and grows with the number of rays. Arrays of the caller are not counted on either "
         "side.\n\n" +
         text + "\n";
}

std::string growth_table(const CompareReport& report) {
  std::string text =
      "| Along | Mode | Rays | From | To | raysheaf, ms | Embree, ms | raysheaf, steepest | "
      "Embree, steepest |\n|---|---|---|---:|---:|---:|---:|---:|---:|\n";
  for (const char* along : {"triangles", "rays"}) {
    for (const CompareMode mode : modes_of(report)) {
      for (const CompareKind kind : kinds_of(report)) {
        const std::vector<const CompareCase*> line = growth_line(report, along, mode, kind);
        if (line.size() < 2) continue;
        const bool rays = std::string(along) == "rays";
        const auto count = [&](const CompareCase* c) { return rays ? c->rays : c->triangles; };
        text += fmt::format(
            "| {} | {} | {} | {} | {} | {} to {} | {} to {} | {:.2f} | {:.2f} |\n", along,
            to_string(mode), kind_text(kind), count(line.front()), count(line.back()),
            three_digits(line.front()->ours_ms.total), three_digits(line.back()->ours_ms.total),
            three_digits(line.front()->peer.ms.total), three_digits(line.back()->peer.ms.total),
            steepest(line, along, false), steepest(line, along, true));
      }
    }
  }
  return text + "\n";
}

std::string introduction(const CompareReport& report) {
  return fmt::format(
      "`raysheaf bench compare` runs raysheaf and {} in one process, alternating, with {} "
      "threads each, and writes this page. A ratio is raysheaf's time divided by Embree's, the "
      "median over {} rounds: below 1, raysheaf is faster. If two versions of Embree are "
      "installed, the faster one counts in each case, and the table names it. Times are medians in "
      "milliseconds. They cover everything that a frame needs on both sides: updates of the scene, "
      "hierarchies, reading the rays from the caller's array, and writing the hits in the caller's "
      "order. For each case, Embree was tried with every build and call that may be its fastest, "
      "and the fastest counts.\n\n",
      report.peer, report.threads, report.command.runs);
}

std::string command_of(const CompareReport& report) {
  const BenchCompareCommand& c = report.command;
  std::string text = "raysheaf bench compare";
  if (!c.scenes.empty()) text += " --scenes DIR";
  for (const std::string& scene : c.scene_names) text += " --scene " + printable(scene);
  for (const CompareKind kind : c.kinds) text += fmt::format(" --kind {}", to_string(kind));
  for (const CompareMode mode : c.modes) text += fmt::format(" --mode {}", to_string(mode));
  if (c.growth) text += fmt::format(" --growth --most {}", c.most);
  for (const ImageSize& size : c.sizes) text += " --size " + size_text(size);
  return "<!-- not run -->\n```sh\n" + text + " --markdown FILE.md\n```\n\n";
}

std::string notes_of(const CompareReport& report) {
  std::string text;
  for (const std::string& note : report.notes) text += "* " + printable(note) + ".\n";
  return text.empty() ? text : text + "\n";
}

std::string growth_page(const CompareReport& report) {
  return "## Growth\n\nThe scenes are generated halls of the same shape. *Steepest* is the largest "
         "exponent p between two consecutive points, half a decade apart, if time grows as "
         "count^p: 1 is linear.\n\n" +
         growth_table(report);
}

}  // namespace

std::string compare_page(const CompareReport& report, const std::string& plot) {
  std::string page =
      "# raysheaf and Embree, case by case\n\n" + introduction(report) + command_of(report);
  if (!plot.empty()) page += fmt::format("![The figures as a plot]({})\n\n", plot);
  page += notes_of(report);
  if (!report.growth.empty()) page += growth_page(report);
  if (!report.cases.empty()) {
    page += limits_paragraph(report) + hits_paragraph(report);
    for (const CompareMode mode : modes_of(report))
      page += fmt::format("## {}\n\n", mode_text(mode)) + ratio_table(report, mode) +
              time_table(report, mode);
    page += memory_table(report);
  }
  page += fmt::format(
      "The process used at most {:.0f} MiB, which includes both libraries, the scene, and the "
      "preparation of the rays.\n",
      static_cast<double>(report.peak_bytes) / (1 << 20));
  return page;
}

std::string compare_text(const CompareReport& report) {
  std::string text =
      fmt::format("compared with {}, {} threads, medians of {} rounds; * exceeds its limit\n",
                  report.peer, report.threads, report.command.runs);
  Table table({"scene", "triangles", "mode", "kind", "rays", "ours ms", "peer ms", "ratio", "limit",
               "hits", "peer", "plan"});
  const auto add = [&](const CompareCase& c) {
    const std::optional<double> limit = limit_of(c);
    table.add({printable(c.scene), std::to_string(c.triangles), to_string(c.mode),
               to_string(c.kind), std::to_string(c.rays), three_digits(c.ours_ms.total),
               three_digits(c.peer.ms.total),
               three_digits(c.peer.ratio) + (misses_limit(c) ? "*" : ""),
               limit ? fmt::format("{:g}", *limit) : "",
               c.peer.hits.equal() ? "equal" : fmt::format("{} differ", c.peer.hits.mismatches),
               peer_text(c.peer), short_plan(c.plan)});
  };
  for (const CompareCase& c : report.cases) add(c);
  for (const GrowthCase& g : report.growth) add(g.measured);
  text += table.text();
  for (const std::string& note : report.notes) text += printable(note) + "\n";
  return text;
}

}  // namespace raysheaf::app
