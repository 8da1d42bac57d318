"""The window survives other sizes, every way of showing splats, and the loss of its device; the validation
layers stay silent."""
import pathlib
import time
import unittest

from window import WindowTest


MODES = ["Beauty", "Centres", "Rings", "Ellipsoids", "Depth", "Opacity", "Labels", "Label weight",
         "Attention", "Changed"]


class Device(WindowTest):
    def survives(self, preview):
        window = self.open("--sample", "--validate", "--preview", preview, width=1000, height=640)
        window.wait(lambda s: s["splats"] > 0 and not s["busy"], "the sample did not open", 90)
        for width, height in [(700, 500), (1000, 640), (401, 333), (960, 600)]:
            window.xdotool("search", "--name", "GSEditPro", "windowsize", "--sync", width, height)
            window.wait(lambda s: s["framebuffer"] == [width, height], "the window did not take its size", 20)
            window.wait(lambda s: not s["busy"], "no picture at the new size", 60)
        pathlib.Path(str(window.map) + ".lose_device").touch()
        window.xdotool("mousemove", 300, 200)
        window.wait(lambda s: s["devices_lost"] == 1, "the device was not lost", 30)
        frames = window.state()["frames"]
        window.drag("viewport", [(0.4, 0.5), (0.5, 0.55)])
        window.wait(lambda s: s["frames"] > frames and not s["busy"], "no picture after the loss", 60)
        window.picture(f"15_device_{preview}")
        self.assertEqual(window.state()["splats"], 4914)
        self.assertEqual(window.state()["validation_messages"], 0)
        self.assertEqual(window.close(), 0)

    def test_native(self):
        self.survives("native")

    def test_vulkan(self):
        self.survives("vulkan")

    def test_every_mode(self):
        window = self.open("--sample", "--validate", width=1000, height=640)
        window.wait(lambda s: s["splats"] > 0 and not s["busy"], "the sample did not open", 90)
        for mode, name in enumerate(MODES[1:], 1):
            window.click("viewport.mode")
            window.click(f"viewport.mode.{name}")
            window.wait(lambda s: s["mode"] == mode and not s["busy"], f"{name} did not come to rest", 90)
            window.picture(f"16_mode_{mode}_{name.lower().replace(' ', '_')}")
        self.assertEqual(window.state()["validation_messages"], 0)
        self.assertEqual(window.close(), 0)


if __name__ == "__main__":
    unittest.main()
