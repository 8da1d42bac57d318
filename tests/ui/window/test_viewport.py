"""The picture of the scene is always there: while the artist orbits and the machine is busy, and when it is
shown in another way."""
import multiprocessing
import os
import signal
import subprocess
import time
import unittest

from window import PATIENCE, WindowTest

FRAMES = 100
GRID = 24          # places looked at along either side of the picture
LEAST_COLOURS = 12   # a viewport without the scene has one, and a few of the overlays


def spin(pause):
    while True:
        end = time.monotonic() + 0.8
        while time.monotonic() < end:
            pass
        time.sleep(pause)


class Busy:
    """Every processor has something else to do, now less and now more: the resolution follows."""

    def __enter__(self):
        self.processes = [multiprocessing.Process(target=spin, args=(0.4 * (number % 2),), daemon=True)
                          for number in range(2 * multiprocessing.cpu_count())]
        for process in self.processes:
            process.start()

    def __exit__(self, *_):
        for process in self.processes:
            process.kill()
            process.join()


class Viewport(WindowTest):
    def colours(self, window):
        """Colours at the places of a grid over the inner part of the viewport."""
        rect = window.widgets()["viewport"]
        _, _, row, pixels = window.screen()
        places = [(int(rect["x"] + rect["width"] * (0.3 + 0.4 * x / GRID)),
                   int(rect["y"] + rect["height"] * (0.3 + 0.4 * y / GRID)))
                  for y in range(GRID) for x in range(GRID)]
        return [pixels[y * row + 4 * x:y * row + 4 * x + 3] for x, y in places]

    def wait_for_scene(self, window):
        """Until the screen shows the scene: the picture that the program has finished comes there a little
        later."""
        window.wait(lambda s: s["splats"] > 0 and not s["busy"]
                    and len(set(self.colours(window))) >= LEAST_COLOURS,
                    "the sample did not open", 90)

    def circling(self, window):
        """The mouse goes round in the viewport with the left button down until the process is killed."""
        steps = [(0.5 + 0.12 * (abs((k % 80) - 40) / 20 - 1), 0.5 + 0.05 * (abs((k % 48) - 24) / 12 - 1))
                 for k in range(240)]
        script = []
        for share in steps:
            script += ["mousemove", *map(str, window.place("viewport", *share)), "sleep", "0.02"]
        window.xdotool("mousemove", *window.place("viewport", *steps[0]), "mousedown", 1)
        return subprocess.Popen(["sh", "-c", "while :; do xdotool \"$@\"; done", "sh", *script],
                                env=window.environment,
                                stdout=subprocess.DEVNULL, start_new_session=True)

    def frames_while_orbiting(self, window, wanted):
        """So many different pictures of the viewport, as the screen shows them."""
        mouse = self.circling(window)
        frames, last = [], None
        end = time.monotonic() + 120 * PATIENCE
        try:
            while len(frames) < wanted and time.monotonic() < end:
                now = self.colours(window)
                if now != last:
                    frames.append(now)
                last = now
                time.sleep(0.01)
        finally:
            os.killpg(mouse.pid, signal.SIGKILL)
            mouse.wait()
            subprocess.run(["xdotool", "mouseup", "1"], env=window.environment, check=True)
        self.assertEqual(len(frames), wanted, "the picture does not follow the mouse")
        return frames

    def assert_all_show_the_scene(self, frames):
        blank = [index for index, frame in enumerate(frames) if len(set(frame)) < LEAST_COLOURS]
        self.assertEqual(blank, [], f"{len(blank)} of {len(frames)} frames are without the scene")

    def test_no_frame_without_the_scene_while_orbiting(self):
        window = self.open("--sample", "--preview", "native", width=1600, height=900)
        self.wait_for_scene(window)
        with Busy():
            frames = self.frames_while_orbiting(window, FRAMES)
        self.assert_all_show_the_scene(frames)
        window.wait(lambda s: not s["busy"], "the picture did not come to rest", 60)
        self.assertGreaterEqual(len(set(self.colours(window))), LEAST_COLOURS)
        self.assertEqual(window.close(), 0)

    def test_no_frame_without_the_scene_between_the_ways_of_showing_it(self):
        window = self.open("--sample", width=1000, height=640)
        self.wait_for_scene(window)
        for mode, name in [(2, "Rings"), (0, "Beauty"), (4, "Depth"), (3, "Ellipsoids"), (0, "Beauty")]:
            window.click("viewport.mode")
            window.wait_widget(f"viewport.mode.{name}")
            x, y = window.place(f"viewport.mode.{name}")
            window.xdotool("mousemove", x, y, "sleep", 0.3, "mousedown", 1, "sleep", 0.1, "mouseup", 1)
            end = time.monotonic() + 1.5
            while time.monotonic() < end:
                self.assertGreaterEqual(len(set(self.colours(window))), LEAST_COLOURS,
                                        f"blank on the way to {name}")
            window.wait(lambda s: s["mode"] == mode and not s["busy"], f"{name} did not come to rest", 90)
        for _ in range(4):   # hold and release: the original beside the state now
            window.xdotool("key", "v")
            end = time.monotonic() + 1
            while time.monotonic() < end:
                self.assertGreaterEqual(len(set(self.colours(window))), LEAST_COLOURS,
                                        "blank while comparing")
        self.assertEqual(window.close(), 0)

    def test_nothing_is_drawn_while_nothing_happens(self):
        window = self.open("--sample", width=1000, height=640)
        self.wait_for_scene(window)
        window.wait(lambda s: s["rests"] >= 2, "the window does not come to rest", 60)
        before = window.state()
        window.wait(lambda s: s["rests"] >= before["rests"] + 6, "the window does not stay at rest", 30)
        self.assertEqual(window.state()["frames"], before["frames"])
        window.xdotool("mousemove", *window.place("viewport", 0.4, 0.4))
        window.wait(lambda s: s["frames"] > before["frames"], "the mouse does not wake it", 10)
        self.assertGreaterEqual(len(set(self.colours(window))), LEAST_COLOURS)
        self.assertEqual(window.close(), 0)


if __name__ == "__main__":
    unittest.main()
