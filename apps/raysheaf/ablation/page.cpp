#include "ablation/page.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "ablation/findings.h"
#include "ablation/pivot.h"
#include "ablation/plots.h"
#include "plot/svg.h"
#include "table.h"

namespace raysheaf::app {
namespace {

const auto kAny = [](const Pairing&) { return true; };

std::string pair_text(const MethodSettings& s) {
  return fmt::format("`{}` with `{}`", to_string(s.key), to_string(s.bound));
}

std::string pair_with_bits(const MethodSettings& s) {
  const std::string bits = comes_in_both_widths(s.key) ? fmt::format(" ({} bits)", s.key_bits) : "";
  return fmt::format("`{}`{}, `{}`", to_string(s.key), bits, to_string(s.bound));
}

std::string factor_text(double factor) {
  return factor > 0 ? three_digits(factor) : "";
}

std::vector<std::vector<Pairing>> all_pairings(const AblationReport& report) {
  std::vector<std::vector<Pairing>> all;
  for (const LabRays rays : report.command.rays) {
    all.push_back(pairings(report, rays));
    if (all.back().empty()) all.pop_back();
  }
  return all;
}

std::string winners_table(const std::vector<std::vector<Pairing>>& kinds) {
  std::string text =
      "| Rays | Fewest tests | % | fewer than `crsh` | Least time | ms | quicker than `crsh` |\n"
      "|---|---|---:|---:|---|---:|---:|\n";
  for (const std::vector<Pairing>& all : kinds) {
    const Pairing* fewest = least(all, &Pairing::percent, kAny);
    const Pairing* quickest = least(all, &Pairing::ms, kAny);
    const Pairing* crsh = crsh_pairing(all);
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", rays_text(fewest->rays),
                        pair_with_bits(fewest->settings), three_digits(fewest->percent),
                        crsh != nullptr ? factor_text(crsh->percent / fewest->percent) + " ×" : "",
                        pair_with_bits(quickest->settings), three_digits(quickest->ms),
                        crsh != nullptr ? factor_text(crsh->ms / quickest->ms) + " ×" : "");
  }
  return text;
}

/// The winners for each kind of rays, with reasons; kinds with the same winner share a line.
std::string tests_list(const std::vector<std::vector<Pairing>>& kinds) {
  std::vector<std::pair<MethodSettings, std::vector<std::string>>> winners;
  for (const std::vector<Pairing>& all : kinds) {
    const Pairing* best = least(all, &Pairing::percent, kAny);
    const auto known = std::find_if(winners.begin(), winners.end(), [best](const auto& winner) {
      return pair_text(winner.first) == pair_text(best->settings);
    });
    if (known == winners.end())
      winners.push_back({best->settings, {rays_text(best->rays)}});
    else
      known->second.push_back(rays_text(best->rays));
  }
  std::string text;
  for (const auto& [settings, rays] : winners)
    text += fmt::format("* **{}** for {}: {}; {}.\n", pair_text(settings), fmt::join(rays, "; "),
                        reason(settings.key), reason(settings.bound));
  return text;
}

/// Where a more expensive test loses.
std::string time_sentence(const std::vector<std::vector<Pairing>>& kinds) {
  std::string text;
  for (const std::vector<Pairing>& all : kinds) {
    const Pairing* fewest = least(all, &Pairing::percent, kAny);
    const Pairing* quickest = least(all, &Pairing::ms, kAny);
    if (fewest == quickest) {
      text += fmt::format(" For {} the settings with the fewest tests also take the least time.",
                          rays_text(fewest->rays));
      continue;
    }
    text += fmt::format(
        " For {}, {} makes {} times the tests of the settings with the fewest, and takes {} of "
        "their time.",
        rays_text(fewest->rays), pair_text(quickest->settings),
        three_digits(quickest->percent / fewest->percent),
        three_digits(100 * quickest->ms / fewest->ms) + " %");
  }
  return text;
}

std::string bounds_table(const AblationReport& report,
                         const std::vector<std::vector<Pairing>>& kinds) {
  std::string head = "| Bound |", rule = "\n|---|", lines;
  for (const std::vector<Pairing>& all : kinds) {
    head += fmt::format(" {} |", rays_text(all.front().rays));
    rule += "---:|";
  }
  for (const BundleBound bound : report.command.bounds) {
    if (bound == BundleBound::kSphereCone) continue;
    lines += fmt::format("| `{}` |", to_string(bound));
    for (const std::vector<Pairing>& all : kinds)
      lines +=
          fmt::format(" {} / {} |", factor_text(against_sphere_cone(all, bound, &Pairing::percent)),
                      factor_text(against_sphere_cone(all, bound, &Pairing::ms)));
    lines += "\n";
  }
  return head + rule + "\n" + lines;
}

/// Bound and key must match: lists the best key of each bound.
std::string matches_table(const AblationReport& report,
                          const std::vector<std::vector<Pairing>>& kinds) {
  std::string head = "| Bound |", rule = "\n|---|", lines;
  for (const std::vector<Pairing>& all : kinds) {
    head += fmt::format(" {} |", rays_text(all.front().rays));
    rule += "---|";
  }
  for (const BundleBound bound : report.command.bounds) {
    lines += fmt::format("| `{}` |", to_string(bound));
    for (const std::vector<Pairing>& all : kinds) {
      const Pairing* best = least(all, &Pairing::percent,
                                  [bound](const Pairing& p) { return p.settings.bound == bound; });
      if (best == nullptr)
        lines += " |";
      else
        lines +=
            fmt::format(" `{}` {} |", to_string(best->settings.key), three_digits(best->percent));
    }
    lines += "\n";
  }
  return head + rule + "\n" + lines;
}

std::string enumerated(const std::vector<std::string>& parts) {
  std::string all;
  for (std::size_t i = 0; i < parts.size(); ++i)
    all += (i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ") + parts[i];
  return all;
}

template <typename Values, typename Name>
std::string list_option(const char* option, const Values& chosen, const Values& usual, Name name) {
  if (chosen == usual) return "";
  std::string text;
  for (const auto value : chosen) text += (text.empty() ? "" : ",") + std::string(name(value));
  return fmt::format(" {} {}", option, text);
}

std::string command_text(const BenchAblationCommand& c) {
  const BenchAblationCommand usual;
  const auto number = [](std::uint32_t n) { return std::to_string(n); };
  std::string text = "raysheaf bench ablation";
  if (!c.scenes.empty()) text += " --scenes DIR";
  if (!c.scene.empty()) text += c.scene.starts_with("builtin:") ? " " + c.scene : " SCENE";
  text += list_option("--rays", c.rays, all_lab_rays(), [](LabRays r) { return to_string(r); });
  text += list_option("--keys", c.keys, all_keys(), [](RayKey k) { return to_string(k); });
  text += list_option("--key-bits", c.key_bits, usual.key_bits, number);
  text +=
      list_option("--bounds", c.bounds, all_bounds(), [](BundleBound b) { return to_string(b); });
  text += list_option("--levels", c.levels, usual.levels, number);
  text += list_option("--branching", c.branching, usual.branching, number);
  if (c.mesh_culling != usual.mesh_culling)
    text += c.mesh_culling.size() > 1 ? " --mesh-culling both" : " --mesh-culling off";
  if (c.width != usual.width || c.height != usual.height)
    text += fmt::format(" --size {}x{}", c.width, c.height);
  if (c.repeat != usual.repeat) text += fmt::format(" --repeat {}", c.repeat);
  return "<!-- not run -->\n```sh\n" + text + " --svg FILE.svg --markdown FILE.md\n```\n";
}

std::string introduction(const AblationReport& report) {
  const BenchAblationCommand& c = report.command;
  std::vector<std::string> scenes;
  for (const std::string& scene : report.scenes) scenes.push_back("`" + scene + "`");
  return fmt::format(
      "This page combines every key that rays can be sorted by ([keys](../keys.md)) with every "
      "bounding volume of a bundle of "
      "rays ([bounds](../bounds.md)), on {}, at {}x{} pixels; {}. Tests are counted as in the "
      "paper, as a percentage of "
      "brute force, without tests of meshes. Times are milliseconds for order, hierarchy and trace "
      "on "
      "{}, {}. Percentages fall as images grow, because their rays lie closer together. Figures "
      "for several "
      "scenes are geometric means. Shadow rays come from the scene's "
      "lights; every surface is a mirror; ambient occlusion sends four rays from each visible "
      "point, a "
      "quarter of the scene's diagonal long. This command writes the page and its plots:\n\n{}\n",
      enumerated(scenes), c.width, c.height, trees_text(report),
      c.threads == 0 ? "all cores" : fmt::format("{} threads", c.threads),
      c.repeat == 1 ? "measured once" : fmt::format("the median of {}", c.repeat), command_text(c));
}

std::string findings(const std::vector<std::vector<Pairing>>& kinds) {
  std::string text =
      winners_table(kinds) + "\n`crsh` means its own key with its own bound, `sphere-cone`.\n\n";
  text += "These need the fewest tests, for these reasons:\n\n";
  text += tests_list(kinds);
  text +=
      "\nThe fewest tests do not always take the least time, because some tests are more "
      "expensive." +
      time_sentence(kinds) + "\n\n";
  return text;
}

std::string comparisons(const AblationReport& report,
                        const std::vector<std::vector<Pairing>>& kinds) {
  std::string text =
      "## Bound and key must match\n\nThe best key of each bound, and its "
      "percentage of brute force:\n\n" +
      matches_table(report, kinds);
  const auto& bounds = report.command.bounds;
  if (std::find(bounds.begin(), bounds.end(), BundleBound::kSphereCone) == bounds.end() ||
      bounds.size() < 2)
    return text + "\n";
  return text +
         "\n## What a bound is worth\n\nTests / time, as multiples of those of `sphere-cone` with "
         "the same key; geometric means over all keys:\n\n" +
         bounds_table(report, kinds) + "\n";
}

std::string scene_section(const AblationReport& report, const std::string& scene,
                          const std::string& plots) {
  std::string text = "## Scene " + scene + "\n\n";
  if (!plots.empty()) {
    text += fmt::format("![Tests by key and bound]({})\n\n![Tests against time]({})\n\n",
                        plot_path(plots, scene, "tests"), plot_path(plots, scene, "time"));
  }
  for (const auto& [name, rays] : batches_of(report)) {
    if (name != scene) continue;
    const Pivot pivot = key_pivot(report, scene, rays, percent_of);
    text += fmt::format(
        "### {}, {}\n\n{} rays, {} triangles; tests as a percentage of brute "
        "force:\n\n{}\n",
        scene, rays_text(rays), pivot.least->counts.rays, pivot.least->counts.triangles,
        pivot_markdown(pivot, percent_of));
    if (has_several_trees(report))
      text += "The smallest over keys and bounds:\n\n" +
              pivot_markdown(tree_pivot(report, scene, rays, percent_of), percent_of) + "\n";
  }
  return text;
}

std::vector<std::string> best_cells(const char* what, const AblationRow& row) {
  const MethodSettings& s = row.settings;
  return {what,
          rays_text(row.rays),
          key_text(s),
          to_string(s.bound),
          fmt::format("{}x{}{}", s.levels, s.branching, s.mesh_culling ? "" : ", no culling"),
          three_digits(row.percent()) + " %",
          three_digits(row.total_ms()) + " ms"};
}

}  // namespace

std::string ablation_page(const AblationReport& report, const std::string& plots) {
  const std::vector<std::vector<Pairing>> kinds = all_pairings(report);
  std::string page = "# Keys and bounds, measured\n\n" + introduction(report);
  if (kinds.empty()) return page + "The scenes have no such rays.\n";
  page += findings(kinds) + comparisons(report, kinds);
  for (const std::string& scene : report.scenes) page += scene_section(report, scene, plots);
  page.pop_back();
  return page;
}

std::string ablation_text(const AblationReport& report) {
  std::string text;
  for (const auto& [scene, rays] : batches_of(report)) {
    const RowTest here = of(scene, rays);
    const Pivot tests = key_pivot(report, scene, rays, percent_of);
    text +=
        fmt::format("{}, {}: {} rays, {} triangles; {}\npercentage of the tests of brute force\n{}",
                    scene, rays_text(rays), tests.least->counts.rays, tests.least->counts.triangles,
                    trees_text(report), pivot_text(tests, percent_of));
    text += "milliseconds for order, hierarchy and trace\n" +
            pivot_text(key_pivot(report, scene, rays, milliseconds_of), milliseconds_of);
    if (has_several_trees(report))
      text += "percentage, the smallest over keys and bounds\n" +
              pivot_text(tree_pivot(report, scene, rays, percent_of), percent_of);
    text += "\n";
  }
  Table best({"best by", "rays", "key", "bound", "tree", "tests", "time"});
  for (const std::string& scene : report.scenes) {
    for (const LabRays rays : report.command.rays) {
      if (fewest_tests(report, of(scene, rays)) == nullptr) continue;
      best.add(best_cells((scene + " tests").c_str(), *fewest_tests(report, of(scene, rays))));
      best.add(best_cells((scene + " time").c_str(), *least_time(report, of(scene, rays))));
    }
  }
  return best.empty() ? "the scenes have no rays of these kinds\n" : text + best.text();
}

}  // namespace raysheaf::app
