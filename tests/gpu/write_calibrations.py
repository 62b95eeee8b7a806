#!/usr/bin/env python3
"""Writes calibrations for classes of GPUs from kernel statistics and the model of GPU times.

usage: write_calibrations.py FOLDER RUN...
  FOLDER    receives large_gpu.json and small_gpu.json
  RUN       a folder with the assembly and the output, kernels.json, of
            `dermis kernels --json --assembly RUN` on navi21: of all graphs. Further runs add
            what the first lacks

No time is measured. Executed instructions are counted in the assembly: each loop runs as often as
TRIPS says or as the pass takes samples, and EXECUTED of the instructions of each block count,
because subgroups skip branches.
A budget starts from these costs and follows the timestamps of the device, so that their ratios
matter most.
"""
import argparse
import json
import pathlib
import re
import sys

import gpu_model
import instruction_mix

SHADERS = pathlib.Path(__file__).resolve().parents[2] / "shaders"
CLASSES = {"large_gpu": gpu_model.RX_6800, "small_gpu": gpu_model.SMALL_RDNA2}
EXECUTED = 0.75  # fraction of instructions
SPREAD = 0.3  # assumed deviation of one frame
UNITS = 4096  # sample units of the modelled frame
# How often the loops of a kernel run. Others run LOOP times. Of the loops of separable one runs
# about five times, the other only for pixels that do not share their tile's kernel.
TRIPS = {"subsurface.separable": 2, "subsurface.separable_selected": 2,
         "subsurface.tile_refine": 8}
LOOP = 4
# Number of groups that work, of kernels in which all others return at once.
WORKING_GROUPS = {"subsurface.probe": 8, "subsurface.sap_gather_probed": 8}
# Kernels whose loops run once per sample. Each sample reads at a place of its own.
SAMPLING = {"subsurface.afis", "subsurface.afis_published", "subsurface.afis_tiles",
            "subsurface.burley", "subsurface.fixed", "subsurface.guided", "subsurface.refine",
            "subsurface.residual"}
HALVES = "guidance=split_half"  # a loop over both halves of the samples is around the other loop
DEFAULT_SAMPLES = 16
CHOSEN_BY_BUDGET = {"skin", "hybrid"}  # graphs of which each work has a line
# Invocations per group of kernels whose size the host sets, by the id of the constant.
LANES_BY_ID = {3: 128, 6: 512, 7: 64}
# How often nested loops run, from outside in: tiles of a group, levels one after another, texels of
# an invocation. Loops inside these run LOOP times. Most tiles fail the first uniformity checks.
NESTED_TRIPS = {"subsurface.sap_coarse_down": (1, 4), "subsurface.sap_coarse_up": (1, 5, 1),
                "subsurface.classify_uniform_light": (1, 1, 1, 1), "subsurface.probe": (2, 16)}


def invocations(kernel):
    """Returns the invocations per group, from the kernel's source and its includes."""
    pending, seen = [SHADERS / f"{kernel}.comp"], set()
    while pending:
        path = pending.pop(0)
        if path in seen or not path.exists():
            continue
        seen.add(path)
        text = path.read_text(encoding="utf-8")
        by_id = re.search(r"local_size_x_id = (\d+)", text)
        if by_id:
            return LANES_BY_ID[int(by_id.group(1))]
        sizes = re.search(r"local_size_x = (\d+), local_size_y = (\d+)", text)
        if sizes:
            return int(sizes.group(1)) * int(sizes.group(2))
        pending += [SHADERS / name for name in re.findall(r'#include "(.*?)"', text)]
    return 64


def samples_of(work):
    """Returns the samples per pixel. Between a minimum and a maximum it is their geometric mean."""
    stated = {name: int(value)
              for name, value in re.findall(r"\b((?:min_|max_)?samples)=(\d+)", work)}
    if "min_samples" in stated:
        return (stated["min_samples"] * stated["max_samples"]) ** 0.5
    return stated.get("samples", DEFAULT_SAMPLES)


def nested_trips(work):
    """Returns how often the nested loops of a kernel run, from outside in."""
    name = work.split()[0]
    if name in SAMPLING:
        return (2, samples_of(work) / 2) if HALVES in work else (samples_of(work),)
    return NESTED_TRIPS.get(name, ())


def executed(work, assembly):
    """Returns the executed instructions by class; "scattered": reads of texels in sample loops."""
    blocks = instruction_mix.read_blocks(assembly.splitlines())
    trips = TRIPS.get(work.split()[0], LOOP)
    loops = instruction_mix.find_loops(blocks)
    nested = nested_trips(work)
    depths = [sum(first <= loop[0] and loop[1] <= last for first, last in loops) - 1
              for loop in loops]
    counts = [nested[depth] if depth < len(nested) else trips for depth in depths]
    mix = instruction_mix.count(blocks, counts)
    mix["scattered"] = 0
    if work.split()[0] in SAMPLING:
        outside = instruction_mix.count(blocks, [0 for _ in counts])
        mix["scattered"] = mix.get("image_load", 0) - outside.get("image_load", 0)
        mix["image_load"] = outside.get("image_load", 0)
    return {kind: number * EXECUTED for kind, number in mix.items()}


def wave_of(model, row, mix):
    """Returns the clocks of a subgroup; RADV counts occupancy in subgroups of 32."""
    values = row["values"]
    return model.wave(valu=mix.get("valu", 0) + mix.get("scalar", 0) / 4,
                      trans=mix.get("transcendental", 0), qmul=mix.get("quarter_rate", 0),
                      img=mix.get("image_load", 0), scat=mix.get("scattered", 0),
                      st64=mix.get("image_store", 0),
                      buf=mix.get("buffer_load", 0) + mix.get("buffer_store", 0),
                      lds=4 * mix.get("shared", 0),
                      vm=(mix.get("image_load", 0) + mix.get("scattered", 0)
                          + mix.get("buffer_load", 0)) / 4,
                      lg=mix.get("shared", 0) / 4 + mix.get("scalar_load", 0) / 2,
                      W=values["occupancy"] / 2, code=values["code_bytes"],
                      scr=mix.get("scratch_load", 0) + mix.get("scratch_store", 0))


def interval_of(work):
    """Returns the mean number of frames from one in which the kernel works to the next."""
    stated = re.search(r"\binterval=(\d+)", work)
    return int(stated.group(1)) if stated else 1


def cost_of(model, work, row, assembly):
    wave = wave_of(model, row, executed(work["work"], assembly))
    bytes_moved = (work["read"] + work["written"]) * model.covered
    per = work["per"]
    if per in ("listed_tiles", "copied_tiles"):
        counted = model.tiles[0]
        launched = model.tiles[work.get("level", 0)]
    elif per in ("sample_units", "selected_tiles"):
        counted = launched = UNITS
        bytes_moved = (work["read"] + work["written"]) * 64 * UNITS
    else:
        counted = launched = work["groups"]
    working = WORKING_GROUPS.get(work["work"].split()[0])
    if working is not None:
        launched, counted, bytes_moved = working, 1, 0
    subgroups = launched * max(1, invocations(work["kernel"]) / 64)
    model.add(work["work"], work["work"], subgroups, wave, bytes_moved)
    fixed = model.hardware.fixed
    seconds = fixed + (model.total(work["work"]) - fixed) / interval_of(work["work"])
    least = fixed + wave["lat"] / model.hardware.clock
    base = min(seconds, least) if counted > 1 else seconds
    return base * 1e6, max(0.0, seconds - base) / counted * 1e6


def read_run(folder):
    """Returns the report of a run, with the paths of its assembly."""
    report = json.loads((folder / "kernels.json").read_text(encoding="utf-8"))
    if not report["statistics"]:
        sys.exit(f"{folder}: {report['driver']} reports no statistics of kernels")
    for row in report["kernels"]:
        row["assembly"] = folder / row["assembly"]
    return report


def merged(reports):
    """Returns the first report with the works that only the others have."""
    out = reports[0]
    for report in reports[1:]:
        known = {work["work"] for work in out["works"]}
        out["works"] += [work for work in report["works"] if work["work"] not in known]
        out["kernels"] += report["kernels"]
    return out


def rows_of(work, rows):
    """Returns the kernel's rows whose constants have most of the work's settings."""
    settings = set(work["work"].split()[1:])
    found, most = [], -1
    for row in rows:
        if row["kernel"] != work["kernel"]:
            continue
        equal = len(settings & set(row.get("constants", "").split()))
        if equal > most:
            found, most = [], equal
        if equal == most:
            found.append(row)
    return found


def costs_of(report, hardware):
    """Returns the costs of the works. Graphs without a choice need no line for each setting, so
    equal costs of their pass types count once."""
    costs, known = [("clear", hardware.fixed * 1e6, 0.0)], set()  # small buffers
    for work in report["works"]:
        rows = rows_of(work, report["kernels"])
        assembly = rows[0]["assembly"].read_text(encoding="utf-8")
        cost = cost_of(gpu_model.Model(hardware), work, rows[0], assembly)
        kind = (work["work"].split()[0], *(f"{value:.2g}" for value in cost))
        if kind not in known or any(not CHOSEN_BY_BUDGET.isdisjoint(row["graphs"])
                                    for row in rows):
            costs.append((work["work"], *cost))
        known.add(kind)
    return costs


def text_of(hardware, report, costs):
    lines = [f"// Modelled, not measured: counts of {report['device']} with",
             f"// {report['driver']}, and the model of tests/gpu/gpu_model.py.",
             "// tests/gpu/write_calibrations.py writes this file.", "{",
             '  "$schema": "../../schema/calibration.schema.json",', '  "dermis_calibration": 2,',
             f'  "device": {json.dumps(hardware.name + ", modelled")},', '  "costs": [']
    for i, (work, base, group) in enumerate(costs):
        comma = "," if i + 1 < len(costs) else ""
        lines.append(f'    {{ "work": {json.dumps(work)}, "base_us": {base:.3g}, '
                     f'"group_us": {group:.3g}, "spread": {SPREAD} }}{comma}')
    return "\n".join(lines + ["  ]", "}", ""])


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("runs", type=pathlib.Path, nargs="+")
    options = parser.parse_args()
    report = merged([read_run(run) for run in options.runs])
    for name, hardware in CLASSES.items():
        path = options.folder / f"{name}.json"
        costs = costs_of(report, hardware)
        path.write_text(text_of(hardware, report, costs), encoding="utf-8")


if __name__ == "__main__":
    main()
