#!/usr/bin/env python3
"""Prints what the limits say of the kernels of a device.

usage: summarise_kernels.py FAMILY VALUES
  VALUES  output of `dermis kernels --json --limits FILE`
Exit code: 1 if a limit is exceeded, or if the kernels were not compiled.
"""
import json
import sys


def lines_of(family, report):
    if "limits" not in report:
        yield f"kernels on {family}: {report.get('error', 'no limits were checked')}"
        yield from (one["text"] for one in report.get("diagnostics", []))
        return
    limits = report["limits"]
    yield (f"kernels on {family} ({report['driver']}): {limits['checked']} limits checked: "
           f"{len(limits['exceeded'])} exceeded, {len(limits['open'])} not yet at their goal")
    for skipped in report["skipped"]:
        yield f"{skipped['graph']}: skipped, {skipped['why']}"
    for one in limits["exceeded"]:
        bound = "at least" if one["minimum"] else "at most"
        yield (f"  {one['subject']}: {one['value']} is {one['found']}, {bound} {one['limit']} is "
               f"allowed  ({one['place']})")


def main():
    family, name = sys.argv[1:]
    with open(name, encoding="utf-8") as file:
        text = file.read()
    try:
        report = json.loads(text)
    except ValueError:
        sys.exit(f"kernels on {family}: `dermis kernels` printed no JSON: {text[:200]}")
    print("\n".join(lines_of(family, report)))
    sys.exit(0 if report.get("ok") else 1)


if __name__ == "__main__":
    main()
