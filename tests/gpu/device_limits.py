#!/usr/bin/env python3
"""Prints a limits file for one device: limits relative to one ray query become numbers.

usage: device_limits.py LIMITS ONE_RAY_QUERY
  LIMITS         the limits file; a limit may be "1.1 * one_ray_query", a factor on the scratch
                 memory of a kernel with one ray query
  ONE_RAY_QUERY  output of `dermis kernels restir --json` on the device, with one_ray_query.comp in
                 place of restir_initial.comp
"""
import json
import re
import sys

RELATIVE = re.compile(r'"([0-9.]+) \* one_ray_query"')
REPLACED = "restir/restir_initial"  # the kernel whose place one_ray_query.comp takes


def scratch_of_one_ray_query(name):
    with open(name, encoding="utf-8") as file:
        kernels = json.load(file)["kernels"]
    found = [row["values"]["scratch_bytes"] for row in kernels if row["kernel"] == REPLACED]
    return max(found, default=0)  # without ray queries the limits apply to no kernel


def for_device(text, name):
    """Returns the text of a limits file. `name`: ONE_RAY_QUERY, read if a limit is relative."""
    if not RELATIVE.search(text):
        return text
    scratch = scratch_of_one_ray_query(name)
    return RELATIVE.sub(lambda match: str(int(float(match.group(1)) * scratch)), text)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as limits:
        print(for_device(limits.read(), sys.argv[2]), end="")
