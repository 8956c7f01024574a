"""Bakes, options and long work of the Python module: tests/python/run.sh runs it."""
import ast
import doctest
import gc
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings

import numpy as np

import luxel
from known_scenes import CORNELL_BOX, ROOT, cube, square


class Bakes(unittest.TestCase):
    def test_a_furnace_has_the_light_of_its_series(self):
        # E = pi L (1 + rho + rho^2 + ...) everywhere in a room whose walls all emit L and reflect rho.
        bake = luxel.bake(cube(color=0.5, emission=0.25), resolution=32, samples=64)
        self.assertTrue(np.allclose(bake.irradiance, np.pi * 0.25 / 0.5, rtol=0.01))

    def test_have_the_bits_of_the_command(self):
        bake = luxel.bake(CORNELL_BOX, resolution=48, samples=8, denoise=False, seed=3, bounces=2)
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([os.environ["LUXEL"], "bake", CORNELL_BOX, "-o", folder + "/command", "--resolution", "48",
                            "--samples", "8", "--no-denoise", "--seed", "3", "--bounces", "2", "--quiet"], check=True)
            report = bake.save(folder + "/module")
            files = [pathlib.Path(folder, of, "lightmap.exr").read_bytes() for of in ("command", "module")]
            self.assertEqual(files[0], files[1])
            self.assertEqual(report["settings"]["samples"], 8)
            self.assertEqual(luxel.compare(folder + "/command", folder + "/module")["flip"], 0)

    def test_of_a_loaded_scene_are_those_of_its_file(self):
        options = dict(resolution=32, samples=4, denoise=False)
        of_file = luxel.bake(CORNELL_BOX, **options)
        of_scene = luxel.bake(luxel.load(CORNELL_BOX), **options)
        self.assertTrue(np.array_equal(of_file.lightmap, of_scene.lightmap))

    def test_a_file_that_only_assimp_reads_needs_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "a.off")
            file.write_text("OFF\n4 2 0\n0 0 0\n2 0 0\n2 0 1\n0 0 1\n3 0 1 2\n3 0 2 3\n")
            with self.assertRaisesRegex(luxel.Error, "--any-format"):
                luxel.load(file)
            path = os.environ["PATH"]
            try:
                os.environ["PATH"] = str(pathlib.Path(os.environ["LUXEL"]).resolve().parent) + ":" + path
                self.assertEqual(len(luxel.load(file, any_format=True).triangles), 2)
                os.environ["PATH"] = folder + ":."
                with self.assertRaisesRegex(luxel.Error, "needs the program luxel"):
                    luxel.load(file, any_format=True)
            finally:
                os.environ["PATH"] = path

    def test_arrays_are_views_that_outlive_the_bake_and_cannot_be_written(self):
        bake = luxel.bake(cube(emission=1), resolution=32, samples=4)
        for name in ("lightmap", "texel_map", "texels", "irradiance", "error", "texel_corners", "preview"):
            with self.subTest(name):
                array = getattr(bake, name)
                self.assertTrue(np.shares_memory(array, getattr(bake, name)))
                with self.assertRaises(ValueError):
                    array.flat[0] = array.flat[0]
        light, texels = bake.lightmap, bake.texels
        copies = light.copy(), texels.copy()
        del bake
        gc.collect()
        self.assertTrue(np.array_equal(light, copies[0]))
        self.assertTrue(np.array_equal(texels["triangle"], copies[1]["triangle"]))

    def test_texels_say_where_they_lie(self):
        bake = luxel.bake(cube(emission=1), resolution=64, samples=4)
        texels, map_ = bake.texels, bake.texel_map
        self.assertTrue(np.array_equal(map_[texels["y"], texels["x"]], np.arange(len(texels))))
        self.assertEqual((map_ >= 0).sum(), len(texels))
        u, v = texels["barycentric"].T[..., None]
        c = bake.scene.triangles[bake.scene.first_triangle[texels["instance"]] + texels["triangle"]]
        by_corners = (1 - u - v) * c[:, 0] + u * c[:, 1] + v * c[:, 2]
        self.assertTrue(np.allclose(bake.positions, by_corners, atol=1e-6))
        # A texel's sample lies in the texel, and in its triangle there.
        t = bake.texel_corners[bake.scene.first_triangle[texels["instance"]] + texels["triangle"]]
        at = (1 - u - v) * t[:, 0] + u * t[:, 1] + v * t[:, 2]
        away = np.abs(at - np.stack([texels["x"], texels["y"]], axis=1) - 0.5)
        self.assertLess(away.max(), 0.5 + 1e-3)  # coordinates of some 64 in floats
        heights = bake.on_map(bake.positions[:, 1])
        self.assertEqual(heights.shape, (64, 64))
        self.assertTrue(np.array_equal(np.isnan(heights), map_ < 0))
        y, x = np.argwhere(map_ >= 0)[7]
        self.assertEqual(heights[y, x], bake.positions[map_[y, x], 1])

    def test_pages_and_layers_come_as_asked(self):
        bake = luxel.bake(cube(emission=1), resolution=32, pages=2, samples=4)
        self.assertEqual([p[2] for p in bake.pages], [32, 32])
        self.assertEqual(bake.page(1).shape, (32, 32, 4))
        with self.assertRaises(IndexError):
            bake.page(2)

    def test_of_solvers_without_errors_have_none(self):
        bake = luxel.bake(cube(emission=1), solver="hemicube", resolution=16, max_elements=200)
        self.assertIsNone(bake.error)

    def test_nan_never_comes_in(self):
        scene = luxel.Scene()
        grey = scene.add_material("grey", 0.5)
        for bad in (np.nan, np.inf):
            with self.assertRaisesRegex(ValueError, r"positions\[2\] is not finite"):
                scene.add_mesh([(0, 0, 0), (1, 0, 0), (0, 0, bad)], [(0, 1, 2)], grey)
            with self.assertRaisesRegex(ValueError, "color"):
                scene.add_material("bad", (0, 0, bad))
            with self.assertRaisesRegex(ValueError, "background"):
                scene.background = (0, 0, bad)
            with self.assertRaisesRegex(ValueError, "transform"):
                scene.add_mesh([(0, 0, 0), (1, 0, 0), (0, 0, 1)], [(0, 1, 2)], grey, transform=np.diag([1, 1, bad, 1]))

    def test_faults_of_meshes_are_said(self):
        scene = luxel.Scene()
        grey = scene.add_material("grey", 0.5)
        corners = [(0, 0, 0), (1, 0, 0), (0, 0, 1)]
        for fault, arguments in {
            r"row 3 of 3 positions": (corners, [(0, 1, 3)], grey),
            r"row -1 of 3 positions": (corners, [(0, 1, -1)], grey),
            r"no material 7": (corners, [(0, 1, 2)], 7),
            r"no material -1": (corners, [(0, 1, 2)], np.int64(-1)),
            r"no material 4294967296": (corners, [(0, 1, 2)], [2**32]),
            r"one for each triangle": (corners, [(0, 1, 2)], [0, 0]),
            r"shape \(n, 3\)": ([(0, 0)], [(0, 1, 2)], grey),
        }.items():
            with self.subTest(fault), self.assertRaisesRegex(ValueError, fault):
                scene.add_mesh(*arguments)
        with self.assertRaisesRegex(TypeError, "triangles must be whole numbers"):
            scene.add_mesh(corners, [(0.5, 1, 2)], grey)
        self.assertEqual(scene.instances, [])
        with self.assertRaisesRegex(luxel.Error, "triangle"):
            luxel.bake(scene)


class Options(unittest.TestCase):
    def refused(self, kind, words, **options):
        with self.subTest(options), self.assertRaisesRegex(kind, words):
            luxel.bake(square(), **options)

    def test_that_cannot_work_are_refused_with_a_sentence(self):
        self.refused(TypeError, "no option 'sampels'; did you mean 'samples'", sampels=3)
        self.refused(TypeError, "samples needs a value", samples=True)
        self.refused(TypeError, "stitch must be True or False", stitch=1)
        self.refused(ValueError, "many is not a number", samples="many")
        self.refused(ValueError, "view needs a value", view="", stitch=False)
        self.refused(TypeError, "lists within lists", background=[[1], 2, 3])
        self.refused(ValueError, "--samples 0 ", samples=0)
        self.refused(ValueError, "--rays", rays=64)  # the matrix solver's
        self.refused(ValueError, "resume is for the command", resume=True)
        self.refused(ValueError, "--resolution 64 and --texels-per-metre", resolution=64, texels_per_metre=9)
        self.refused(ValueError, "(?i)exclude", denoise=True, no_denoise=True)
        self.refused(ValueError, "none of|no solver|gather, hemicube", solver="magic")
        self.refused(ValueError, "bake.json", settings="options.toml")
        self.refused(OSError, "nowhere", settings="nowhere/bake.json")

    def test_files_that_are_not_there_are_said(self):
        for call in (luxel.bake, luxel.load, luxel.view_factors, luxel.Relighter):
            with self.subTest(call), self.assertRaisesRegex(OSError, "nowhere.glb"):
                call("nowhere.glb")

    def test_names_that_are_no_utf8_are_said(self):
        with self.assertRaisesRegex(OSError, r"nowhere\\xff.glb"):
            luxel.load(b"nowhere\xff.glb")

    def test_a_file_far_from_its_origin_says_so(self):
        corners = np.array([(512345.678, 87.5, -5403210.123)]) + [(0, 0, 0), (1, 0, 0), (0, 0, -1)]
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "far.obj")
            file.write_text("".join(f"v {x:.3f} {y:.3f} {z:.3f}\n" for x, y, z in corners) + "f 1 2 3\n")
            scene = luxel.load(file)
        self.assertEqual((scene.origin.dtype, scene.origin.shape), (np.float64, (3,)))
        self.assertTrue(np.allclose(scene.triangles[0] + scene.origin, corners, rtol=0, atol=1e-6))
        self.assertEqual(list(luxel.Scene().origin), [0, 0, 0])

    def test_lists_and_switches_are_those_of_the_command(self):
        a = luxel.bake(square(), resolution=16, samples=4, background=(1, 2, 3), denoise=False, stitch=False)
        b = luxel.bake(square(), resolution=16, samples=4, background="1,2,3", no_denoise=True, no_stitch=True)
        self.assertTrue(np.array_equal(a.lightmap, b.lightmap))
        share = a.irradiance[:, 2] / a.irradiance[:, 0]
        self.assertTrue(np.allclose(share, 3, rtol=1e-4))

    def test_warnings_are_pythons(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            luxel.bake(square(), resolution=16, samples=4)  # no light: a clear day is added
        self.assertTrue(any("clear" in str(w.message) for w in caught), [str(w.message) for w in caught])


class LongWork(unittest.TestCase):
    LONG = dict(resolution=1024, samples=20000, denoise=False)  # minutes

    def test_progress_is_called_and_what_it_raises_stops_the_work(self):
        calls = []

        def watch(stage, share, seconds_left):
            calls.append((stage, share, seconds_left))
            if len(calls) == 5:
                raise LookupError("enough")

        start = time.monotonic()
        with self.assertRaisesRegex(LookupError, "enough"):
            luxel.bake(CORNELL_BOX, progress=watch, **self.LONG)
        self.assertEqual(len(calls), 5)
        for stage, share, left in calls:
            self.assertTrue(stage)
            self.assertTrue(share is None or 0 <= share <= 1)
            self.assertTrue(left is None or left >= 0)
        self.assertLess(time.monotonic() - start, 20)  # far from minutes, also under load

    def test_ctrl_c_stops_it(self):
        threading.Timer(0.7, os.kill, (os.getpid(), signal.SIGINT)).start()
        start = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            luxel.bake(CORNELL_BOX, **self.LONG)
        self.assertLess(time.monotonic() - start, 20)
        again = luxel.bake(square(), resolution=16, samples=4, background=(1, 1, 1))
        self.assertEqual(again.lightmap.shape, (16, 16, 4))

    def test_python_ends_while_a_thread_bakes(self):
        script = ("import threading, time, luxel\n"
                  f"bake = lambda: luxel.bake({str(CORNELL_BOX)!r}, resolution=512, samples=20000)\n"
                  "threading.Thread(target=bake, daemon=True).start()\n"
                  "time.sleep(0.7)\n")
        ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
        self.assertEqual(ended.returncode, 0, ended.stderr)

    def test_other_threads_run_meanwhile(self):
        is_over, turns = False, 0

        def count():
            nonlocal turns
            while not is_over:
                turns += 1
                time.sleep(0.001)

        other = threading.Thread(target=count)
        other.start()
        luxel.bake(CORNELL_BOX, resolution=128, samples=64)  # about a second
        is_over = True
        other.join()
        self.assertGreater(turns, 20)


class Package(unittest.TestCase):
    def test_types_name_all_that_is_public(self):
        tree = ast.parse(pathlib.Path(luxel.__file__).with_name("__init__.pyi").read_text())
        stubs = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        self.assertEqual(set(stubs), {*luxel.__all__, "ViewFactors"})  # which needs scipy
        for name in ("Bake", "Relighter", "Scene", "Tracer"):
            written = {node.name for node in stubs[name].body}
            found = {member for member in vars(getattr(luxel, name)) if not member.startswith("_")}
            self.assertEqual(written - {"__init__"}, found, name)

    def test_doctests(self):
        guide = ROOT / "docs" / "guide" / "python.md"
        here = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.symlink(ROOT / "scenes", folder + "/scenes")
            os.chdir(folder)  # the guide writes into baked/
            try:
                results = [doctest.testmod(luxel), doctest.testfile(str(guide), module_relative=False)]
            finally:
                os.chdir(here)
        for result in results:
            self.assertGreater(result.attempted, 5)
            self.assertEqual(result.failed, 0)

    def test_every_public_thing_says_what_it_is(self):
        for name in luxel.__all__:
            self.assertTrue(getattr(luxel, name).__doc__, name)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    unittest.main()
