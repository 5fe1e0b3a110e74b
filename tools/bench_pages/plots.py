"""The plots of the pages, as SVG. The only module that needs matplotlib."""

import math

import matplotlib
from matplotlib.colors import LinearSegmentedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from .text import printable, short_number, three_digits, unique

# Text stays text, and equal figures give equal files.
matplotlib.rcParams.update({
    "svg.fonttype": "none", "svg.hashsalt": "raysheaf", "font.family": "sans-serif",
    "font.sans-serif": ["Inter", "Source Sans 3", "Segoe UI", "Helvetica", "Arial", "DejaVu Sans"],
    "figure.facecolor": "#fdfdfb", "axes.facecolor": "#fdfdfb", "axes.edgecolor": "#9aa1a8",
    "axes.titlelocation": "left", "axes.titlesize": 12, "axes.titleweight": "bold", "axes.axisbelow": True,
    "axes.spines.top": False, "axes.spines.right": False, "grid.color": "#e6e7e3", "text.color": "#2b2f33",
    "xtick.color": "#7a828a", "ytick.color": "#7a828a", "axes.labelcolor": "#4a5157", "legend.frameon": False})

KIND_COLORS = {"shadow": "#e8890c", "mirror": "#3b82c4", "second": "#8e5bb5", "ao": "#12886f", "random": "#c2334d"}
COLORS = ["#adb5bd", "#3b82c4", "#e8890c", "#8e5bb5", "#12886f", "#c2334d", "#5c4a3d"]
SHAPES = ["o", "s", "^", "D", "v", "P", "p"]
FEW_TESTS = LinearSegmentedColormap.from_list(
    "tests", ["#0c4454", "#186a70", "#429286", "#82baa0", "#c0dac0", "#ecf0de"])


def new_figure(title, note, width, height, **grid):
    """A figure in inches with a title, and its axes."""
    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplots(squeeze=False, **grid).flatten()
    figure.suptitle(f"{title}\n\n", x=0.02, ha="left", fontsize=17, fontweight="bold", color="#1c2125")
    figure.text(0.02, 1 - 0.5 / height, note, fontsize=9.5, color="#7a828a", va="top", wrap=True)
    return figure, axes


def save(figure, path):
    figure.savefig(path, format="svg", metadata={"Date": None})


def two_columns(title, note, count, width, height):
    """Axes for `count` plots, two in a row."""
    columns, rows = min(max(count, 1), 2), max((count + 1) // 2, 1)
    figure, axes = new_figure(title, note, columns * width, 1.2 + rows * height, nrows=rows, ncols=columns)
    for unused in axes[count:]:
        unused.axis("off")
    return figure, axes


def legend_below(figure, handles, labels, columns):
    rows = -(-len(handles) // columns)
    room = (0.15 + 0.2 * rows) / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0, room, 1, 1 - room))
    figure.legend(handles, labels, loc="lower center", ncols=columns)


def logarithmic(axis, text):
    axis.set_major_formatter(FuncFormatter(lambda value, _: text(value)))
    axis.set_minor_formatter(NullFormatter())
    low, high = axis.get_view_interval()
    axis.set_major_locator(LogLocator(subs=(1, 2, 5) if high / low < 150 else (1,), numticks=99))


def ratios(figures, cases, modes, path):
    """A panel for each mode: scenes by row, ratios along a logarithmic axis, a dot for each kind of rays."""
    heights = [len(unique(case["label"] for case in cases.of(mode=mode))) for mode in cases.modes]
    figure, axes = new_figure(
        f"Time compared with {figures['peer']}",
        f"ours / theirs, {figures['threads']} threads: left of 1 raysheaf is faster.", 8.5, 1.6 + sum(0.9 + 0.27 * rows for rows in heights), nrows=len(heights), ncols=1,
        sharex=True, height_ratios=[rows + 2 for rows in heights])
    for plot, mode in zip(axes, cases.modes):
        labels = unique(case["label"] for case in cases.of(mode=mode))
        triangles = {case["label"]: short_number(case["triangles"]) for case in cases.all}
        for case in cases.of(mode=mode):
            y, color = labels.index(case["label"]), KIND_COLORS[case["kind"]]
            plot.plot(case["ratio"], y, "o", color=color, markersize=6.5)
        plot.set_title(modes[mode])
        plot.set_xscale("log")
        plot.set_yticks(range(len(labels)), [f"{label}  {triangles[label]}" for label in labels])
        plot.set_ylim(len(labels) - 0.5, -0.5)
        plot.grid(True)
        plot.axvline(1, color="#4a5157", linewidth=1)
        plot.tick_params(labelbottom=True)
        logarithmic(plot.xaxis, "{:g}".format)
    dots = [axes[0].plot([], [], "o", color=KIND_COLORS[kind])[0] for kind in cases.kinds]
    legend_below(figure, dots, cases.kinds, len(dots))
    save(figure, path)


def growth(figures, lines, our_ms, peer_ms, path):
    """A panel for each line: time against count, both logarithmic, for both sides and for linear growth."""
    figure, axes = two_columns(f"Growth compared with {figures['peer']}",
                               f"A frame in a generated hall, {figures['threads']} threads.", len(lines), 5.6, 4)
    for plot, (along, mode, kind, line) in zip(axes, lines):
        counts = [point[along] for point in line]
        ours, theirs = list(map(our_ms, line)), list(map(peer_ms, line))
        plot.plot(counts, [ours[-1] * count / counts[-1] for count in counts], "--", color="#9aa1a8", linewidth=1.2,
                  label="linear growth")
        plot.plot(counts, theirs, "o-", color="#3b82c4", label=figures["peer"])
        plot.plot(counts, ours, "o-", color="#c2334d", label="raysheaf")
        plot.set(title=f"{kind} rays, {mode}, along {along}", xscale="log", yscale="log", xlabel=along, ylabel="ms",
                 ylim=(min(ours + theirs) / 1.4, max(ours + theirs) * 1.4))
        plot.grid(True)
        logarithmic(plot.xaxis, short_number)
        logarithmic(plot.yaxis, "{:g}".format)
    legend_below(figure, *axes[0].get_legend_handles_labels(), 3)
    save(figure, path)


def heat_maps(title, note, maps, path):
    """A table for each pivot, coloured on its own logarithmic scale; the least figure is framed."""
    rows = max(len(pivot.lines) for _, pivot in maps)
    columns = max(len(pivot.columns) for _, pivot in maps)
    figure, axes = two_columns(title, note, len(maps), 2.6 + 0.75 * columns, 1.1 + 0.23 * rows)
    for plot, (name, pivot) in zip(axes, maps):
        values = [[row["percent"] if row and row["percent"] > 0 else math.nan for row in line]
                  for line in pivot.lines.values()]
        known = [value for line in values for value in line if value > 0]
        norm = LogNorm(min(known, default=1), max(known, default=1) * (1 + 1e-9))
        plot.imshow(values, cmap=FEW_TESTS, norm=norm, aspect="auto")
        for y, line in enumerate(pivot.lines.values()):
            for x, row in enumerate(line):
                if not values[y][x] > 0:
                    continue
                best = row is pivot.least
                plot.text(x, y, three_digits(row["percent"]), ha="center", va="center", fontsize=8.5,
                          color="white" if norm(row["percent"]) < 0.5 else "#20302f",
                          fontweight="bold" if best else "normal",
                          bbox={"facecolor": "none", "edgecolor": "#f08c00", "pad": 2} if best else None)
        least = pivot.least
        plot.set_title(name)
        plot.set_xlabel(f"Least: {three_digits(least['percent'])} %, "
                        f"{', '.join(filter(None, (least['key'], least['bits'], least['bound'])))}")
        plot.set_xticks(range(len(pivot.columns)), pivot.columns, fontsize=8.5)
        plot.set_yticks(range(len(pivot.lines)), [", ".join(filter(None, names)) for names in pivot.lines], fontsize=8.5)
        plot.tick_params(length=0, labeltop=True, labelbottom=False)
        plot.spines[:].set_visible(False)
    save(figure, path)


def unbeaten(points):
    """The points that no other point beats in both figures, from the left."""
    front = []
    for x, y in sorted(points):
        if not front or y < front[-1][1]:
            front.append((x, y))
    return front


def scatters(title, note, plots, bounds, families, path):
    """Tests against time. A dashed line joins the points that no other point beats in both figures."""
    figure, axes = two_columns(title, note, len(plots), 6, 4.4)
    names = unique(families.values())
    for plot, (name, rows) in zip(axes, plots):
        points = [(row["percent"], max(row["ms"], 1e-3)) for row in rows]
        plot.plot(*zip(*unbeaten(points)), "--", color="#1c2125", linewidth=0.9)
        for row, point in zip(rows, points):
            plot.plot(*point, SHAPES[names.index(families[row["key"]]) % len(SHAPES)], markersize=6,
                      color=COLORS[bounds.index(row["bound"]) % len(COLORS)], markeredgecolor="white")
            if "label" in row:
                plot.annotate(printable(row["label"]), point, xytext=(14, -12), textcoords="offset points",
                              fontsize=8.5, arrowprops={"arrowstyle": "-", "linewidth": 0.6})
        plot.set(title=name, xscale="log", yscale="log", xlabel="tests, % of brute force",
                 ylabel="order, hierarchy and trace, ms")
        plot.grid(True)
        for axis in (plot.xaxis, plot.yaxis):
            logarithmic(axis, "{:g}".format)
    marks = [axes[0].plot([], [], "s", color=COLORS[i % len(COLORS)])[0] for i in range(len(bounds))]
    marks += [axes[0].plot([], [], SHAPES[i % len(SHAPES)], color="#4a5157")[0] for i in range(len(names))]
    legend_below(figure, marks, [*bounds, *names], max(len(bounds), 1))
    save(figure, path)
