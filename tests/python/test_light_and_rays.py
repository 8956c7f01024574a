"""Rays, view factors, relighting and comparison by the Python module: tests/python/run.sh runs it."""
import os
import pathlib
import tempfile
import threading
import unittest
import warnings

import numpy as np

import luxel
from known_scenes import CORNELL_BOX, FACES, cube, square


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
        with self.assertRaisesRegex(ValueError, "the light is too bright to store"):
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


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    unittest.main()
