#!/usr/bin/env python3
"""Tests the model of GPU times, the count of instructions, and the scripts for limits."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import device_limits
import gpu_model
import instruction_mix
import summarise_kernels
import write_calibrations

HERE = pathlib.Path(__file__).resolve().parent

# Milliseconds at 2560x1440 and 1920x1080. Formulas and hardware rows must not change, so these
# techniques, whose counts are fixed, keep their times.
FROZEN = {
    "RX_6800": {
        "separable 25": (2.70, 1.53), "burley 32": (1.59, 0.90), "fixed 16": (0.99, 0.57),
        "afis 16": (2.44, 1.40), "SAP shipped": (3.48, 2.54), "SAP prototype": (0.87, 0.61),
        "SAP target": (0.60, 0.41)},
    "NVIDIA_LIKE": {
        "separable 25": (3.19, 1.80), "burley 32": (2.52, 1.43), "fixed 16": (1.43, 0.81),
        "afis 16": (3.06, 1.74), "SAP shipped": (4.06, 3.06), "SAP prototype": (1.13, 0.78),
        "SAP target": (0.74, 0.51)},
    "SMALL_RDNA2": {
        "separable 25": (5.27, 2.98), "burley 32": (3.13, 1.77), "fixed 16": (1.95, 1.11),
        "afis 16": (4.86, 2.76), "SAP shipped": (4.80, 3.20), "SAP prototype": (1.63, 1.02),
        "SAP target": (1.09, 0.68)},
}

# Two blocks before a loop of two, and one behind it; a branch skips the second block.
ASSEMBLY = """
BB0:
\tv_add_f32_e32 v0, v1, v2                ; 06000501
\ts_cbranch_execz BB2                     ; bf880001
BB1:
\tv_exp_f32_e32 v0, v0                    ; 7e004b00
BB2:
\tv_mul_lo_u32 v1, v0, v2                 ; d5690001
\timage_load v[0:3], v[0:1], s[0:7]       ; f0000f08
\ts_waitcnt vmcnt(0)                      ; bf8c3f70
BB3:
\tbuffer_load_dword v1, off, s[8:11], 0   ; e0300000
\ts_cbranch_scc1 BB2                      ; bf850001
BB4:
\tds_read_b32 v1, v0                      ; d8d80000
\ts_endpgm                                ; bf810000
"""


class Summary(unittest.TestCase):
    report = {"ok": False, "driver": "radv", "skipped": [{"graph": "restir", "why": "no rays"}],
              "limits": {"checked": 2, "open": [], "exceeded": [
                  {"subject": "sap/down", "value": "vgprs", "found": 97, "limit": 96,
                   "minimum": False, "place": "limits.json:9"}]}}

    def test_names_what_is_exceeded_or_skipped(self):
        lines = list(summarise_kernels.lines_of("navi21", self.report))
        self.assertEqual(lines, [
            "kernels on navi21 (radv): 2 limits checked: 1 exceeded, 0 not yet at their goal",
            "restir: skipped, no rays",
            "  sap/down: vgprs is 97, at most 96 is allowed  (limits.json:9)"])

    def test_says_why_nothing_was_compiled(self):
        report = {"ok": False, "error": "no device", "diagnostics": [{"text": "no driver"}]}
        self.assertEqual(list(summarise_kernels.lines_of("navi21", report)),
                         ["kernels on navi21: no device", "no driver"])

    def test_exit_code_is_that_of_the_limits(self):
        for ok in (True, False):
            with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
                json.dump(self.report | {"ok": ok}, file)
                file.flush()
                done = subprocess.run(
                    [sys.executable, "-B", HERE / "summarise_kernels.py", "navi21", file.name],
                    check=False, capture_output=True)
                self.assertEqual(done.returncode, 0 if ok else 1)


class Model(unittest.TestCase):
    def test_times_of_fixed_counts_stay(self):
        for hardware, techniques in FROZEN.items():
            for i, (width, height) in enumerate(((2560, 1440), (1920, 1080))):
                model = gpu_model.run(getattr(gpu_model, hardware), width=width, height=height)
                for technique, milliseconds in techniques.items():
                    self.assertAlmostEqual(
                        model.total(technique) * 1e3, milliseconds[i], delta=0.005,
                        msg=f"{technique} on {hardware}, {width}x{height}")

    def test_counts_of_built_kernels_are_used(self):
        def built(instructions, occupancy=16):
            kernel = "sap/subsurface_sap_gather"
            text = "BB0:\n" + "\tv_add_f32_e32 v0, v1, v2 ; 06000501\n" * instructions
            with tempfile.TemporaryDirectory() as folder:
                file = kernel.replace("/", "_") + ".txt"
                (pathlib.Path(folder) / file).write_text(text, encoding="utf-8")
                passes = [{"pass": "gather", "kernel": kernel, "constants": "storage=half",
                           "read": 1, "written": 2}]
                row = {"kernel": kernel, "constants": "storage=half", "assembly": file,
                       "values": {"occupancy": occupancy, "code_bytes": 100}}
                other = dict(row, constants="storage=full", assembly="none")  # of no pass
                report = {"kernels": [row, other],
                          "graphs": [{"graph": "sap", "passes": passes}]}
                model = gpu_model.run(gpu_model.RX_6800, built=gpu_model.Built(report, folder))
                return model.techniques["sap as built"][0], model

        few, model = built(10)
        many, _ = built(4000)
        self.assertAlmostEqual(few.bytes, 3 * model.covered)
        self.assertEqual((few.limit, many.limit), ("mem", "alu/lat"))
        self.assertGreater(many.seconds, 2 * few.seconds)


class WriteCalibrations(unittest.TestCase):
    WORKS = [{"work": "subsurface.sap_gather variant=smooth", "kernel": "a/gather",
              "per": "listed_tiles", "level": 0, "read": 32, "written": 8},
             {"work": "subsurface.sap_gather variant=large", "kernel": "a/gather",
              "per": "listed_tiles", "level": 0, "read": 320, "written": 80},
             {"work": "subsurface.list", "kernel": "a/gather",
              "per": "fixed", "groups": 1, "read": 0, "written": 0}]
    ROW = {"kernel": "a/gather", "values": {"occupancy": 16, "code_bytes": 5000}}

    def costs(self, hardware):
        return [write_calibrations.cost_of(gpu_model.Model(hardware), work, self.ROW, ASSEMBLY)
                for work in self.WORKS]

    def test_costs_follow_work_and_hardware(self):
        large, small = self.costs(gpu_model.RX_6800), self.costs(gpu_model.SMALL_RDNA2)
        self.assertGreater(large[1][1], 5 * large[0][1])  # bound by memory
        self.assertGreater(small[1][1], large[1][1])
        self.assertGreaterEqual(large[0][0], gpu_model.RX_6800.fixed * 1e6)
        self.assertEqual(large[2][1], 0)

    def test_loops_run_as_often_as_stated(self):
        others = write_calibrations.executed("subsurface.other", ASSEMBLY)
        stated = write_calibrations.executed("subsurface.tile_refine", ASSEMBLY)
        self.assertAlmostEqual(stated["quarter_rate"] / others["quarter_rate"], 8 / 4)

    def test_outer_loops_over_levels_have_their_own_counts(self):
        usual = write_calibrations.executed("subsurface.list", ASSEMBLY)
        outer = write_calibrations.executed("subsurface.sap_coarse_down level=5", ASSEMBLY)
        self.assertAlmostEqual(usual["quarter_rate"] / outer["quarter_rate"],
                               write_calibrations.LOOP)

    def test_sampling_kernels_loop_over_their_samples(self):
        usual = write_calibrations.executed("subsurface.other samples=32", ASSEMBLY)
        sampling = write_calibrations.executed("subsurface.afis samples=32", ASSEMBLY)
        self.assertAlmostEqual(sampling["quarter_rate"] / usual["quarter_rate"],
                               32 / write_calibrations.LOOP)

    def test_samples_between_limits_are_their_geometric_mean(self):
        work = "subsurface.guided guidance=spvg min_samples=4 max_samples=64"
        self.assertEqual(write_calibrations.samples_of(work), 16)
        self.assertEqual(write_calibrations.nested_trips(work), (16,))
        halves = work.replace("spvg", "split_half")
        self.assertEqual(write_calibrations.nested_trips(halves), (2, 8))

    def test_reads_of_samples_are_scattered(self):
        reads = """
BB0:
\timage_load v0, v[1:2], s[0:7]          ; f0000000
BB1:
\timage_load v0, v[1:2], s[0:7]          ; f0000000
\ts_cbranch_scc1 BB1                     ; bf850001
BB2:
\ts_endpgm                               ; bf810000
"""
        part = write_calibrations.EXECUTED
        mix = write_calibrations.executed("subsurface.burley samples=8", reads)
        self.assertEqual((mix["image_load"], mix["scattered"]), (part, 8 * part))
        other = write_calibrations.executed("subsurface.other", reads)
        self.assertEqual((other["image_load"], other["scattered"]),
                         ((1 + write_calibrations.LOOP) * part, 0))

    def test_each_work_has_the_kernel_of_its_settings(self):
        rows = [{"kernel": "k", "constants": f"axis=vertical taps={taps} albedo=bound"}
                for taps in (11, 25)] + [{"kernel": "other", "constants": "taps=25"}]
        work = {"kernel": "k", "work": "subsurface.k axis=vertical taps=25"}
        self.assertEqual(write_calibrations.rows_of(work, rows), [rows[1]])

    def test_files_say_that_they_are_modelled(self):
        report = {"device": "d", "driver": "r"}
        text = write_calibrations.text_of(gpu_model.RX_6800, report, [("w", 1.0, 0.5)])
        self.assertTrue(text.startswith("// Modelled, not measured"))
        self.assertIn(', modelled"', text)


class InstructionMix(unittest.TestCase):
    def setUp(self):
        self.blocks = instruction_mix.read_blocks(ASSEMBLY.splitlines())

    def test_each_instruction_has_a_class(self):
        total = instruction_mix.count(self.blocks)
        self.assertEqual(total, {
            "valu": 1, "branch": 2, "transcendental": 1, "quarter_rate": 1, "image_load": 1,
            "wait": 1, "memory_wait": 1, "scratch_load": 1, "shared": 1, "scalar": 1, "vector": 3})

    def test_loops_and_skipped_blocks(self):
        self.assertEqual(instruction_mix.find_loops(self.blocks), [(2, 3)])
        skipped = instruction_mix.parse_ranges("BB1")
        total = instruction_mix.count(self.blocks, [4], skipped, texels=2)
        self.assertEqual(total["vector"], (1 + 4) / 2)
        self.assertEqual(total["transcendental"], 0)

    def test_longest_path_takes_one_side_of_a_uniform_branch(self):
        either = instruction_mix.read_blocks("""
BB0:
\ts_cbranch_scc0 BB2                      ; bf840001
BB1:
\tv_add_f32_e32 v0, v1, v2                ; 06000501
\ts_branch BB3                            ; bf820001
BB2:
\tv_add_f32_e32 v0, v1, v2                ; 06000501
\tv_exp_f32_e32 v0, v0                    ; 7e004b00
BB3:
\tv_add_f32_e32 v0, v1, v2                ; 06000501
\ts_endpgm                                ; bf810000
""".splitlines())
        self.assertEqual(instruction_mix.count(either)["vector"], 4)
        self.assertEqual(instruction_mix.count(either, longest=True)["vector"], 3)
        divergent = instruction_mix.count(self.blocks, [4], longest=True)
        self.assertEqual(divergent["vector"], 2 + 4)

    def test_longest_path_runs_through_loops(self):
        # The first block of the loop leaves it; its second block only leads back.
        blocks = instruction_mix.read_blocks("""
BB0:
\ts_mov_b32 s0, 0                         ; be800380
BB1:
\tv_add_f32_e32 v0, v1, v2                ; 06000501
\ts_cbranch_scc1 BB3                      ; bf850001
BB2:
\tv_exp_f32_e32 v0, v0                    ; 7e004b00
\ts_branch BB1                            ; bf820001
BB3:
\tv_add_f32_e32 v0, v1, v2                ; 06000501
\tv_add_f32_e32 v0, v1, v2                ; 06000501
\ts_endpgm                                ; bf810000
""".splitlines())
        total = instruction_mix.count(blocks, [4], longest=True)
        self.assertEqual((total["transcendental"], total["valu"]), (4, 4 + 2))

    def test_blocks_of_second_layers_are_found(self):
        # The branch on a sign leaves out BB1; the branch over most instructions BB3.
        blocks = instruction_mix.read_blocks("""
BB0:
\tv_cmpx_gt_i32_e32 0, v6                 ; 7d280c80
\ts_cbranch_execz BB2                     ; bf880001
BB1:
\tv_exp_f32_e32 v0, v0                    ; 7e004b00
BB2:
\tv_cmpx_gt_i32_e32 7, v6                 ; 7d280c87
\ts_cbranch_execz BB4                     ; bf880001
BB3:
\tv_add_f32_e32 v0, v1, v2                ; 06000501
\tv_add_f32_e32 v0, v1, v2                ; 06000501
BB4:
\tv_add_f32_e32 v0, v1, v2                ; 06000501
\ts_endpgm                                ; bf810000
""".splitlines())
        self.assertEqual(instruction_mix.second_layer_blocks(blocks), {1})
        self.assertEqual(instruction_mix.largest_branch_blocks(blocks), {3})


class WriteLimits(unittest.TestCase):
    def write_one_ray_query(self, *scratch):
        rows = [{"kernel": "restir/restir_initial", "values": {"scratch_bytes": one}}
                for one in scratch]
        rows.append({"kernel": "restir/restir_resolve", "values": {"scratch_bytes": 7}})
        text = json.dumps({"kernels": rows})
        (self.folder / "values.one_ray_query.json").write_text(text, encoding="utf-8")

    def rewrite(self, vgprs, *options):
        values = {"device": "Null hardware (RADV NAVI21)", "driver": "radv Mesa 22.3.6",
                  "kernels": [{"kernel": "a/k", "values": {"vgprs": one}} for one in vgprs]}
        (self.folder / "values.json").write_text(json.dumps(values), encoding="utf-8")
        return subprocess.run([sys.executable, HERE / "write_limits.py", *options,
                               self.folder / "limits.json", self.folder / "values.json"],
                              capture_output=True, text=True, check=False)

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "limits.json").write_text("""{ "dermis_kernel_limits": 1, "rules": [
    { "kernel": "a/*", "max": { "vgprs": 80 } } // a goal
    // Present values beyond their goals, written by write_limits.py.
  ]
}
""", encoding="utf-8")

    def present(self):
        return (self.folder / "limits.json").read_text(encoding="utf-8")

    def test_the_worst_pipeline_of_a_kernel_counts(self):
        self.assertEqual(self.rewrite([90, 96, 70]).returncode, 0)
        self.assertIn('"max": {"vgprs": {"goal": 80, "now": 96}}', self.present())

    def test_limits_relative_to_one_ray_query(self):
        text = '{ "max": { "scratch_bytes": "1.1 * one_ray_query" } }'
        for scratch, limit in (((19456,), 21401), ((0,), 0), ((), 0)):
            self.write_one_ray_query(*scratch)
            values = self.folder / "values.one_ray_query.json"
            self.assertEqual(device_limits.for_device(text, values),
                             '{ "max": { "scratch_bytes": %d } }' % limit)

    def test_present_values_of_relative_limits(self):
        limits = self.folder / "limits.json"
        limits.write_text(self.present().replace("80", '"1.5 * one_ray_query"'), encoding="utf-8")
        self.write_one_ray_query(60)
        self.assertEqual(self.rewrite([91]).returncode, 0)
        self.assertIn('"max": {"vgprs": {"goal": 90, "now": 91}}', self.present())
        self.assertIn('"1.5 * one_ray_query"', self.present())

    def test_reached_goals_disappear(self):
        self.rewrite([96])
        self.assertEqual(self.rewrite([80]).returncode, 0)
        self.assertNotIn("now", self.present().split("Present")[1])

    def test_worse_values_need_consent(self):
        self.rewrite([96])
        refused = self.rewrite([97])
        self.assertEqual(refused.returncode, 1)
        self.assertIn("vgprs is 97, before 96", refused.stderr)
        self.assertIn('"now": 96', self.present())
        self.assertEqual(self.rewrite([97], "--worse").returncode, 0)
        self.assertIn('"now": 97', self.present())


if __name__ == "__main__":
    unittest.main()
