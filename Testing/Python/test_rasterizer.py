# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tests that draw keep Mesa's software rasterizer from starting threads: Documentation/dev/memory.md says why."""
import json
import os
import pathlib
import subprocess
import unittest

from occlusion_scene import Scene, ball, cube, volume_property

SETTING = "LP_NUM_THREADS=0"


class Rasterizer(unittest.TestCase):
    def test_llvmpipe_draws_in_the_calling_thread(self):
        scene = Scene()
        scene.add_volume(cube(ball(8)), volume_property())
        scene.look()
        scene.pixels()
        if "llvmpipe" not in scene.window.ReportCapabilities():
            self.skipTest("OpenGL is not drawn by llvmpipe")
        names = [task.read_text().strip() for task in pathlib.Path("/proc/self/task").glob("*/comm")]
        self.assertEqual([name for name in names if name.startswith("llvmpipe")], [], f"set {SETTING}")

    @unittest.skipUnless("CHI_CTEST" in os.environ, "run by ctest, which knows the tests")
    def test_every_test_that_draws_is_told(self):
        command = (os.environ["CHI_CTEST"], "--test-dir", os.environ["CHI_BUILD"], "--show-only=json-v1")
        tests = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["tests"]
        draws, told = set(), set()
        for test in tests:
            properties = {item["name"]: item["value"] for item in test["properties"]}
            if "render" in properties.get("LABELS", ()):
                draws.add(test["name"])
            if SETTING in properties.get("ENVIRONMENT", ()):
                told.add(test["name"])
        self.assertIn("chi.Python.rasterizer", draws)
        self.assertEqual(draws - told, set())


if __name__ == "__main__":
    unittest.main()
