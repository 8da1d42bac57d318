"""Drives the editor's window: starts Xvfb and the program, clicks and types with xdotool, looks at its
state."""
import ctypes
import ctypes.util
import json
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import tempfile
import time
import unittest

PROGRAM = os.environ["GSE_PROGRAM"]
PICTURES = pathlib.Path(os.environ.get("GSE_PICTURES", "window_pictures"))
WIDTH, HEIGHT = 1280, 720
PATIENCE = float(os.environ.get("GSE_PATIENCE", "1"))   # instrumented builds are that much slower


def free_display():
    for number in range(120, 160):
        places = (f"/tmp/.X11-unix/X{number}", f"/tmp/.X{number}-lock")
        if not any(pathlib.Path(place).exists() for place in places):
            return f":{number}"
    raise RuntimeError("no free display")


class Window:
    """One run of the program on a display of its own."""

    def __init__(self, folder, *arguments, width=WIDTH, height=HEIGHT, sized=True):
        """`sized`: the window is told to be as large as the screen; else it finds its size itself."""
        self.folder = pathlib.Path(folder)
        self.map = self.folder / "widgets.json"
        for old in (self.map, pathlib.Path(str(self.map) + ".state"), self.folder / "first_frame"):
            old.unlink(missing_ok=True)
        self.display = free_display()
        self.server = subprocess.Popen(["Xvfb", self.display, "-screen", "0", f"{width}x{height}x24",
                                        "-nolisten", "tcp",
                                        "-fbdir", str(self.folder)],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        socket = pathlib.Path("/tmp/.X11-unix/X" + self.display[1:])
        self._until(socket.exists, 20, "the X server did not start")
        self.environment = dict(os.environ, DISPLAY=self.display, GSE_UI_MAP=str(self.map),
                                GSE_UI_FIRST_FRAME=str(self.folder / "first_frame"),
                                GSE_CONFIG_DIR=str(self.folder / "config"),
                                GSE_STATE_DIR=str(self.folder / "state"),
                                GSE_CACHE_DIR=str(self.folder / "cache"))
        self.log = open(self.folder / "window.log", "ab")
        size = ["--width", str(width), "--height", str(height)] if sized else []
        self.process = subprocess.Popen([PROGRAM, "open", *size, *map(str, arguments)],
                                        env=self.environment, cwd=self.folder, stdout=self.log,
                                        stderr=self.log)
        self._until(lambda: pathlib.Path(str(self.map) + ".state").exists(), 60, "the window did not come up")

    # Looking
    def _read(self, path):
        for _ in range(50):
            try:
                return json.loads(pathlib.Path(path).read_text())
            except (json.JSONDecodeError, FileNotFoundError):
                time.sleep(0.02)
        raise AssertionError(f"{path} cannot be read")

    def widgets(self):
        return self._read(self.map)

    def state(self):
        return self._read(str(self.map) + ".state")

    def _until(self, condition, seconds, message):
        end = time.monotonic() + seconds * PATIENCE
        while time.monotonic() < end:
            if condition():
                return
            if hasattr(self, "process") and self.process.poll() is not None:
                raise AssertionError(f"the program ended with {self.process.returncode}: "
                                     + (self.folder / "window.log").read_text()[-2000:])
            time.sleep(0.05)
        raise AssertionError(message + (f": {self.state()}" if hasattr(self, "process") else ""))

    def wait(self, condition, message, seconds=120):
        """Until condition(state) holds."""
        self._until(lambda: condition(self.state()), seconds, message)

    def steady(self, name, seconds=1):
        """The value once it has not changed for a while: what was typed or drawn has arrived."""
        value, since = self.state()[name], time.monotonic()
        while time.monotonic() - since < seconds * PATIENCE:
            time.sleep(0.1)
            now = self.state()[name]
            if now != value:
                value, since = now, time.monotonic()
        return value

    def wait_widget(self, name, seconds=20, enabled=True):
        self._until(lambda: self.widgets().get(name, {}).get("visible") and
                    (not enabled or self.widgets()[name]["enabled"]), seconds, f"{name} is not there")

    def idle(self, seconds=180):
        time.sleep(0.3)
        self.wait(lambda s: not s["job"]["running"] and not s["file_job"]["running"], "the job did not end",
                  seconds)

    # Doing
    def xdotool(self, *arguments):
        subprocess.run(["xdotool", *map(str, arguments)], env=self.environment, check=True,
                       stdout=subprocess.DEVNULL)

    def place(self, name, x=0.5, y=0.5):
        rect = self.widgets()[name]
        return round(rect["x"] + x * rect["width"]), round(rect["y"] + y * rect["height"])

    def settle(self, seconds=0.25):
        """Until what was sent was seen: a moment, and on a busy machine as long as three frames take, or
        until the window has twice found nothing to draw."""
        before = self.state()
        time.sleep(seconds)
        end = time.monotonic() + 10 * PATIENCE
        while self.process.poll() is None and time.monotonic() < end:
            now = self.state()
            if now["frames"] >= before["frames"] + 3 or now["rests"] >= before["rests"] + 2:
                break
            time.sleep(0.05)

    def click(self, name, x=0.5, y=0.5, count=1):
        self.wait_widget(name)
        px, py = self.place(name, x, y)
        self.xdotool("mousemove", px, py)
        self.settle()
        for _ in range(count):
            self.xdotool("mousedown", 1)
            time.sleep(0.1)
            self.xdotool("mouseup", 1)
            time.sleep(0.1)
        self.settle()

    def scroll_to(self, name, panel):
        """Turns the wheel over a panel until the control is in sight."""
        self.xdotool("mousemove", *self.place(panel, 0.5, 0.4))
        for button in [5] * 40 + [4] * 60:   # down, and up again
            if self.widgets().get(name, {}).get("visible"):
                return
            self.xdotool("click", button)
            time.sleep(0.3)
        raise AssertionError(f"{name} does not come into sight")

    def press(self, name, condition, message, seconds=120, pause=1):
        """Clicks until condition(state) holds, or the program has ended: on a busy machine a click may fall
        between frames. `pause`: how long a click may take to show, in seconds, before the next one."""
        end = time.monotonic() + seconds * PATIENCE
        next_click = 0.0
        while self.process.poll() is None and not condition(self.state()):
            if time.monotonic() > end:
                raise AssertionError(f"{message}: {self.state()}")
            if time.monotonic() >= next_click and self.widgets().get(name, {}).get("visible"):
                self.click(name)
                next_click = time.monotonic() + pause * PATIENCE
            time.sleep(0.2)

    def cancel_job(self):
        """Stops the job; one that has worked for long asks first."""
        self.click("job.cancel")
        time.sleep(0.5)
        if self.widgets().get("question.0", {}).get("visible"):
            self.click("question.0")

    def drag(self, name, path, button=1, keys=()):
        """Presses at the first place (shares of the widget), moves along the others, releases."""
        points = [self.place(name, *share) for share in path]
        for key in keys:
            self.xdotool("keydown", key)
        self.xdotool("mousemove", *points[0])
        self.settle()
        self.xdotool("mousedown", button)
        for point in points[1:]:
            time.sleep(0.15)
            self.xdotool("mousemove", *point)
        time.sleep(0.25)
        self.xdotool("mouseup", button)
        for key in keys:
            self.xdotool("keyup", key)
        self.settle()

    def key(self, *keys):
        for key in keys:
            self.xdotool("key", key)
            self.settle()

    def type_number(self, name, text):
        """Ctrl + click turns a number that is dragged into one that is typed."""
        self.xdotool("keydown", "ctrl")
        self.click(name)
        self.xdotool("keyup", "ctrl")
        self.key("ctrl+a")
        self.xdotool("type", "--delay", "40", text)
        self.key("Return")

    def write(self, name, text):
        """Replaces the text of a field; the prompt's are typed until it has arrived: on a busy machine a
        click may fall between frames."""
        field = name.removeprefix("prompt.")
        for _ in range(4):
            self.click(name)
            self.key("ctrl+a")
            self.xdotool("type", "--delay", "40", text)
            time.sleep(0.3)
            if field not in ("source", "sentence") or self.steady(field, 0.5) == text:
                return
        raise AssertionError(f"\"{text}\" arrived as \"{self.state()[field]}\"")

    def type(self, field, text):
        """Replaces the text of the field of the prompt ("source", "sentence") that the keys are in."""
        self.wait(lambda s: s["focus"] == "prompt." + field, f"the keys do not go to the {field}", 10)
        self.key("ctrl+a")
        self.xdotool("type", "--delay", "40", text)
        arrived = self.steady(field)
        if arrived != text:
            raise AssertionError(f"\"{text}\" arrived as \"{arrived}\"")

    def press_close(self):
        """What the close button of a desktop's title bar sends: WM_DELETE_WINDOW."""
        found = subprocess.run(["xdotool", "search", "--name", "GSEditPro"], env=self.environment, check=True,
                               stdout=subprocess.PIPE, text=True).stdout.split()
        x11 = ctypes.CDLL(ctypes.util.find_library("X11") or "libX11.so.6")
        x11.XOpenDisplay.restype = ctypes.c_void_p
        x11.XInternAtom.restype = ctypes.c_ulong
        x11.XInternAtom.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int]
        x11.XSendEvent.argtypes = [ctypes.c_void_p, ctypes.c_ulong, ctypes.c_int, ctypes.c_long,
                                   ctypes.c_void_p]
        x11.XCloseDisplay.argtypes = [ctypes.c_void_p]
        display = x11.XOpenDisplay(self.display.encode())
        event = (ctypes.c_long * 24)()   # XClientMessageEvent
        event[0] = 33                    # ClientMessage
        event[4] = int(found[-1])
        event[5] = x11.XInternAtom(display, b"WM_PROTOCOLS", 0)
        event[6] = 32
        event[7] = x11.XInternAtom(display, b"WM_DELETE_WINDOW", 0)
        x11.XSendEvent(display, int(found[-1]), 0, 0, event)
        x11.XCloseDisplay(display)       # flushes
        time.sleep(0.5)

    def ended(self, seconds=60):
        """The program's exit code once it has left by itself."""
        try:
            self.process.wait(seconds * PATIENCE)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"the window stays: {self.state()}")
        return self.close()

    def picture(self, name):
        """A screenshot of the window, drawn by the program itself."""
        PICTURES.mkdir(parents=True, exist_ok=True)
        target = PICTURES / f"{name}.png"
        target.unlink(missing_ok=True)
        request = pathlib.Path(str(self.map) + ".capture")
        request.write_text(str(target))
        self._until(lambda: target.exists() and not request.exists(), 30, f"no screenshot {name}")
        return target

    def screen(self):
        """What is on the screen at this moment: (width, height, bytes of a row, pixels as 4 bytes each)."""
        # in the format of xwd, kept up to date by the server
        data = (self.folder / "Xvfb_screen0").read_bytes()
        header, _, _, _, width, height = struct.unpack(">6I", data[:24])
        row, colours = struct.unpack(">I", data[48:52])[0], struct.unpack(">I", data[76:80])[0]
        return width, height, row, data[header + 12 * colours:]

    # Ending
    def close(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(60)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        self.server.terminate()
        self.server.wait()
        self.log.close()
        return self.process.returncode

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.server.terminate()
        self.server.wait()
        self.log.close()


class WindowTest(unittest.TestCase):
    def setUp(self):
        for tool in ("Xvfb", "xdotool"):
            if shutil.which(tool) is None:
                self.skipTest(f"[skip] {tool} is not installed")
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="gse-window-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def open(self, *arguments, **sizes):
        window = Window(self.folder, *arguments, **sizes)
        self.addCleanup(lambda: window.process.poll() is None and window.close())
        return window
