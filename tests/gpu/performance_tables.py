#!/usr/bin/env python3
"""Prints the measured times of docs/performance.md next to modelled ones.

usage: performance_tables.py MEASURED KERNELS ASSEMBLY [--write FILE]
  MEASURED  output folder of `measure.sh 1`
  KERNELS, ASSEMBLY  as gpu_model.py takes them: `dermis kernels sap separable --unbound
            scattered_light,albedo,scatter_scale --json --assembly ASSEMBLY` on navi21
  --write   replaces the text between the lines "<!-- begin measured -->" and "<!-- end measured
            -->" of the file
"""
import argparse
import json
import pathlib
import re

import gpu_model

HARDWARE = {"NVIDIA H200": gpu_model.H200, "NVIDIA H100 80GB HBM3": gpu_model.H100}
SIZES = ("2560x1440", "1920x1080")
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


def tables(folder, built):
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


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("measured", type=pathlib.Path)
    parser.add_argument("kernels")
    parser.add_argument("assembly")
    parser.add_argument("--write", type=pathlib.Path)
    options = parser.parse_args()
    with open(options.kernels, encoding="utf-8") as file:
        built = gpu_model.Built(json.load(file), options.assembly)
    text = "\n".join(tables(options.measured, built))
    if not options.write:
        print(text)
        return
    begin, end = "<!-- begin measured -->\n", "\n<!-- end measured -->"
    page = options.write.read_text(encoding="utf-8")
    first, last = page.index(begin) + len(begin), page.index(end)
    options.write.write_text(page[:first] + text + page[last:], encoding="utf-8")


if __name__ == "__main__":
    main()
