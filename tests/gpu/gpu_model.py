#!/usr/bin/env python3
"""Models the time of techniques on GPUs from counts of instructions, bytes and dispatches.

usage: gpu_model.py [--kernels FILE --assembly DIR] [--flagged FRACTION] [--sensitivity]
       gpu_model.py --kernels FILE --assembly DIR --pair SAMPLED,VERTICAL,HORIZONTAL,SAMPLES
  --kernels      adds rows of graphs as they are built, whose bytes, occupancy and code size come
                 from `dermis kernels sap separable --unbound scattered_light,albedo,scatter_scale
                 --json --assembly DIR` on navi21; executed instructions are counted in DIR
  --flagged      fraction of the tiles next to edges in a second row of each graph with two layers
                 at level 1; default 0.2. In the first row no tile is next to an edge
  --pair         prints only the papers' pair (hybrid_afis_separable): fractions of the listed tiles
                 that have samples and in which the passes of separable run, and samples per pixel
  --sensitivity  also prints the totals with other latencies, cache misses and fixed costs

No time was measured. Formulas, hardware rows and the assumed fractions of layered work stay fixed,
so that tables of different dates can be compared; only counts change.
Units: clocks per subgroup of 64 invocations. The time of a pass is the largest of issue or latency,
texture unit, shared memory, memory and the latency of one subgroup, plus scratch traffic and a
fixed cost per dispatch.
"""
import argparse
import dataclasses
import json
import math
import pathlib
import re
import sys

import instruction_mix
from gpu_counts import (AFIS, AFIS_MIP_DOWN, AFIS_MIP_SETUP, AFIS_PUBLISHED, BLOCKS, BURLEY,
                        CLASSIFY, COMBINE, GUIDE_BYTES, ONE_LAYER_CHILDREN_TRIPS, ONE_LAYER_TRIPS,
                        SEPARABLE, SEPARABLE_BUILT, SEPARABLE_BUILT_SETUP, SEPARABLE_TUNED, SETUP,
                        TEXELS, TRIPS, afis_built, fixed, guided)
from gpu_hardware import H100, H200, NVIDIA_LIKE, RX_6800, SMALL_RDNA2

COVERED = 0.5  # fraction of the view
TILE_FILL = 0.95  # fraction of the pixels of listed tiles that are covered
LAYERED_FRACTION = {2: 0.35, 3: 0.6, 4: 0.8}  # of subgroups by level; 1 from level 5 on
# Subgroups of levels 0 and 1 with second layers per tile next to an edge (docs/techniques.md).
LAYERED_BY_FLAGGED = {0: 1.4, 1: 1.8}


@dataclasses.dataclass
class Factors:  # of the sensitivity runs
    latency: float = 1.0
    cache_miss: float = 20.0  # clocks per line of code beyond the instruction cache
    serial: float = 1.0
    fixed: float = 1.0
    spill: float = 1.0


@dataclasses.dataclass
class Pass:
    name: str
    seconds: float
    limit: str
    bytes: float
    memory_seconds: float


class Model:
    def __init__(self, hardware, factors=Factors(), width=2560, height=1440, covered=COVERED):
        self.hardware, self.factors = hardware, factors
        self.pixels = width * height
        self.covered = self.pixels * covered
        self.view_tiles = (width // 8) * (height // 8)
        self.tiles = self.tiles_of_levels(self.covered / TILE_FILL / 64)
        self.techniques = {}

    @staticmethod
    def tiles_of_levels(tiles):
        """Returns the listed tiles of levels 0 to 8, for one compact object."""
        side, levels = math.sqrt(tiles), [tiles]
        for _ in range(8):
            side = side / 2 + 1
            levels.append(side * side)
        return levels

    def wave(self, valu=0, trans=0, qmul=0, img=0, img128=0, scat=0, st64=0, st128=0, buf=0,
             lds=0, vm=0, vml=400, lg=0, W=8, scr=0, code=8000):
        """Returns the clocks of one subgroup.

        valu, trans, qmul: arithmetic, transcendental and quarter-rate instructions. img, img128,
        scat: reads of texels up to 64 bits, of 128 bits, and scattered. st64, st128: image writes.
        buf: buffer reads. lds: clocks of shared memory. vm, lg: waits for memory (vml clocks each)
        and for shared or scalar memory. W: subgroups per SIMD. scr: scratch words. code: bytes.
        """
        hardware, factors = self.hardware, self.factors
        issue = (valu + trans) * hardware.valu + qmul * 8
        latency = issue + (vm * vml + lg * 60) * factors.latency
        if code > 32768:
            latency += code / 64 * factors.cache_miss
        texture = img * 16 + img128 * 32 + scat * 44 + st64 * 16 + st128 * 32 + buf * 16 + scr * 4
        return {"simd": max(issue, trans * hardware.transcendental, latency / W), "tmu": texture,
                "lds": lds, "lat": latency, "scr": scr * 256}

    def add(self, technique, name, waves, wave, bytes_moved):
        hardware, factors = self.hardware, self.factors
        hits = hardware.cache_hits
        bandwidth = 1 / (hits / hardware.cache + (1 - hits) / hardware.dram)
        times = [(waves * wave["simd"] / hardware.simds / hardware.clock, "alu/lat"),
                 (waves * wave["tmu"] / hardware.compute_units / hardware.clock, "tmu"),
                 (waves * wave["lds"] / hardware.compute_units / hardware.clock, "lds"),
                 (bytes_moved / bandwidth, "mem"), (wave["lat"] / hardware.clock, "one wave")]
        seconds, limit = max(times)
        seconds += (waves * wave["scr"] / hardware.l2 * 0.5 * factors.spill
                    + hardware.fixed * factors.fixed)
        self.techniques.setdefault(technique, []).append(
            Pass(name, seconds, limit, bytes_moved, bytes_moved / bandwidth))

    def add_serial(self, technique, name, clocks):
        hardware, factors = self.hardware, self.factors
        seconds = clocks * factors.serial / hardware.clock + hardware.fixed * factors.fixed
        self.techniques.setdefault(technique, []).append(Pass(name, seconds, "serial", 0, 0))

    def total(self, technique):
        return sum(one.seconds for one in self.techniques[technique])


def serial_tile_list(model):
    return model.view_tiles / 256 * 330 * 2 + 1500


def serial_sap_tiles(model):
    """Clocks of sap_tiles in one group of 256: each invocation loops over its own run of tiles."""
    lane = model.view_tiles / 256
    flags = 9 * (130 if model.view_tiles <= 49152 else 300)  # in shared memory, or in memory
    clocks, tiles = lane * 350 + lane * 300 + lane * (flags + 250), model.view_tiles
    for level in range(1, 9):
        tiles = max(4, (math.sqrt(tiles) / 2 + 1) ** 2)
        per_lane = min(tiles, 32 * math.ceil(math.ceil(tiles / 32) / 256))
        children = flags if level == 1 else 9 * 130
        clocks += per_lane * children + per_lane * (children + 9 * 130 + 200) + 1500
    return clocks


def serial_parallel_tiles(model):
    """Clocks of lists made by one group of 1024."""
    lane = model.view_tiles / 1024
    clocks, tiles = lane * 320 + lane * 520 + 1500, model.view_tiles
    for _ in range(1, 9):
        tiles = max(4, (math.sqrt(tiles) / 2 + 1) ** 2)
        clocks += math.ceil(tiles / 1024) * (300 + 650) + 1800
    return clocks


# sap_tiles with one group per region, from ACO's assembly of navi21: a region's lists, and levels 4
# to 8 by the group that ends last. The regions' subgroups run at once, so both take one latency.
LIST_REGION = dict(valu=720, buf=21, vm=6, lg=35, W=13)
LIST_COARSE = dict(valu=1400, buf=5, vm=6, lg=70, W=13)


# tile_list, whose last group only writes the arguments.
LIST_RUN = dict(valu=236, trans=1, qmul=3, buf=18, vm=5, lg=20, W=16)


def lists_by_region(model):
    # Steps of the loop over tiles of level 4, beyond the first.
    steps = math.ceil(model.view_tiles / 256 / 128) - 1
    coarse = model.wave(**LIST_COARSE)["lat"] + steps * model.wave(valu=120, vm=2, lg=8)["lat"]
    return model.wave(**LIST_REGION)["lat"] + coarse


def layered_fraction(level, flagged=0.0):
    """Returns the fraction of subgroups with two layers. flagged: of the tiles, next to edges."""
    if level >= 2:
        return LAYERED_FRACTION.get(level, 1.0)
    return min(1.0, LAYERED_BY_FLAGGED[level] * flagged)


def mix(fast, slow, fraction):
    """The mean of both, with the latency of the slow one if any subgroup is slow."""
    mixed = {key: (1 - fraction) * fast[key] + fraction * slow[key] for key in fast}
    mixed["lat"] = slow["lat"] if fraction else fast["lat"]
    return mixed


def add_frame(model, technique, setup, passes, as_built=False):
    tiles0, n = model.tiles[0], model.covered
    model.add(technique, "classify", model.view_tiles / 16, model.wave(**CLASSIFY),
              1 * model.pixels + 5 * n)
    # As built, the list of tiles takes at most as long as one of the regions of sap_tiles.
    model.add_serial(technique, "tile_list",
                     model.wave(**LIST_REGION)["lat"] if as_built else serial_tile_list(model))
    model.add(technique, "setup", *setup)
    for one in passes:
        model.add(technique, *one)
    model.add(technique, "combine", tiles0, model.wave(**COMBINE), n * 17)


def setup_with_slope(model):
    return model.tiles[0], model.wave(**SETUP), model.covered * (13 + 12)


def mips_of(model):
    mips = [("mip_setup", model.pixels / 64, model.wave(**AFIS_MIP_SETUP), model.pixels * 13)]
    for level in range(1, 9):
        mips.append((f"mip_down_{level}", max(1, model.pixels / 64 / 4**level),
                     model.wave(**AFIS_MIP_DOWN), model.pixels / 4**level * (8 * 4 + 8)))
    return mips


def add_fixed(model, technique, samples):
    """`fixed` as built, with any number of samples."""
    scatter = ("scatter", model.tiles[0], model.wave(**fixed(samples)), model.covered * 25)
    add_frame(model, technique, setup_with_slope(model), [scatter], as_built=True)


def add_afis(model, technique, samples, guidance=None, pooled=True):
    """`afis` or `afis_guided` as built. samples: the most of the pixels of a subgroup. Guidance
    reads velocity, reads and writes its histories, and clears one of them."""
    moved, passes = 30, mips_of(model)
    counts = afis_built(samples)
    if guidance:
        counts = guided(samples, guidance, pooled)
        moved += 4 + 2 * GUIDE_BYTES[guidance]
        passes.append(("clear_history", model.pixels / 64, model.wave(valu=10, st64=1, W=16),
                       model.pixels * 8))
    passes.append(("scatter", model.tiles[0], model.wave(**counts), model.covered * moved))
    add_frame(model, technique, setup_with_slope(model), passes, as_built=True)


def add_rivals(model):
    n, tiles0 = model.covered, model.tiles[0]
    setup = (tiles0, model.wave(**SETUP), n * (13 + 8))
    slope, mips = setup_with_slope(model), mips_of(model)
    separable, tuned = model.wave(**SEPARABLE), model.wave(**SEPARABLE_TUNED)
    add_frame(model, "separable 25", setup, [("horizontal", tiles0, separable, n * 21),
                                             ("vertical", tiles0, separable, n * 29)])
    add_frame(model, "separable tuned*", setup, [("horizontal", tiles0, tuned, n * 24),
                                                 ("vertical", tiles0, tuned, n * 24)])
    built = model.wave(**SEPARABLE_BUILT)
    # Light of covered pixels, and depth of all pixels.
    setup_built = model.wave(**SEPARABLE_BUILT_SETUP)
    add_frame(model, "separable 25 as built",
              (model.view_tiles, setup_built, n * (13 + 8) + model.pixels * 4),
              [("horizontal", tiles0, built, n * 20), ("vertical", tiles0, built, n * 28)],
              as_built=True)
    for suffix in ("", " as built"):
        for name, counts in (("burley 32", BURLEY), ("fixed 16", fixed(16))):
            add_frame(model, name + suffix, slope,
                      [("scatter", tiles0, model.wave(**counts), n * 25)], bool(suffix))
    add_frame(model, "afis 16", slope, mips + [("scatter", tiles0, model.wave(**AFIS), n * 30)])
    add_afis(model, "afis 16 as built", 16)
    # Mip 0 replaces light and slope.
    add_frame(model, "afis_published 16", mips[0][1:],
              mips[1:] + [("scatter", tiles0, model.wave(**AFIS_PUBLISHED), n * 22)],
              as_built=True)


def add_pyramid(model, technique, counts, list_clocks, layered=True):
    n, tiles = model.covered, model.tiles
    model.add(technique, "classify", model.view_tiles / 16, model.wave(**CLASSIFY),
              1 * model.pixels + 5 * n)
    model.add_serial(technique, "lists", list_clocks)
    model.add(technique, "setup", tiles[0] / counts.texels_setup, model.wave(**counts.setup),
              n * (13 + 24))
    for name, levels, fast, slow in (("down", range(1, 9), counts.down, counts.slow_down),
                                     ("up", range(8, 0, -1), counts.up, counts.slow_up)):
        for level in levels:
            of_level = n / 4**level
            fraction = layered_fraction(level) if layered else 0.0
            clocks = model.wave(**fast)
            if fraction:
                clocks = mix(clocks, model.wave(**slow(level)), fraction)
            computed = of_level * (4 * 24 + 24) if name == "down" else of_level * (24 + 32 / 4 + 16)
            model.add(technique, f"{name}_{level}", max(1, tiles[level] / counts.texels), clocks,
                      computed * (1.5 if layered and level >= 2 else 1))
    model.add(technique, "gather", tiles[0] / counts.texels_setup, model.wave(**counts.gather),
              n * (24 + 8 + 8))
    model.add(technique, "combine", tiles[0], model.wave(**COMBINE), n * 17)


def add_target(model):
    """Lists in parallel, texels of 16 bytes, levels 5 to 8 in one dispatch, combine in gather."""
    technique, n, tiles = "SAP target", model.covered, model.tiles
    model.add(technique, "classify", model.view_tiles / 16, model.wave(**CLASSIFY),
              1 * model.pixels + 5 * n)
    model.add_serial(technique, "lists", 8000)
    model.add(technique, "setup", tiles[0], model.wave(**TEXELS.setup), n * (13 + 16))
    down = model.wave(valu=1000, trans=60, qmul=8, img=0, img128=5.1, st128=1, vm=6, lg=50, W=5,
                      lds=16 * 8 + 6 * 8)
    slow_down = model.wave(valu=1000 + 2 * 1500, trans=60 + 2 * 150, img128=5.1 + 16, st128=2,
                           vm=14, lg=110, W=5, lds=700)
    up = model.wave(valu=750, trans=38, qmul=8, img128=1.6 + 0.8, st128=1, buf=6, vm=6, lg=40, W=8,
                    lds=130)
    slow_up = model.wave(valu=200 + 2 * 800, trans=78, img128=12, st128=2, buf=12, vm=16, lg=90,
                         W=8, lds=260)
    for level in range(1, 5):
        model.add(technique, f"down_{level}", tiles[level],
                  mix(down, slow_down, layered_fraction(level)),
                  n / 4**level * (4 * 16 + 16) * (1.4 if level >= 2 else 1))
    tail = sum((math.ceil(tiles[level] / 32) * 0.6 + 0.4) * (slow_down["lat"] + slow_up["lat"])
               for level in range(5, 9))
    model.add_serial(technique, "levels 5 to 8", tail)
    for level in range(4, 0, -1):
        model.add(technique, f"up_{level}", tiles[level], mix(up, slow_up, layered_fraction(level)),
                  n / 4**level * (16 + 32 / 4 + 16) * (1.4 if level >= 2 else 1))
    gather = model.wave(valu=560, trans=32, qmul=6, img=1, img128=1.6 + 1.2, st64=1, buf=8, vm=6,
                        lg=32, W=8, lds=130)
    model.add(technique, "gather and combine", tiles[0], gather, n * (16 + 8 + 4 + 8))


COARSE_TILES = {"sap_coarse_down": 5, "sap_coarse_up": 4}  # the level whose tiles have a group each
COARSE_SUBGROUPS = {"sap_coarse_down": 8, "sap_coarse_up": 2}  # per group


def short_name(kernel):
    return re.sub(".*/subsurface_", "", kernel)


class Built:
    """What `dermis kernels --json --assembly` reports."""

    def __init__(self, report, assembly):
        self.rows = {(row["kernel"], row.get("constants", "")): row for row in report["kernels"]}
        self.graphs = {graph["graph"]: graph["passes"] for graph in report["graphs"]}
        self.assembly = pathlib.Path(assembly)

    def one_layer_of(self, row):
        """Returns the pipeline of the row's kernel with the least code."""
        rows = [one for one in self.rows.values() if one["kernel"] == row["kernel"]]
        return min(rows, key=lambda row: row["values"]["code_bytes"])

    def wave(self, model, row, layers=2, children_layers=2):
        """Returns the clocks of a subgroup on its longest path. Image loads are taken as half 64
        and half 128 bits. RADV counts occupancy in subgroups of 32."""
        kernel = short_name(row["kernel"])
        special = [key for key in TRIPS if key.split()[0] == kernel
                   and set(key.split()[1:]) <= set(row.get("constants", "").split())]
        values = row["values"]
        with open(self.assembly / row["assembly"], encoding="utf-8") as lines:
            blocks = instruction_mix.read_blocks(lines)
        trips, skipped = TRIPS[max(special, key=len)] if special else [], set()
        if children_layers == 1:
            trips, skipped = ONE_LAYER_CHILDREN_TRIPS, instruction_mix.second_layer_blocks(blocks)
        if layers == 1:
            trips, skipped = ONE_LAYER_TRIPS[kernel], instruction_mix.second_layer_blocks(blocks)
            if kernel == "sap_down":
                skipped |= instruction_mix.largest_branch_blocks(blocks)
        mix_of = instruction_mix.count(blocks, trips, skipped, longest=True)
        get = lambda kind: mix_of.get(kind, 0)
        return model.wave(valu=get("valu"), trans=get("transcendental"), qmul=get("quarter_rate"),
                          img=get("image_load") / 2, img128=get("image_load") / 2,
                          st64=get("image_store") / 2, st128=get("image_store") / 2,
                          buf=get("buffer_load"), lds=8 * get("shared"),
                          vm=get("memory_wait"), lg=get("shared_wait"),
                          W=values["occupancy"] / 2, code=values["code_bytes"],
                          scr=get("scratch_load") + get("scratch_store"))


def add_built(model, technique, built, graph, flagged):
    """The passes of a graph as they are built. flagged: the fraction of tiles next to edges."""
    for one in built.graphs[graph]:
        if not one["kernel"]:  # a clear of a small buffer, which nothing waits for at once
            continue
        kernel, row = short_name(one["kernel"]), built.rows[one["kernel"], one.get("constants", "")]
        bytes_moved = model.covered * (one["read"] + one["written"])
        found = re.search(r"_(\d)$", one["pass"])
        level = int(found.group(1)) if found else 0
        tiles = model.tiles[level]
        if kernel == "classify":
            model.add(technique, one["pass"], model.view_tiles / 16, model.wave(**CLASSIFY),
                      bytes_moved)
        elif kernel == "sap_tiles":
            model.add_serial(technique, one["pass"], lists_by_region(model))
        elif kernel == "tile_list":
            model.add_serial(technique, one["pass"], model.wave(**LIST_RUN)["lat"])
        elif kernel in COARSE_TILES:
            groups = model.tiles[COARSE_TILES[kernel]]
            model.add(technique, one["pass"], COARSE_SUBGROUPS[kernel] * groups,
                      built.wave(model, row), bytes_moved)
        elif kernel in ONE_LAYER_TRIPS:
            both = built.wave(model, row)
            if one["pass"] == "down_2":
                both = mix(built.wave(model, row, children_layers=1), both,
                           layered_fraction(1, flagged))
            wave = mix(built.wave(model, built.one_layer_of(row), layers=1), both,
                       layered_fraction(level, flagged))
            model.add(technique, one["pass"], tiles, wave, bytes_moved)
        else:
            model.add(technique, one["pass"], tiles, built.wave(model, row), bytes_moved)


# Kernels of the pair with an invocation per tile, or per eight tiles.
SAMPLE_KERNELS = {"guided", "afis_tiles"}
TILES_PER_SUBGROUP = {"separable_tiles": 64, "sample_demand": 512, "allocate_samples": 512}


def add_pair(model, built, sampled, vertical, horizontal, samples):
    """The papers' pair with fractions of the listed tiles. Bytes of a part of the tiles are that
    part of the bytes."""
    n, tiles = model.covered, model.tiles[0]
    fractions = {"horizontal": horizontal, "vertical": vertical, "blend": sampled,
                 "accumulate_light": sampled, "blend_accumulated": sampled}
    for one in built.graphs["hybrid_afis_separable"]:
        if not one["kernel"]:
            continue
        kernel = short_name(one["kernel"])
        name, moved = one["pass"], n * (one["read"] + one["written"])
        fraction = sampled if kernel in SAMPLE_KERNELS else fractions.get(name, 1.0)
        level = re.search(r"down_(\d)$", name)
        if kernel == "classify":
            waves, wave = model.view_tiles / 16, model.wave(**CLASSIFY)
        elif kernel == "tile_list":
            model.add_serial("pair", name, model.wave(**LIST_RUN)["lat"])
            continue
        elif kernel == "pyramid_setup":
            waves, wave = model.pixels / 64, model.wave(**AFIS_MIP_SETUP)
        elif level:
            waves = max(1, model.pixels / 64 / 4**int(level.group(1)))
            wave = model.wave(**AFIS_MIP_DOWN)
        elif kernel in SAMPLE_KERNELS:
            counts = guided(samples, "split_half") if kernel == "guided" else afis_built(samples)
            waves, wave = tiles * fraction, model.wave(**counts)
        elif kernel == "separable":
            waves, wave = tiles * fraction, model.wave(**SEPARABLE_BUILT)
        elif kernel == "separable_setup":
            waves, wave = model.view_tiles, model.wave(**SEPARABLE_BUILT_SETUP)
        else:
            waves = tiles * fraction
            if kernel in TILES_PER_SUBGROUP:
                waves = model.view_tiles / TILES_PER_SUBGROUP[kernel]
            wave = built.wave(model, built.rows[one["kernel"], one.get("constants", "")])
        model.add("pair", name, waves, wave, moved * fraction)


def run(hardware, factors=Factors(), width=2560, height=1440, built=None, flagged=0.2,
        covered=COVERED):
    model = Model(hardware, factors, width, height, covered)
    add_rivals(model)
    add_pyramid(model, "SAP shipped", BLOCKS, serial_sap_tiles(model))
    add_pyramid(model, "SAP shipped, 1 layer", BLOCKS, serial_sap_tiles(model), layered=False)
    add_pyramid(model, "SAP prototype", TEXELS, serial_parallel_tiles(model))
    add_pyramid(model, "SAP prototype, 1 layer", TEXELS, serial_parallel_tiles(model),
                layered=False)
    add_target(model)
    for graph in built.graphs if built else ():
        add_built(model, f"{graph} as built", built, graph, 0.0)
        if any(short_name(one["kernel"]) == "sap_gather" for one in built.graphs[graph]):
            add_built(model, f"{graph}, {flagged:.0%} flagged", built, graph, flagged)
    return model


SENSITIVITY = {
    "base": {},
    "latencies x0.5": dict(latency=0.5),
    "latencies x1.5": dict(latency=1.5),
    "no instruction-cache misses": dict(cache_miss=0),
    "misses x2": dict(cache_miss=40),
    "single-group lists x0.5": dict(serial=0.5),
    "fixed 2 us": dict(fixed=0.5),
    "fixed 8 us": dict(fixed=2),
    "best case of blocks": dict(latency=0.5, cache_miss=0, serial=0.5, spill=0),
}


def print_model(model, width, height):
    print(f"\n{model.hardware.name}; {width}x{height}, {COVERED:.0%} covered: "
          f"{model.covered / 1e6:.2f} Mpx")
    for technique, passes in model.techniques.items():
        moved = sum(one.bytes for one in passes)
        memory = sum(one.memory_seconds for one in passes)
        slowest = ", ".join(f"{one.name} {one.seconds * 1e6:.0f} us ({one.limit})"
                            for one in sorted(passes, key=lambda one: -one.seconds)[:6])
        print(f"{technique:24} {model.total(technique) * 1e3:6.2f} ms | {len(passes):2} passes | "
              f"{moved / model.covered:4.0f} B/px, memory alone {memory * 1e3:5.2f} ms | {slowest}")


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--kernels")
    parser.add_argument("--assembly")
    parser.add_argument("--flagged", type=float, default=0.2)
    parser.add_argument("--sensitivity", action="store_true")
    parser.add_argument("--pair")
    options = parser.parse_args()
    built = None
    if options.kernels:
        with open(options.kernels, encoding="utf-8") as file:
            built = Built(json.load(file), options.assembly)
    if options.pair:
        model = Model(RX_6800)
        add_pair(model, built, *map(float, options.pair.split(",")))
        print_model(model, 2560, 1440)
        return
    for hardware in (RX_6800, NVIDIA_LIKE, SMALL_RDNA2, H200, H100):
        for width, height in ((2560, 1440), (1920, 1080)):
            print_model(run(hardware, width=width, height=height, built=built,
                            flagged=options.flagged), width, height)
    if options.sensitivity:
        print("\nsensitivity, RX 6800-class, 2560x1440: total ms")
        for name, factors in SENSITIVITY.items():
            model = run(RX_6800, Factors(**factors), built=built)
            totals = " | ".join(f"{one} {model.total(one) * 1e3:.2f}" for one in model.techniques)
            print(f"{name:28} {totals}")


if __name__ == "__main__":
    sys.exit(main())
