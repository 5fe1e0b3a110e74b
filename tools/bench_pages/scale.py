"""Scale: the page of `bench scale`, a model that is fitted to its frames and predicts larger ones."""

import math
from itertools import product

from .text import command_block, table

OPTIONS = (("--triangles", 10**9, "triangles of the scene to predict, also with K, M or G"),
           ("--machines", 64, "machines that share the work"),
           ("--cores", 16, "cores of each machine"),
           ("--disk", 2000, "MB a second that each machine reads"),
           ("--network", 1250, "MB a second that each machine sends"))

SECONDS = {"decoding": "decoding", "culling": "culling", "tracing": "tracing", "shading": "shading",
           "rest": "the rest"}  # core seconds of a frame, and their names
HIT_BYTES = 84  # of a streamed hit that is sent between machines
PIXEL_BYTES = 12  # of the colour of a pixel
LATENCY_S = 20e-6


def core_s(cost):
    return sum(cost[part] for part in SECONDS)


class Model:
    """Each resource of a frame as c0 + c1 * triangles + c2 * pixels, without negative coefficients."""

    def __init__(self, samples):
        rows = [(1, sample["triangles"], sample["pixels"]) for sample in samples]
        self.fits = {part: best_fit(rows, [sample[part] for sample in samples]) for part in (*SECONDS, "bytes")}

    def cost(self, triangles, pixels):
        return {part: c[0] + c[1] * triangles + c[2] * pixels for part, c in self.fits.items()}


def fit(rows, values, use):
    """Least squares of relative errors over the columns in `use`, by the normal equations; None if singular."""
    weights = [1 / (value * value) if value > 0 else 0 for value in values]
    a = [[sum(w * row[r] * row[c] for w, row in zip(weights, rows)) if use[r] and use[c] else float(r == c)
          for c in range(3)] + [sum(w * row[r] * v for w, row, v in zip(weights, rows, values)) if use[r] else 0]
         for r in range(3)]
    for p in range(3):
        if not abs(a[p][p]) > 0:
            return None
        for r in range(3):
            if r != p:
                factor = a[r][p] / a[p][p]
                a[r] = [x - factor * y for x, y in zip(a[r], a[p])]
    return [a[r][3] / a[r][r] for r in range(3)]


def best_fit(rows, values):
    """The best fit without negative coefficients: there are so few of them that all subsets are tried."""
    best, least = [0, 0, 0], math.inf
    for use in sorted(product((0, 1), repeat=3), key=lambda u: u[0] + 2 * u[1] + 4 * u[2])[1:]:
        k = fit(rows, values, use)
        if k is None or not all(math.isfinite(x) and x >= -1e-12 for x in k):
            continue
        error = sum((sum(x * y for x, y in zip(k, row)) / value - 1) ** 2
                    for row, value in zip(rows, values) if value > 0)
        if error < least * (1 - 1e-9):
            best, least = k, error
    return best


def serial_part(core_seconds, seconds, cores):
    """The part of the work that only one core does, if it takes `seconds` on `cores` (G. Amdahl 1967)."""
    if not (cores > 1 and core_seconds > 0):
        return 0
    return min(max((seconds / core_seconds - 1 / cores) / (1 - 1 / cores), 0), 1)


class Machines:
    def __init__(self, ranks, cores, serial, disk_bytes_s=math.inf, network_bytes_s=math.inf, latency_s=0):
        self.ranks, self.cores, self.serial = ranks, cores, serial
        self.disk_bytes_s, self.network_bytes_s, self.latency_s = disk_bytes_s, network_bytes_s, latency_s

    def clock_seconds(self, core_seconds):
        return core_seconds * (self.serial + (1 - self.serial) / self.cores)


class Forecast:
    """Disk and cores work at the same time; the network follows."""

    def __init__(self, disk_s, cores_s, network_s):
        self.disk_s, self.cores_s, self.network_s = disk_s, cores_s, network_s
        self.total_s = max(disk_s, cores_s) + network_s
        most = max(disk_s, cores_s, network_s)
        self.bound_by = "disk" if most == disk_s else "cores" if most == cores_s else "network"


def forecast_geometry(model, triangles, pixels, batches, machines):
    """Every machine streams its blocks past all rays; then `batches` ring reductions of one hit a ray."""
    ranks = machines.ranks
    own, whole = model.cost(triangles / ranks, pixels), model.cost(triangles, pixels)
    # Machines share the blocks, but each of them lights all hits and reads their shading data.
    cores = own["decoding"] + own["culling"] + own["tracing"] + whole["shading"] + whole["rest"]
    network = batches * (2 * pixels * HIT_BYTES * (ranks - 1) / ranks / machines.network_bytes_s +
                         2 * (ranks - 1) * machines.latency_s)
    return Forecast(own["bytes"] / machines.disk_bytes_s, machines.clock_seconds(cores), network)


def forecast_rays(model, triangles, pixels, sharing, machines):
    """Every machine has a part p of the rays, and reads the part p^sharing of the bytes that all of them need."""
    part = 1 / machines.ranks
    own = model.cost(triangles * part**sharing, pixels * part)
    network = pixels * PIXEL_BYTES / machines.network_bytes_s + machines.latency_s if machines.ranks > 1 else 0
    return Forecast(own["bytes"] / machines.disk_bytes_s, machines.clock_seconds(core_s(own)), network)


# Text

def seconds(s):
    return f"{1e3 * s:.3g} ms" if s < 1 else f"{s:.3g} s" if s < 600 else f"{s / 60:.3g} min"


def amount(x):
    factor, unit = next(((f, u) for f, u in ((1e9, "G"), (1e6, "M")) if x >= f), (1e3, "k"))
    return f"{math.floor(x / (factor / 10) + 0.5) / 10:g} {unit}"


def size(x):
    return amount(x) + "B"


class Report:
    def __init__(self, figures, given):
        self.figures, self.given = figures, given
        self.samples, self.check = figures["samples"], figures["check"]
        self.model = Model(self.samples)
        self.last = self.samples[-1]
        self.pixels, self.batches = self.last["pixels"], self.last["batches"]
        self.serial = serial_part(core_s(self.last), figures["together"]["seconds"], figures["threads"])

    def machines(self, ranks):
        given = self.given
        return Machines(ranks, given.cores, self.serial, 1e6 * given.disk, 1e6 * given.network, LATENCY_S)

    def geometry(self, triangles, ranks):
        return forecast_geometry(self.model, triangles, self.pixels, self.batches, self.machines(ranks))

    def rays(self, ranks):
        return forecast_rays(self.model, self.given.triangles, self.pixels, self.figures["sharing"],
                             self.machines(ranks))

    def here(self, ranks, threads):
        """The frame of the check by processes on the measured machine, without disk and network."""
        check = self.check
        return forecast_geometry(self.model, check["triangles"], check["pixels"], check["batches"],
                                 Machines(ranks, threads, self.serial)).total_s

    def conditions(self):
        given, side = self.given, round(math.sqrt(self.pixels))
        return (f"{side}x{side} pixels, machines of {given.cores} cores, disks of {size(1e6 * given.disk)}/s and "
                f"networks of {size(1e6 * given.network)}/s each")

    def measured_table(self):
        rows = [[amount(s["triangles"]), amount(s["pixels"]), amount(s["rays"]), f"{s['read']} of {s['blocks']}",
                 size(s["bytes"]), *(seconds(s[part]) for part in SECONDS), seconds(s["seconds"])]
                for s in self.samples]
        return table(["triangles", "pixels", "rays", "blocks read", "bytes read", *SECONDS.values(), "frame"], rows)

    def serial_sentence(self):
        return (f"The last of these frames takes {seconds(self.figures['together']['seconds'])} on "
                f"{self.figures['threads']} threads and {seconds(core_s(self.last))} on one, so "
                f"{100 * self.serial:.1f} % of its work is serial (Amdahl 1967).\n")

    def check_sentence(self):
        check, guess = self.check, self.here(1, self.figures["threads"])
        guessed_bytes = self.model.cost(check["triangles"], check["pixels"])["bytes"]
        return (f"A frame that was not used for the fit, with {amount(check['triangles'])} triangles and "
                f"{amount(check['pixels'])} pixels, on {self.figures['threads']} threads: {seconds(guess)} predicted, "
                f"{seconds(check['seconds'])} measured (ratio {guess / check['seconds']:.2f}); {size(guessed_bytes)} "
                f"predicted to be read, {size(check['bytes'])} read (ratio {guessed_bytes / check['bytes']:.2f}).\n")

    def constants_table(self):
        rows = [[SECONDS.get(part, "bytes read"), shown(k[0]), shown(1e6 * k[1]), shown(1e6 * k[2])]
                for part, k in self.model.fits.items() for shown in [size if part == "bytes" else seconds]]
        return table(["resource", "a frame", "a million triangles", "a million pixels"], rows)

    def processes(self):
        runs = self.figures["processes"]
        if not runs:
            return f"Runs of several processes were left out: {self.figures['no_processes']}\n"
        rows = []
        for run in runs:
            expected = self.here(run["ranks"], run["threads"])
            rows.append([run["ranks"], run["threads"], seconds(expected), seconds(run["seconds"]),
                         f"{expected / run['seconds']:.2f}", size(run["bytes"])])
        return table(["processes", "threads each", "predicted", "measured", "predicted / measured",
                      "bytes read by all"], rows)

    def growth_table(self):
        file_bytes = self.figures["geometry_bytes"] + self.figures["shading_bytes"]
        rows = []
        for triangles in (1e6, 1e7, 1e8, 1e9, 1e10):
            f = self.geometry(triangles, 1)
            rows.append([amount(triangles), size(triangles * file_bytes),
                         size(self.model.cost(triangles, self.pixels)["bytes"]), seconds(f.disk_s),
                         seconds(f.cores_s), seconds(f.total_s), f.bound_by])
        return table(["triangles", "file", "read", "disk", "cores", "frame", "bound by"], rows)

    def machines_table(self):
        most, rows = self.given.machines, []
        for ranks in [*(1 << i for i in range(20) if 1 << i < most), most]:
            cells = [[*map(seconds, (f.disk_s, f.cores_s, f.network_s, f.total_s)), f.bound_by]
                     for f in (self.geometry(self.given.triangles, ranks), self.rays(ranks))]
            rows.append([ranks, *cells[0], *cells[1]])
        return table(["machines", "geometry: disk", "cores", "network", "frame", "bound by", "rays: disk", "cores",
                      "network", "frame", "bound by"], rows)

    def saturation(self):
        """Where disk and cores, or the network and everything else, take equally long."""
        triangles, cores = self.given.triangles, self.given.cores
        balance = self.model.cost(triangles, self.pixels)["bytes"] / self.geometry(triangles, 1).cores_s
        text = (f"* **Disk and cores** take equally long if the disk of a machine reads {size(balance)}/s for {cores} "
                "cores; a slower disk limits the frame.\n")
        for ranks in (1 << i for i in range(1, 20)):
            f = self.geometry(triangles, ranks)
            if f.network_s >= max(f.disk_s, f.cores_s):
                text += (f"* **The network**: with {ranks} machines, combining the hits takes longer "
                         f"({seconds(f.network_s)}) than streaming a machine's part "
                         f"({seconds(max(f.disk_s, f.cores_s))}). More machines do not make the frame faster: share "
                         "rays or frames instead.\n")
                break
        return text + ("* **Work that is not divided** if geometry is shared: every machine generates, orders and "
                       f"shades all rays, which takes {seconds(core_s(self.model.cost(0, self.pixels)) / cores)} a "
                       "frame, whatever the number of machines.\n")


def page(figures, given):
    report = Report(figures, given)
    triangles = amount(given.triangles)
    one, geometry = (report.geometry(given.triangles, machines) for machines in (1, given.machines))
    rays = report.rays(given.machines)
    options = "".join(f" {name} {getattr(given, name[2:])}" for name, usual, _ in OPTIONS
                      if getattr(given, name[2:]) != usual)
    title = "a thousand million" if given.triangles == 10**9 else triangles
    return f"""# Scale: what {title} triangles would take

`raysheaf bench scale` renders generated halls that [stream](../stream.md). `tools/pages` writes this page: it fits a linear model of the time and bytes that each resource takes, checks the model with a frame that was not used for the fit, and extrapolates. Only the tables under "Measured" and "Processes" are measurements.

{command_block(figures, given, options)}**{triangles} triangles, {report.conditions()}**: a frame takes {seconds(one.total_s)} on one machine, limited by its {one.bound_by}; {seconds(geometry.total_s)} on {given.machines} machines that share the triangles, limited by the {geometry.bound_by}; {seconds(rays.total_s)} if they share the rays, limited by the {rays.bound_by}.

## Measured

One thread traces while another reads; files are in the system's cache. Times are those of one core, except the frame's, which is wall time.

{report.measured_table()}
{report.serial_sentence()}
{report.check_sentence()}
A triangle takes {figures['geometry_bytes']:.1f} bytes of geometry and {figures['shading_bytes']:.1f} of shading in the file. A quarter of the image reads 0.25^{figures['sharing']:.2f} of the bytes that the whole image reads.

## Fitted

{report.constants_table()}
Disk and cores work at the same time, so a frame takes the longer of the two, plus the time of the network.

## Processes

The frame that was not used for the fit, rendered by processes on one machine that share its triangles (`mpirun -n 2 raysheaf render hall.rsb`), and the prediction for machines whose disk and network take no time.

{report.processes()}
## One machine

{report.growth_table()}
## Several machines

The scene has {triangles} triangles. *Geometry*: each machine streams its own blocks past all rays, and the machines combine their hits after each of {report.batches} batches, with {HIT_BYTES} bytes a ray, in a ring. *Rays*: each machine has a part of the image, and streams the blocks that its rays may intersect.

{report.machines_table()}
## Where it saturates

{report.saturation()}
The model ignores machines of unequal speed, shared disks, and hits that are sent while blocks still stream.
"""
