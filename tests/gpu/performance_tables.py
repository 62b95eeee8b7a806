#!/usr/bin/env python3
"""Prints the tables of docs/performance.md: modelled times, and measured next to modelled ones.

usage: performance_tables.py KERNELS ASSEMBLY [--measured FOLDER] [--write FILE]
  KERNELS, ASSEMBLY  as gpu_model.py takes them: `dermis kernels sap separable burley fixed afis
            afis_published --size 2560x1440 --unbound scattered_light,albedo,scatter_scale --json
            --assembly ASSEMBLY` on navi21
  --measured  output folder of `measure.sh 1` with the same kernels; without it, only the modelled
            times are printed
  --write   replaces the text between the lines "<!-- begin NAME -->" and "<!-- end NAME -->" of
            the file; NAME: modelled, measured
"""
import argparse
import json
import pathlib
import re

import gpu_model

HARDWARE = {"NVIDIA H200": gpu_model.H200, "NVIDIA H100 80GB HBM3": gpu_model.H100}
SIZES = ("2560x1440", "1920x1080")
GAMING = {"RX 6800-class": gpu_model.RX_6800, "NVIDIA-like": gpu_model.NVIDIA_LIKE,
          "small RDNA2": gpu_model.SMALL_RDNA2}
ROWS = {"`sap`, no tile next to an edge": "sap as built",
        "`sap`, 20 % of the tiles next to edges": "sap, 20% flagged",
        "`separable`, 25 taps": "separable as built",
        "`burley`, 32 samples": "burley 32 as built", "`fixed`, 16 samples": "fixed 16 as built",
        "`afis`, 16 samples": "afis 16 as built",
        "`afis_published`, 16 samples": "afis_published 16"}
MODELLED = {"sap": "sap, 20% flagged", "separable": "separable as built",
            "burley": "burley 32 as built", "fixed": "fixed 16 as built",
            "afis": "afis 16 as built", "afis_published": "afis_published 16"}


def read_times(folder):
    """Returns the reports of `dermis render` by technique and size."""
    reports = {}
    for path in sorted(folder.glob("times_*.json")):
        name, size = re.fullmatch(r"times_(.*)_(\d+x\d+)", path.stem).groups()
        reports[name, size] = json.loads(path.read_text(encoding="utf-8"))
    return reports


def model_of(report, built):
    width, height = report["width"], report["height"]
    return gpu_model.run(HARDWARE[report["device"]], width=width, height=height, built=built,
                         covered=report["subsurface_pixels"] / (width * height))


def totals(reports, built):
    yield "| technique | " + " | ".join(f"{size}: measured | modelled" for size in SIZES) + " |"
    yield "|---|" + "---|" * (2 * len(SIZES))
    names = sorted({name for name, _ in reports}, key=lambda name: (
        list(MODELLED).index(name) if name in MODELLED else len(MODELLED), name))
    for name in names:
        cells = []
        for size in SIZES:
            report = reports.get((name, size))
            cells.append(f"{report['device_ms']:.3f}" if report else "")
            modelled = report and MODELLED.get(name)
            cells.append(f"{1e3 * model_of(report, built).total(modelled):.3f}" if modelled else "")
        yield f"| `{name}` | " + " | ".join(cells) + " |"


def passes(report, built, name):
    """Returns rows for the passes of a technique that is modelled as built."""
    modelled = {one.name: one for one in model_of(report, built).techniques[MODELLED[name]]}
    yield f"| pass of `{name}` | measured us | modelled us | limit in the model |"
    yield "|---|---|---|---|"
    for one in report["passes"]:
        other = modelled.get(one["pass"])
        yield (f"| `{one['pass']}` | {1e3 * one['milliseconds']:.0f} | "
               + (f"{1e6 * other.seconds:.0f} | {other.limit} |" if other else "| |"))


def pictures(folder):
    yield "| technique | RMSE | RMSE, low | RMSE, high |"
    yield "|---|---|---|---|"
    for path in sorted(folder.glob("picture_*.json")):
        error = json.loads(path.read_text(encoding="utf-8"))["error"]
        yield (f"| `{path.stem.removeprefix('picture_')}` | {error['rmse']:.5f} | "
               f"{error['rmse_low']:.5f} | {error['rmse_high']:.5f} |")


def modelled(built):
    yield "| technique | " + " | ".join(
        f"{name}, {size.split('x')[1]}p" for name in GAMING for size in SIZES) + " |"
    yield "|---|" + "---|" * (len(GAMING) * len(SIZES))
    models = [gpu_model.run(hardware, width=width, height=height, built=built)
              for hardware in GAMING.values()
              for width, height in (map(int, size.split("x")) for size in SIZES)]
    for row, technique in ROWS.items():
        cells = (f"{1e3 * model.total(technique):.2f}" for model in models)
        yield f"| {row} | " + " | ".join(cells) + " |"


def measured(folder, built):
    reports = read_times(folder)
    first = next(iter(reports.values()))
    share = first["subsurface_pixels"] / (first["width"] * first["height"])
    driver = re.search(r"GPU, (.*?), Vulkan", (folder / "doctor.txt").read_text(encoding="utf-8"))
    yield (f"Device: {first['device']}, driver {driver.group(1)}. Scene: bust, {share:.0%} of the "
           "pixels covered.")
    yield ""
    yield "Milliseconds per frame, median over frames, sum of the passes:"
    yield ""
    yield from totals(reports, built)
    for name in ("sap", "separable"):
        yield ""
        yield f"Passes of `{name}` at {SIZES[0]}:"
        yield ""
        yield from passes(reports[name, SIZES[0]], built, name)
    yield ""
    yield "Errors at 640x360 on this GPU against the reference:"
    yield ""
    yield from pictures(folder)


def replaced(page, name, text):
    begin, end = f"<!-- begin {name} -->\n", f"\n<!-- end {name} -->"
    first, last = page.index(begin) + len(begin), page.index(end)
    return page[:first] + text + page[last:]


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("kernels", type=pathlib.Path)
    parser.add_argument("assembly")
    parser.add_argument("--measured", type=pathlib.Path)
    parser.add_argument("--write", type=pathlib.Path)
    options = parser.parse_args()
    built = gpu_model.Built(json.loads(options.kernels.read_text(encoding="utf-8")),
                            options.assembly)
    sections = {"modelled": modelled(built)}
    if options.measured:
        sections["measured"] = measured(options.measured, built)
    texts = {name: "\n".join(lines) for name, lines in sections.items()}
    if not options.write:
        print("\n\n".join(texts.values()))
        return
    page = options.write.read_text(encoding="utf-8")
    for name, text in texts.items():
        page = replaced(page, name, text)
    options.write.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
