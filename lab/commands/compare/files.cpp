#include <fmt/format.h>

#include "apps/support/console.h"
#include "apps/support/table.h"
#include "lab/commands/compare/compare.h"

namespace raysheaf::app {
namespace {

/// "4.4.0 0.837; 3.13.5 0.702": the ratio of every version.
std::string ratios_of_versions(const CompareCase& c) {
  std::string text;
  for (const PeerResult& peer : c.peers)
    text += fmt::format("{}{} {:.6g}", text.empty() ? "" : "; ", peer.version, peer.ratio);
  return text;
}

std::string csv_line(const CompareCase& c, const std::string& along) {
  const PeerResult& peer = c.peer;
  const HitCheck& hits = peer.hits;
  return fmt::format(
      "{},{},{},{},{},{},{},{:.8g},{:.8g},{:.8g},{:.8g},{:.8g},{},{},{},{:.8g},{:.8g},{:.8g},"
      "{:.8g},{:.8g},{:.8g},{},{},{},{},{},{},{},{},{},{},{},{}\n",
      csv_field(c.scene), size_text(c.size), c.triangles, to_string(c.kind), to_string(c.mode),
      c.rays, along, c.ours_ms.update, c.ours_ms.order, c.ours_ms.hierarchy, c.ours_ms.trace,
      c.ours_ms.total, csv_field(c.plan), peer.version, csv_field(peer.way), peer.ms.build,
      peer.ms.trace, peer.ms.total, peer.ratio, peer.cpu_ratio, c.worst_frame,
      ratios_of_versions(c), hits.equal() ? 1 : 0, hits.compared, hits.mismatches, hits.settled,
      hits.ours_right, hits.peer_right, hits.other_triangles, hits.sampled, hits.sample_mismatches,
      c.our_bytes, peer.bytes);
}

}  // namespace

std::string compare_csv(const CompareReport& report) {
  std::string text =
      fmt::format("# command: {}\n# peer: {}\n# threads: {}\n# runs: {}\n# peak_bytes: {}\n",
                  printable(report.command.words), report.peer, report.threads, report.command.runs,
                  report.peak_bytes);
  for (const std::string& note : report.notes) text += "# note: " + printable(note) + "\n";
  text +=
      "scene,size,triangles,kind,mode,rays,along,update_ms,order_ms,hierarchy_ms,trace_ms,ours_ms,"
      "plan,peer_version,peer_way,peer_build_ms,peer_trace_ms,peer_ms,ratio,cpu_ratio,worst_frame,"
      "ratios,hits_equal,compared,mismatches,settled,ours_right,peer_right,other_triangles,"
      "brute_force_compared,brute_force_mismatches,ours_bytes,peer_bytes\n";
  for (const CompareCase& c : report.cases) text += csv_line(c, "");
  for (const GrowthCase& g : report.growth) text += csv_line(g.measured, g.along);
  return text;
}

std::string compare_text(const CompareReport& report) {
  std::string text = fmt::format("compared with {}, {} threads, medians of {} rounds\n",
                                 report.peer, report.threads, report.command.runs);
  Table table({"scene", "triangles", "mode", "kind", "rays", "ours ms", "peer ms", "ratio",
               "cpu ratio", "worst frame", "hits", "peer", "plan"});
  const auto add = [&](const CompareCase& c) {
    table.add({printable(label_of(c)), std::to_string(c.triangles), to_string(c.mode),
               to_string(c.kind), std::to_string(c.rays), three_digits(c.ours_ms.total),
               three_digits(c.peer.ms.total), three_digits(c.peer.ratio),
               three_digits(c.peer.cpu_ratio), c.worst_frame > 0 ? three_digits(c.worst_frame) : "",
               c.peer.hits.equal() ? "equal" : fmt::format("{} differ", c.peer.hits.mismatches),
               c.peer.version + " " + c.peer.way, c.plan});
  };
  for (const CompareCase& c : report.cases) add(c);
  for (const GrowthCase& g : report.growth) add(g.measured);
  text += table.text();
  for (const std::string& note : report.notes) text += printable(note) + "\n";
  return text;
}

}  // namespace raysheaf::app
