#!/usr/bin/env python3
"""Compares guidance of sample counts with equal counts everywhere at equal modelled GPU time.

usage: equal_time.py REPORT [--width N --height N]
  REPORT  output of `dermis bench dynamic --file tests/benchmark/guidance.json --json REPORT`

Prints a Markdown table per sequence: samples per pixel, samples that a group runs (the most of its
64 pixels), modelled time of all passes, PSNR, and the difference from `afis` and `fixed` at the
same modelled time, interpolated in the logarithm of time. Times are modelled by gpu_model.py for
50 % covered pixels; nothing was measured on a GPU. Differences outside the range of measured counts
are left out.
"""
import argparse
import json
import math

import gpu_counts
import gpu_model

LINE = "| {} | {} | {} | {} | {} | {} | {} | {} |"


def milliseconds(row, model):
    """Returns the modelled time of a row's frame."""
    name = f"{row['technique']} {row['setting']} {row['guidance']}"
    samples = row["group_spp"]
    if row["technique"] == "fixed":
        gpu_model.add_fixed(model, name, samples)
    else:
        guidance = row["guidance"] if row["technique"] == "afis_guided" else None
        pooled = "published" not in row["setting"]
        gpu_model.add_afis(model, name, samples, guidance, pooled)
    return 1e3 * model.total(name)


def at_time(curve, ms):
    """Returns the PSNR of a curve of (ms, dB) at a time, or None outside its range."""
    for (low, first), (high, last) in zip(curve, curve[1:]):
        if low <= ms <= high:
            return first + (last - first) * math.log(ms / low) / math.log(high / low)
    return None


def difference(curve, row):
    other = at_time(curve, row["ms"])
    return "" if other is None else f"{row['psnr_db_frame'] - other:+.1f}"


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("report")
    parser.add_argument("--width", type=int, default=2560)
    parser.add_argument("--height", type=int, default=1440)
    options = parser.parse_args()
    with open(options.report, encoding="utf-8") as file:
        rows = json.load(file)["rows"]
    model = gpu_model.Model(gpu_model.RX_6800, width=options.width, height=options.height)
    sequences = {}
    for row in rows:
        if row["technique"] not in ("fixed", "afis", "afis_guided"):
            continue
        row["ms"] = milliseconds(row, model)
        sequences.setdefault((row["scene"], row["framing"]), []).append(row)
    print(f"{model.hardware.name}; {options.width}x{options.height}; times are modelled")
    for (scene, framing), of_scene in sequences.items():
        curves = {technique: sorted((row["ms"], row["psnr_db_frame"]) for row in of_scene
                                    if row["technique"] == technique)
                  for technique in ("afis", "fixed")}
        print(f"\n{scene}, {framing}, d = {of_scene[0]['d_px']:.1f} px\n")
        print(LINE.format("technique", "guidance", "samples", "samples of a group", "ms",
                          "PSNR dB", "against `afis` dB", "against `fixed` dB"))
        print("|---|---|---|---|---|---|---|---|")
        for row in of_scene:
            print(LINE.format(f"`{row['technique']}` {row['setting']}", row["guidance"],
                              f"{row['mean_spp']:.1f}", f"{row['group_spp']:.1f}",
                              f"{row['ms']:.2f}", f"{row['psnr_db_frame']:.1f}",
                              difference(curves["afis"], row), difference(curves["fixed"], row)))


if __name__ == "__main__":
    main()
