#!/usr/bin/env python3
"""Counts the instructions that an invocation of a kernel executes, from the compiler's assembly.

usage: instruction_mix.py [--trips N,N,...] [--skip BB3-BB7,BB9] [--one-layer] [--longest]
                          [--limit N] [--texels N] [--json] FILE
  FILE      assembly of RADV, from `dermis kernels --assembly DIR`
  --trips   how often each loop runs, in the order of their first blocks; default: once
  --skip    blocks that the counted path does not execute, as ranges of numbers in the file
  --one-layer  leaves out what kernels of the pyramid only do for texels with a second layer
  --longest counts only the path with the most vector instructions: an upper limit that assumes
            nothing about branches. Both sides of a divergent branch are on one path
  --limit   exit code 1 if there are more vector instructions
  --texels  texels per invocation; counts are divided by it
  --blocks  also print each block's counts and targets, to choose --skip

A subgroup executes an instruction for all of its invocations at once, so counts per subgroup are
counts per invocation. "memory_wait" and "shared_wait" are waits for loads that were issued since
the last such wait: of memory, and of shared or scalar memory. "vector" is the sum of vector
arithmetic: valu, transcendental and quarter rate.
"""
import argparse
import json
import re
import sys

CLASSES = [  # the first pattern that matches an instruction's name decides
    (r"image_(load|sample|gather|msaa)", "image_load"),
    (r"image_store", "image_store"),
    (r"scratch_load", "scratch_load"),
    (r"scratch_store", "scratch_store"),
    (r"(buffer|global|flat)_load", "buffer_load"),
    (r"(buffer|global|flat)_(store|atomic)", "buffer_store"),
    (r"ds_", "shared"),
    (r"v_s?_?(exp|log|rcp|rsq|sqrt|sin|cos)_", "transcendental"),
    (r"v_mul_(lo|hi)_", "quarter_rate"),
    (r"v_", "valu"),
    (r"s_(load|buffer_load)", "scalar_load"),
    (r"s_c?branch", "branch"),
    (r"s_wait", "wait"),
    (r"s_", "scalar"),
]
VECTOR = ("valu", "transcendental", "quarter_rate")


def class_of(name, line):
    # Before GFX11, scratch memory is accessed by buffer instructions without an index or address.
    if re.match(r"buffer_(load|store)", name) and not re.search(r"\b(offen|idxen)\b", line):
        return "scratch_load" if "load" in name else "scratch_store"
    return next((kind for pattern, kind in CLASSES if re.match(pattern, name)), "other")


class Block:
    def __init__(self, number):
        self.number = number
        self.counts = {}
        self.targets = []
        self.falls_through = True  # to the next block
        self.tests_sign = False  # leaves invocations out whose value is not negative


def read_blocks(lines):
    """Returns the blocks in order. An instruction's line ends in its encoding, after a ';'."""
    blocks, pending = [], {"memory_wait": False, "shared_wait": False}

    def note_wait(kind, counter):
        if pending[kind] and counter:
            blocks[-1].counts[kind] = blocks[-1].counts.get(kind, 0) + 1
            pending[kind] = False

    for line in lines:
        label = re.match(r"BB(\d+):", line)
        if label:
            blocks.append(Block(int(label.group(1))))
        instruction = re.match(r"\s+([a-z]\w+)(.*?);", line)
        if instruction and blocks:
            kind = class_of(instruction.group(1), line)
            blocks[-1].counts[kind] = blocks[-1].counts.get(kind, 0) + 1
            pending["memory_wait"] |= kind in ("image_load", "buffer_load", "scratch_load")
            pending["shared_wait"] |= kind in ("shared", "scalar_load")
            if kind == "wait":
                note_wait("memory_wait", re.search(r"vmcnt|loadcnt|samplecnt", line))
                note_wait("shared_wait", re.search(r"lgkmcnt|dscnt|kmcnt", line))
            blocks[-1].targets += [int(n) for n in re.findall(r"BB(\d+)", instruction.group(2))]
            if re.match(r"\s+v_cmpx_gt_i32\S*\s+0, v", line):
                blocks[-1].tests_sign = True
            if instruction.group(1) in ("s_branch", "s_endpgm"):
                blocks[-1].falls_through = False
    return blocks


def find_loops(blocks):
    """Returns (first, last) positions of each loop: a branch back to an earlier block."""
    position = {block.number: i for i, block in enumerate(blocks)}
    ends = {}
    for i, block in enumerate(blocks):
        for target in block.targets:
            if position.get(target, i + 1) <= i:
                ends[position[target]] = max(ends.get(position[target], 0), i)
    return sorted(ends.items())


def parse_ranges(text):
    numbers = set()
    for part in filter(None, text.split(",")):
        first, last = re.fullmatch(r"BB(\d+)(?:-BB(\d+))?", part).groups()
        numbers.update(range(int(first), int(last or first) + 1))
    return numbers


def vector_of(counts):
    return sum(counts.get(kind, 0) for kind in VECTOR)


def second_layer_blocks(blocks):
    """Returns the numbers of the blocks that are left out where texels have no second layer. The
    sign of a texel's depth says so, and kernels of the pyramid branch on no other sign."""
    position = {block.number: i for i, block in enumerate(blocks)}
    return {skipped.number for i, block in enumerate(blocks) if block.tests_sign
            for target in block.targets for skipped in blocks[i + 1:position[target]]}


def largest_branch_blocks(blocks):
    """Returns the numbers of the blocks that the largest branch leaves out, by vector instructions.
    Branches to the end of the kernel do not count."""
    position = {block.number: i for i, block in enumerate(blocks)}
    vectors = [vector_of(block.counts) for block in blocks]
    regions = [(i + 1, position.get(target, 0)) for i, block in enumerate(blocks)
               for target in block.targets]
    first, last = max((one for one in regions if sum(vectors[one[1]:]) > 0),
                      key=lambda one: sum(vectors[one[0]:one[1]]), default=(0, 0))
    return {block.number for block in blocks[first:last]}


def on_longest_path(blocks, weights):
    """Returns for each block whether it is on the path with the most vector instructions. Branches
    back to an earlier block are loops, whose blocks `weights` multiplies; the path then goes on
    behind the loop."""
    position = {block.number: i for i, block in enumerate(blocks)}
    loop_ends = dict(find_loops(blocks))
    best, following = [0.0] * len(blocks), [None] * len(blocks)

    def next_of(i):
        ones = [position[target] for target in blocks[i].targets if target in position]
        return ones + [i + 1] if blocks[i].falls_through and i + 1 < len(blocks) else ones

    def ends_of_loop(first):
        """Returns the blocks behind a loop to which its blocks lead."""
        last = loop_ends[first]
        return [one for i in range(first, last + 1) for one in next_of(i) if one > last]

    for i in reversed(range(len(blocks))):
        next_ones = [one for one in next_of(i) if one > i]
        for first in (one for one in next_of(i) if one <= i):
            next_ones += ends_of_loop(first)
        if next_ones:
            following[i] = max(next_ones, key=lambda one: best[one])
        best[i] = (weights[i] * vector_of(blocks[i].counts)
                   + (best[following[i]] if next_ones else 0.0))
    path, at = [False] * len(blocks), 0
    while at is not None:
        path[at] = True
        at = following[at]
    return path


def count(blocks, trips=(), skipped=frozenset(), texels=1, longest=False):
    """Returns the executed instructions by class, with the sum "vector"."""
    weights = [0.0 if block.number in skipped else 1.0 for block in blocks]
    for (first, last), trip in zip(find_loops(blocks), trips):
        for i in range(first, last + 1):
            weights[i] *= trip
    if longest:
        weights = [weight if used else 0.0
                   for weight, used in zip(weights, on_longest_path(blocks, weights))]
    total = {}
    for block, weight in zip(blocks, weights):
        for kind, number in block.counts.items():
            total[kind] = total.get(kind, 0) + weight * number / texels
    total["vector"] = vector_of(total)
    return total


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--trips", default="")
    parser.add_argument("--skip", default="")
    parser.add_argument("--one-layer", action="store_true")
    parser.add_argument("--longest", action="store_true")
    parser.add_argument("--limit", type=float)
    parser.add_argument("--texels", type=float, default=1)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--blocks", action="store_true")
    parser.add_argument("file")
    options = parser.parse_args()
    with open(options.file, encoding="utf-8") as lines:
        blocks = read_blocks(lines)
    if not blocks:
        sys.exit(f"{options.file}: no blocks of instructions")
    trips = [float(trip) for trip in options.trips.split(",") if trip]
    skipped = parse_ranges(options.skip)
    if options.one_layer:
        skipped |= second_layer_blocks(blocks)
    total = count(blocks, trips, skipped, options.texels, options.longest)
    if options.limit is not None and total["vector"] > options.limit:
        sys.exit(f"{options.file}: {total['vector']:.0f} vector instructions, "
                 f"limit {options.limit:.0f}")
    if options.json:
        print(json.dumps(total, sort_keys=True))
        return
    if options.blocks:
        for block in blocks:
            targets = ", ".join(f"BB{target}" for target in block.targets)
            print(f"BB{block.number}: {block.counts} -> {targets or 'next'}")
    for i, (first, last) in enumerate(find_loops(blocks)):
        print(f"loop {i}: BB{blocks[first].number} to BB{blocks[last].number}")
    for kind, number in sorted(total.items()):
        print(f"{kind:16} {number:10.1f}")


if __name__ == "__main__":
    main()
