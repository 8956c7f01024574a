"""Tests of the Python module: LUXEL=build/release/bin/luxel PYTHONPATH=build/release/python python3 test_luxel.py"""
import ast
import doctest
import gc
import os
import pathlib
import signal
import subprocess
import tempfile
import threading
import time
import unittest
import warnings

import numpy as np

import luxel

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
CORNELL_BOX = ROOT / "scenes" / "cornell-box.glb"
CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
FACES = {"floor": (0, 1, 5, 4), "ceiling": (2, 6, 7, 3), "left": (0, 2, 3, 1), "right": (4, 5, 7, 6),
         "back": (0, 4, 6, 2), "front": (1, 3, 7, 5)}  # counter-clockwise from inside
LUMINANCE = (0.2126, 0.7152, 0.0722)


def cube(color=0.5, emission=0.0):
    """A room of 1 m, each wall a mesh of its own."""
    scene = luxel.Scene()
    grey = scene.add_material("grey", color, emission=emission)
    for name, quad in FACES.items():
        scene.add_mesh(CORNERS[list(quad)], [(0, 1, 2), (0, 2, 3)], grey, name=name)
    return scene


def square():
    """A square metre at y = 0 that faces up."""
    scene = luxel.Scene()
    grey = scene.add_material("grey", 0.5)
    scene.add_mesh([(0, 0, 0), (1, 0, 0), (1, 0, -1), (0, 0, -1)], [(0, 1, 2), (0, 2, 3)], grey)
    return scene


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
        self.assertEqual(luxel.bake(square(), resolution=16, samples=4, background=(1, 1, 1)).lightmap.shape, (16, 16, 4))

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


class Rays(unittest.TestCase):
    def test_meet_a_square_where_geometry_says(self):
        scene = square()
        origins = np.array([[0.25, 2, -0.5], [0.25, -3, -0.5], [2, 2, 2]])
        directions = np.array([[0, -2, 0], [0, 1, 0], [0, -1, 0]])
        hits = luxel.trace(scene, origins, directions)
        self.assertTrue(np.allclose(hits.t, [1, 3, np.inf]))
        self.assertEqual(hits.instance.tolist(), [0, 0, -1])
        self.assertEqual(hits.triangle[2], -1)
        self.assertEqual(hits.back_face.tolist(), [False, True, False])
        u, v = hits.barycentric[:2].T[..., None]
        c = scene.triangles[hits.triangle[:2]]
        self.assertTrue(np.allclose((1 - u - v) * c[:, 0] + u * c[:, 1] + v * c[:, 2], [0.25, 0, -0.5], atol=1e-6))
        self.assertEqual(luxel.occluded(scene, origins, directions).tolist(), [True, True, False])
        self.assertEqual(luxel.occluded(scene, origins, directions, t_max=0.9).tolist(), [False, False, False])

    def test_tell_how_much_of_a_hemisphere_a_square_fills(self):
        # The form factor of a square of side 1 from a point 1 above its middle, [Hottel67]:
        # 4 * 1/(2 pi) * 2 x/sqrt(1 + x^2) atan(x/sqrt(1 + x^2)), x = 1/2, for its four quarters.
        x = 0.5
        r = np.sqrt(1 + x * x)
        expected = 4 / np.pi * x / r * np.arctan(x / r)
        random = np.random.default_rng(5)
        n = 200000
        angle, radius = 2 * np.pi * random.random(n), np.sqrt(random.random(n))
        down = -np.sqrt(1 - radius**2)
        directions = np.stack([radius * np.cos(angle), down, radius * np.sin(angle)], axis=1)
        tracer = luxel.Tracer(square())
        share = luxel.occluded(tracer, np.tile([0.5, 1, -0.5], (n, 1)), directions).mean()
        self.assertLess(abs(share - expected), 4 * np.sqrt(expected * (1 - expected) / n))  # 4 standard errors

    def test_faults_are_said(self):
        for words, rays in {
            "same number": ([(0, 0, 0)], [(0, 1, 0), (0, 1, 0)]),
            r"origins\[0\] is not finite": ([(0, np.nan, 0)], [(0, 1, 0)]),
            r"directions must have the shape": ([(0, 0, 0)], [(0, 1)]),
        }.items():
            with self.subTest(words), self.assertRaisesRegex(ValueError, words):
                luxel.trace(square(), *rays)
        with self.assertRaisesRegex(ValueError, "too large"):
            luxel.trace(square(), [(0, 1, 0)], [(0, -1e19, 0)])
        with self.assertRaisesRegex(TypeError, "Scene or a path"):
            luxel.bake(5)
        with self.assertRaisesRegex(ValueError, "t_min"):
            luxel.trace(square(), [(0, 0, 0)], [(0, 1, 0)], t_min=2, t_max=1)
        self.assertEqual(len(luxel.trace(square(), np.zeros((0, 3)), np.zeros((0, 3))).t), 0)


class ViewFactors(unittest.TestCase):
    def test_of_a_cube_are_the_closed_form(self):
        opposite = 2 / np.pi * (np.log(2 / np.sqrt(3)) + 2 * np.sqrt(2) * np.arctan(1 / np.sqrt(2)) - np.pi / 2)
        F = luxel.view_factors(cube())
        self.assertIsInstance(F, luxel.ViewFactors)
        self.assertEqual(F.names, list(FACES))
        self.assertTrue(F.closed)
        self.assertTrue(np.allclose(F.areas, 1))
        self.assertTrue(np.allclose([F[0, 1], F[2, 3], F[4, 5]], opposite, atol=1e-9))
        self.assertTrue(np.allclose(F.sum(axis=1), 1, atol=1e-9))
        self.assertTrue(np.allclose((F @ np.ones(6)), 1))
        self.assertEqual((2 * F).shape, (6, 6))
        for method, options in {"rays": dict(samples=100000), "hemicube": dict(samples=64, hemicube=32)}.items():
            sampled = luxel.view_factors(cube(), method=method, **options)
            # Five standard errors of 36 factors.
            self.assertTrue((np.abs(sampled - F).A <= 5 * sampled.error + 1e-9).all(), method)

    def test_of_a_file_are_those_of_its_scene(self):
        a = luxel.view_factors(CORNELL_BOX, method="rays", samples=1000)
        b = luxel.view_factors(luxel.load(CORNELL_BOX), method="rays", samples=1000, threads=1)
        self.assertEqual(a.names, b.names)
        self.assertEqual((a != b).nnz, 0)
        with self.assertRaisesRegex(ValueError, "--hemicube"):
            luxel.view_factors(cube(), hemicube=64)


class Relighting(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.box = luxel.Relighter(CORNELL_BOX, patches=300, rays=512, resolution=32)
        cls.dark = np.zeros((len(cls.box.materials), 3))
        low, high = cls.box.positions.min(axis=0), cls.box.positions.max(axis=0)
        cls.above = low + (high - low) * (0.5, 0.85, 0.5)  # of the blocks

    def light(self, *lamps):
        scene = luxel.Scene()
        for position, intensity in lamps:
            scene.add_point_light(position, intensity)
        return self.box.update(scene, emission=self.dark)

    def test_is_linear_in_lamps(self):
        a, b = (self.above, (1, 2, 3)), (self.above + (0.05, 0.01, 0.0), (4, 0, 1))
        for of_a, of_b, of_both in zip(self.light(a), self.light(b), self.light(a, b)):
            scale = of_both.max()
            self.assertGreater(scale, 0)
            self.assertTrue(np.allclose(of_a + of_b, of_both, atol=1e-5 * scale))  # floats of many products

    def test_direct_light_of_a_point_light_is_its_inverse_square(self):
        relit = self.light((self.above, (1, 1, 1)))
        to_lamp = self.above - self.box.positions
        distance = np.linalg.norm(to_lamp, axis=1)
        cosine = (to_lamp * self.box.normals).sum(axis=1) / distance
        expected = np.maximum(cosine, 0) / distance**2
        lit = (relit.direct[:, 0] > 0.5 * expected) & (cosine > 0.3) & (distance > 0.5 * np.median(distance))
        self.assertGreater(lit.sum(), 100)
        # Patches are small beside their distance, and take light at several points.
        self.assertLess(np.median(np.abs(relit.direct[lit, 0] / expected[lit] - 1)), 0.05)

    def test_a_saved_file_relights_with_equal_bits(self):
        lamp = (self.above, (1, 1, 1))
        expected = self.light(lamp)
        with tempfile.TemporaryDirectory() as folder:
            self.box.save(folder + "/box.lxr")
            again = luxel.Relighter(folder + "/box.lxr")
            with self.assertRaisesRegex(TypeError, "options"):
                luxel.Relighter(folder + "/box.lxr", patches=100)
        scene = luxel.Scene()
        scene.add_point_light(*lamp)
        for a, b in zip(again.update(scene, emission=self.dark), expected):
            self.assertTrue(np.array_equal(a, b))
        self.assertEqual(again.places.shape, expected.indirect_at_places.shape)
        self.assertEqual(again.texels.shape, (len(again.places), 2))

    def test_faults_are_said(self):
        with self.assertRaisesRegex(ValueError, "emission must have a row for each"):
            self.box.update(luxel.Scene(), emission=[(1, 1, 1), (2, 2, 2)] * 20)
        with self.assertRaisesRegex(TypeError, "no option 'patch'; did you mean 'patches'"):
            luxel.Relighter(CORNELL_BOX, patch=1)
        for options, words in ((dict(patches=0), "--patches"), (dict(target="x"), "--target x is not known")):
            with self.assertRaisesRegex(ValueError, words):
                luxel.Relighter(CORNELL_BOX, **options)
        with self.assertRaisesRegex(ValueError, "from 0 to 1e15"):
            self.box.update(luxel.Scene(), emission=self.dark - 1)
        with self.assertRaisesRegex(ValueError, "more light than can be held"):
            self.light((self.above, 3 * [1e37]))
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "other").write_text("stays")
            for name in ("", folder + "/"):
                with self.assertRaisesRegex(ValueError, "end in .lxr"):
                    self.box.save(name)
            self.assertTrue(pathlib.Path(folder, "other").exists())

    def test_threads_take_turns(self):
        lamps = [luxel.Scene() for _ in range(2)]
        for k, lamp in enumerate(lamps):
            lamp.add_point_light(self.above, 3 * [1.0 + 9 * k])
        expected = [self.box.update(lamp, emission=self.dark).direct for lamp in lamps]
        wrong = []

        def update(k):
            for _ in range(100):
                if not np.array_equal(self.box.update(lamps[k], emission=self.dark).direct, expected[k]):
                    wrong.append(k)

        threads = [threading.Thread(target=update, args=(k,)) for k in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])


class Compares(unittest.TestCase):
    def test_arrays_bakes_and_files(self):
        random = np.random.default_rng(2)
        a = random.uniform(0.5, 1, (40, 30, 3)).astype(np.float32)
        self.assertEqual(luxel.compare(a, a)["flip"], 0)
        found = luxel.compare(a * 1.1, a)
        self.assertAlmostEqual(found["relative_rmse"], 0.1, delta=0.002)  # over the light and a little more
        bake = luxel.bake(cube(emission=1), resolution=32, samples=4)
        self.assertEqual(luxel.compare(bake, bake.lightmap)["flip"], 0)
        with tempfile.TemporaryDirectory() as folder:
            bake.save(folder)
            luxel.compare(folder, folder, report=folder + "/report")
            self.assertTrue(os.path.exists(folder + "/report/report.html"))
        with self.assertRaisesRegex(TypeError, "both"):
            luxel.compare(bake, "file.exr")
        with self.assertRaisesRegex(luxel.Error, "30 x 40"):
            luxel.compare(a, a[:20])
        with self.assertRaisesRegex(ValueError, "shape"):
            luxel.compare(a[0], a[0])
        with self.assertRaisesRegex(OSError, "nowhere.exr"):
            luxel.compare("nowhere.exr", "nowhere.exr")


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
