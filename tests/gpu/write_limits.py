#!/usr/bin/env python3
"""Rewrites the present values in kernel_limits.json.

usage: write_limits.py [--worse] LIMITS VALUES...
  LIMITS   the limits file; its rules without "now" are the goals
  VALUES   output of `dermis kernels --json`, one file per device (check_kernels.sh writes them); if
           a limit is relative, FAMILY.one_ray_query.json belongs to FAMILY.json (device_limits.py)
  --worse  also accept values that are worse than the file's present values

Values beyond a goal get a rule with "goal" and "now"; all other rules with "now" are removed.
"""
import argparse
import fnmatch
import json
import re
import sys

import device_limits

HEADING = "    // Present values beyond their goals, written by write_limits.py."
DRIVERS = {
    "NAVI21": "*Mesa 22.3*",
    "VEGA10": "*Mesa 22.3*",
    "NAVI31": "*Mesa 25.0*",
    "GFX1201": "*Mesa 25.0*",
}


def without_comments(text):
    return re.sub(r'("(?:[^"\\]|\\.)*")|//[^\n]*', lambda match: match.group(1) or "", text)


def matches(patterns, text):
    patterns = [patterns] if isinstance(patterns, str) else patterns or ["*"]
    return any(fnmatch.fnmatchcase(text, pattern) for pattern in patterns)


def limits_of(rules, values, kernel):
    """Returns {(key, minimum): limit} of the last rules that match the kernel."""
    found = {}
    for rule in rules:
        subjects = (("device", values["device"]), ("driver", values["driver"]), ("kernel", kernel))
        if "kernel" in rule and all(matches(rule.get(key), text) for key, text in subjects):
            for side in ("max", "min"):
                for key, limit in rule.get(side, {}).items():
                    found[key, side] = limit
    return found


def worst_values(rows):
    """Returns {kernel: {key: (least, most)}} over all pipelines of a kernel."""
    kernels = {}
    for row in rows:
        known = kernels.setdefault(row["kernel"], {})
        for key, value in row["values"].items():
            least, most = known.get(key, (value, value))
            known[key] = (min(least, value), max(most, value))
    return kernels


def is_beyond(value, limit, side):
    return value > limit if side == "max" else value < limit


def is_present(rule):
    limits = [*rule.get("max", {}).values(), *rule.get("min", {}).values()]
    return any(isinstance(limit, dict) for limit in limits)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--worse", action="store_true")
    parser.add_argument("limits")
    parser.add_argument("values", nargs="+")
    options = parser.parse_args()
    text = open(options.limits, encoding="utf-8").read()
    lines, worse = [], []
    for name in options.values:
        values = json.load(open(name, encoding="utf-8"))
        own = device_limits.for_device(text, re.sub(r"\.json$", ".one_ray_query.json", name))
        rules = json.loads(without_comments(own))["rules"]
        goals = [rule for rule in rules if not is_present(rule)]
        before = [rule for rule in rules if is_present(rule)]
        family = next((one for one in DRIVERS if one in values["device"]), None)
        if family is None:
            sys.exit(f"{name}: '{values['device']}' is none of {', '.join(DRIVERS)}")
        for kernel, ranges in sorted(worst_values(values["kernels"]).items()):
            present = {"max": {}, "min": {}}
            earlier = limits_of(before, values, kernel)
            for (key, side), goal in sorted(limits_of(goals, values, kernel).items()):
                if key not in ranges:
                    continue
                value = ranges[key][1 if side == "max" else 0]
                if not is_beyond(value, goal, side):
                    continue
                present[side][key] = {"goal": goal, "now": value}
                known = earlier.get((key, side), {"now": goal if before else value})
                if is_beyond(value, known["now"], side):
                    worse.append(f"{kernel} on {family}: {key} is {value}, before {known['now']}")
            present = {side: limits for side, limits in present.items() if limits}
            if present:
                subject = {"device": f"*{family}*", "driver": DRIVERS[family], "kernel": kernel}
                lines.append("    " + json.dumps({**subject, **present}))
    if worse and not options.worse:
        sys.exit("values became worse; --worse accepts them:\n  " + "\n  ".join(worse))
    head = text[: text.index(HEADING)].rstrip()
    end = head.rindex("}") + 1  # of the last goal
    rest = head[end:].lstrip(",")
    body = ",\n".join(lines)
    with open(options.limits, "w", encoding="utf-8") as out:
        out.write(head[:end] + ("," if lines else "") + rest + "\n" + HEADING + "\n")
        out.write((body + "\n" if lines else "") + "  ]\n}\n")


main()
