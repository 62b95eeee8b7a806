#!/usr/bin/env python3
"""Writes the figures of `dermis bench all` into the documents.

usage: quote_benches.py FOLDER [--commit HASH] [--write]
  FOLDER    as `dermis bench all --out FOLDER` wrote it; tables of missing suites are not changed
  --commit  the measured commit, for the text above the tables
  --write   replaces the text between the lines "<!-- begin NAME -->" and "<!-- end NAME -->" of
            README.md and docs/*.md; without it, the tables are printed
"""
import argparse
import html.parser
import json
import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = ("flashing", "regular", "dynamic")
GUIDANCES = {"AS": "spvg", "AS+OCV": "ocv", "AS+CCV": "ccv"}
# Rows that the paper does not have.
OTHERS = {"`ccv`, mean control, one count per tile": {"guidance": "ccv", "setting": "8..64"},
          "`sap`": {"technique": "sap"}, "`sap_residual`": {"technique": "sap_residual"}}
PAPER_TITLE = "Comparison with the paper's table 3"


class Tables(html.parser.HTMLParser):
    """Collects the tables of a page by the heading above, as rows of cells; the first: titles."""

    def __init__(self, page):
        super().__init__()
        self.tables, self.heading, self.state = {}, "", ""
        self.feed(page)

    def handle_starttag(self, tag, _):
        if tag == "h2":
            self.heading, self.state = "", tag
        elif tag == "table":
            self.tables[self.heading] = []
        elif tag == "tr":
            self.tables[self.heading].append([])
        elif tag in ("td", "th"):
            self.tables[self.heading][-1].append("")
            self.state = "cell"

    def handle_endtag(self, tag):
        if tag in ("h2", "thead", "table"):
            self.state = ""

    def handle_data(self, data):
        if self.state == "h2":
            self.heading += data
        elif self.state == "cell":
            self.tables[self.heading][-1][-1] += data.strip()


def table(titles, rows):
    lines = [titles, ["---"] * len(titles), *rows]
    return "\n".join(f"| {' | '.join(line)} |".replace("|  |", "| |") for line in lines)


def rows_of(folder, suite):
    return json.loads((folder / f"{suite}.json").read_text(encoding="utf-8"))["rows"]


def find(rows, **values):
    """Returns the first row with these values."""
    return next(row for row in rows if all(row[key] == value for key, value in values.items()))


def goals(rows):
    """Returns the number of rows with a goal and of those that miss it."""
    met = [row[key] for row in rows for key in ("holds", "goal_met") if row.get(key) is not None]
    return f"{len(met)}" if met else "", f"{met.count(False)}" if met else ""


def suites(folder):
    index = json.loads((folder / "index.json").read_text(encoding="utf-8"))["suites"]
    lines = []
    for one in index:
        rows = rows_of(folder, one["suite"]) if one["written"] else []
        minutes, seconds = divmod(round(one["seconds"]), 60)
        lines.append([f"`{one['suite']}`", f"{minutes}:{seconds:02d}", str(len(rows)),
                      *goals(rows)])
    return table(["suite", "min:s", "rows", "rows with a goal", "missed"], lines)


def still(folder):
    """RMSE, reads and memory of the techniques on still scenes."""
    rows = rows_of(folder, "error-time")
    scenes = {"bust close": ("bust", "close"), "bust natural": ("bust", "natural"),
              "plane, d = 4 px": ("texture_plane", "plane")}
    names = list(dict.fromkeys((row["technique"], row["setting"]) for row in rows))
    lines = []
    for technique, setting in names:
        found = [[row for row in rows if (row["technique"], row["setting"]) == (technique, setting)
                  and (row["scene"], row["framing"]) == scene
                  and (scene[0] != "texture_plane" or row["d_px"] == 4)]
                 for scene in scenes.values()]
        if all(found):
            first = found[0][0]
            lines.append([f"`{technique}` {setting}", *(f"{1e3 * one[0]['rmse']:.2f}"
                                                       for one in found),
                          f"{first['reads_per_pixel']:.0f}",
                          f"{first['transient_bytes'] / 2**20:.1f}"])
    return table(["technique", *scenes, "reads per pixel", "transient MiB"], lines)


def budget(folder):
    lines = []
    for row in rows_of(folder, "budget"):
        ratio, off = row["rmse_ratio"], row["unscattered_rmse"]
        x = f"{row['x']:g}" if row["x"] in (0.25, 0.5, 1, 2) else "half of the cheapest"
        lines.append([row["scene"], x, f"{row['budget_ms']:.1f}",
                      f"{row['over_budget_fraction']:.0%}",
                      f"{row['over_budget_fraction_calibrated']:.0%}",
                      f"{1e3 * row['mean_rmse']:.2f}", f"{ratio:.2f}" if ratio else "",
                      f"{row['mean_rmse'] / off:.2f}" if off else "", str(row["switches"])])
    return table(["scene", "x", "budget, ms", "late by timestamps", "late by calibrated times",
                  "RMSE times 1000", "over the best", "over unscattered", "switches"], lines)


def paper(folder):
    """Table 3 of the paper on control variates, theirs next to ours."""
    page = Tables((folder / "dynamic.html").read_text(encoding="utf-8"))
    titles, *theirs = page.tables[PAPER_TITLE]
    document = json.loads((folder / "dynamic.json").read_text(encoding="utf-8"))
    facts = [f"- {key}: {text}." for key, text in document["facts"].items()
             if " against " in key or key.startswith("split_half")]
    rows = [row for row in document["rows"] if row["framing"] == "close"]
    lines, maxima = [], []
    for scene in SCENES:
        for cells in (dict(zip(titles, row)) for row in theirs if row[0] == scene):
            guidance = cells["guidance"]
            ours = (find(rows, scene=scene, technique="afis", guidance=GUIDANCES[guidance])
                    if guidance in GUIDANCES else find(rows, scene=scene, technique="fixed"))
            name = guidance.removeprefix("AS+") if ours["technique"] == "afis" else "`fixed` 16"
            columns = ("their samples", "our samples", "theirs / AS", "ours / AS",
                       "their 8-bit dB", "our 8-bit dB")
            lines.append([scene, name, *(cells[column].replace("–", "") for column in columns),
                          f"{ours['psnr_db_frame']:.2f}"])
            if guidance == "AS+CCV":
                maxima.append([scene, *(cells[column] for column in (
                    "AS / theirs, maximum", "AS / ours, maximum", "their dB / AS, extreme",
                    "our linear dB / AS, extreme"))])
        base = find(rows, scene=scene, technique="afis", guidance="spvg")["mean_spp"]
        for name, key in OTHERS.items():
            ours = find(rows, scene=scene, **key)
            lines.append([scene, name, "", f"{ours['mean_spp']:.4g}", "",
                          f"{ours['mean_spp'] / base:.3g}", "", f"{ours['psnr_db_sdr8']:.2f}",
                          f"{ours['psnr_db_frame']:.2f}"])
    return (table(["light", "guidance", "samples, theirs", "ours", "over AS, theirs", "ours",
                   "8-bit dB, theirs", "ours", "linear dB, ours"], lines)
            + "\n\nMaxima over frames, AS over CCV:\n\n"
            + table(["light", "samples, theirs", "ours", "dB of CCV / AS, theirs",
                     "ours, linear"], maxima)
            + "\n\n" + "\n".join(facts))


def readme(folder):
    rows = rows_of(folder, "error-time")
    chosen = {"`sap`": ("sap", "smooth"), "`burley`, 32 samples": ("burley", "n=32"),
              "`separable`, 25 taps": ("separable", "taps=25")}
    lines = []
    for name, (technique, setting) in chosen.items():
        found = [find(rows, scene="bust", framing=framing, technique=technique, setting=setting)
                 for framing in ("natural", "close")]
        lines.append([name, *(f"{row['psnr_db']:.1f} dB" for row in found)])
    return table(["PSNR on the bust", "whole (d = 1.4 px)", "close (d = 4 px)"], lines)


SECTIONS = {"README.md": {"bust": (readme, "error-time")},
            "docs/performance.md": {"suites": (suites, "index"), "still": (still, "error-time"),
                                    "budget": (budget, "budget")},
            "docs/papers.md": {"table 3": (paper, "dynamic")}}


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--commit")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    for name, sections in SECTIONS.items():
        page = (ROOT / name).read_text(encoding="utf-8")
        for section, (make, suite) in sections.items():
            if not (options.folder / f"{suite}.json").exists():
                continue
            text = make(options.folder)
            if options.commit:
                text = f"Measured on commit {options.commit}:\n\n" + text
            if not options.write:
                print(text, end="\n\n")
                continue
            begin, end = f"<!-- begin {section} -->\n", f"\n<!-- end {section} -->"
            first, last = page.index(begin) + len(begin), page.index(end)
            page = page[:first] + text + page[last:]
        if options.write:
            (ROOT / name).write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
