"""The real program over hostile files of every format, under a limit of memory and of time: whatever is in a
file, the answer is a result or one sentence, never a signal, an "unexpected failure", a raw control character
or more memory than the file's size allows. GSE_STRESS_FILES sets the number of files per format;
GSE_STRESS_SEED the seed; files that fail are kept in GSE_STRESS_KEEP (or the temporary folder)."""
import json
import os
import pathlib
import random
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import unittest

import mutations
from mutations import change_gzip, change_header, change_safetensors, change_text, change_zip, mutate

PROGRAM = os.environ["GSE_PROGRAM"]
ROOT = pathlib.Path(__file__).resolve().parents[3]
CORPUS = ROOT / "tests/fuzz/corpus"
SHARED = pathlib.Path(os.environ.get("GSE_SHARED") or os.environ.get("GSE_SHARED_DEFAULT", "../shared"))
SEED = int(os.environ.get("GSE_STRESS_SEED", "1"))
FILES = int(os.environ.get("GSE_STRESS_FILES", "16"))
BATCH = 20                       # scenes that one process looks at
ADDRESS_SPACE = 6 << 30          # bytes; libraries and thread stacks take most of it
LARGEST_RSS = 900 << 10          # kilobytes: the program itself, and what a small file may claim
CPU_SECONDS = 60
SANITIZED = os.environ.get("GSE_SANITIZED", "0") == "1"   # shadow memory does not fit any limit
ENVIRONMENT = {**os.environ, "GSE_CACHE_DIR": os.devnull,
               "OPENBLAS_CORETYPE": os.environ.get("OPENBLAS_CORETYPE", "Haswell"),
               "OPENBLAS_NUM_THREADS": "1"}


def limit():
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS + 5))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if not SANITIZED:
        resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))


class Result:
    """Exit status, outputs and peak memory of one run."""

    def __init__(self, arguments, folder):
        with open(folder / "stdout", "wb") as out, open(folder / "stderr", "wb") as err:
            process = subprocess.Popen([PROGRAM, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=out,
                                       stderr=err,
                                       env=ENVIRONMENT, preexec_fn=limit, cwd=folder)
            timer = threading.Timer(600, process.kill)
            timer.start()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            timer.cancel()
        self.code = process.returncode
        self.rss = usage.ru_maxrss
        self.out = (folder / "stdout").read_bytes()
        self.err = (folder / "stderr").read_bytes()

    def complaint(self):
        """What is wrong with this run, or nothing."""
        if self.code < 0:
            return f"ended by {signal.Signals(-self.code).name}"
        if self.code not in (0, 1, 2):
            return f"exit code {self.code}"
        if b"unexpected failure" in self.err:
            return "unexpected failure"
        if self.code != 0 and not self.err.strip():
            return "failed without a sentence"
        for text in (self.out, self.err):
            try:
                letters = text.decode()
            except UnicodeDecodeError:
                return "output that is not UTF-8"
            if any((letter < " " and letter != "\n") or "\x7f" <= letter < "\xa0" or letter == "\u202e"
                   for letter in letters):
                return "a raw control character"
        if not SANITIZED and self.rss > LARGEST_RSS:
            return f"{self.rss // 1024} MB of memory"
        return None


class HostileFiles(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="gse-hostile-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.random = random.Random(f"{SEED} {self.id()}")

    def corpus(self, name):
        return [path.read_bytes() for path in sorted((CORPUS / name).iterdir()) if path.is_file()]

    def check(self, paths, result, arguments):
        complaint = result.complaint()
        if complaint is None:
            return
        keep = pathlib.Path(os.environ.get("GSE_STRESS_KEEP",
                                           tempfile.gettempdir())) / f"gse-hostile-{self.id()}"
        shutil.rmtree(keep, ignore_errors=True)
        keep.mkdir(parents=True)
        for path in paths:
            (shutil.copytree if path.is_dir() else shutil.copy)(path, keep / path.name)
        self.fail(f"{complaint}: {' '.join(map(str, arguments))}\n{result.err[-600:]!r}\nkept in {keep}")

    def run_one(self, paths, *arguments):
        self.check(paths, Result(arguments, self.folder), arguments)

    def look_at(self, paths):
        """`info` over many; when something is wrong, one by one to find which."""
        for begin in range(0, len(paths), BATCH):
            batch = paths[begin:begin + BATCH]
            result = Result(["info", *batch], self.folder)
            said = result.out + result.err
            if result.complaint() is None and all(path.name.encode() in said for path in batch):
                continue
            for path in batch:
                self.run_one([path], "info", path)
            self.check(batch, result, ["info", *batch])   # only together
            self.fail(f"info did not speak of every file: {said[-600:]!r}")

    def scenes(self, corpus, ending, *ways, count=FILES):
        self.mutated(self.corpus(corpus), ending, ways, count)

    def mutated(self, seeds, ending, ways, count=FILES):
        self.assertTrue(seeds)
        paths = []
        for number in range(count):
            path = self.folder / f"{number:05}.{ending}"
            path.write_bytes(mutate(self.random.choice(seeds), ways, self.random))
            paths.append(path)
            if len(paths) == BATCH or number + 1 == count:
                self.look_at(paths)
                for done in paths:
                    done.unlink()
                paths = []

    def test_ply(self):
        self.scenes("ply", "ply", change_header)

    def test_compressed_ply(self):
        self.scenes("compressed_ply", "ply", change_header)

    def test_splat(self):
        self.scenes("splat", "splat")

    def test_ksplat(self):
        self.scenes("ksplat", "ksplat")

    def test_spz(self):
        self.scenes("spz", "spz", change_gzip)

    def test_sog(self):
        self.scenes("sog", "sog", change_zip)

    def test_sog_folder(self):
        """Unpacked scenes and trees of levels."""
        import io
        import zipfile
        seeds = []
        for data in self.corpus("sog"):
            try:
                archive = zipfile.ZipFile(io.BytesIO(data))
                seeds.append({name: archive.read(name) for name in archive.namelist()})
            except (zipfile.BadZipFile, NotImplementedError):
                continue
        self.assertTrue(seeds)
        tree = {"filenames": ["0/meta.json", "1/meta.json"],
                "tree": {"children": [{"lods": {"0": {"file": 0}}},
                                      {"children": [{"lods": {"0": {"file": 1}}}]}]}}
        folders = []
        for number in range(FILES):
            folder = self.folder / f"scene{number:05}"
            members = self.random.choice(seeds)
            hostile = self.random.choice([*members, "lod-meta.json"])
            for part in ("0", "1"):
                (folder / part).mkdir(parents=True)
                for name, content in members.items():
                    if name == hostile and part == "1":
                        content = mutate(content, [change_text] if name.endswith(".json") else [],
                                         self.random)
                    (folder / part / pathlib.Path(name).name).write_bytes(content)
            text = json.dumps(tree).encode()
            (folder / "lod-meta.json").write_bytes(
                mutate(text, [change_text], self.random) if hostile == "lod-meta.json" else text)
            folders.append(folder)
        self.look_at(folders)

    def test_wrapped(self):
        """Archives, gzip streams and projects of other programs around a scene; some in one another."""
        for ending, way in ((".zip", change_zip), (".gz", change_gzip), (".ssproj", change_zip)):
            with self.subTest(ending):
                seeds = [path.read_bytes() for path in sorted((CORPUS / "wrapped").glob(f"*{ending}"))]
                name = "ply.gz" if ending == ".gz" else ending[1:]
                self.mutated(seeds, name, [way], max(1, FILES // 3))

    def test_colmap(self):
        """Models beside a scene, as text and as binary files."""
        scene = self.corpus("ply")[-1]
        folders = []
        for number in range(FILES):
            data = self.random.choice(self.corpus("colmap"))
            split = 3 + struct.unpack("<H", data[1:3])[0]
            ending, ways = (".bin", []) if data[0] % 2 == 0 else (".txt", [change_text])
            folder = self.folder / f"model{number:05}"
            (folder / "sparse/0").mkdir(parents=True)
            (folder / "scene.ply").write_bytes(scene)
            parts = {"cameras": data[3:split], "images": data[split:]}
            hostile = self.random.choice([*parts])
            for name, content in parts.items():
                if name == hostile:
                    content = mutate(content, ways, self.random)
                (folder / "sparse/0" / (name + ending)).write_bytes(content)
            folders.append(folder)
        self.look_at(folders)
        for folder in folders[:max(1, FILES // 8)]:
            self.run_one([folder], "cameras", folder, self.folder / "transforms.json")

    def test_pictures(self):
        seeds = [data for data in self.corpus("png") if data.startswith(b"\x89PNG")]
        self.mutated(seeds, "png", [])
        path = self.folder / "hostile.png"
        for _ in range(max(1, FILES // 4)):
            path.write_bytes(mutate(self.random.choice(seeds), [], self.random))
            self.run_one([path], "edit", self.folder / "none.ply", "--recipe", path, "--out",
                         self.folder / "out")

    def test_headers_of_weights(self):
        """Safetensors, GGUF and pickles, in a list of models and in place of a scene."""
        header = {"__metadata__": {"format": "pt", "modelspec.architecture": "stable-diffusion-v1"},
                  "lora_unet_down_blocks_0_attentions_0_proj_in.lora_down.weight":
                      {"dtype": "F16", "shape": [4, 320], "data_offsets": [0, 2560]}}
        text = json.dumps(header).encode()
        name, value = b"general.architecture", b"flux"
        seeds = {"safetensors": struct.pack("<Q", len(text)) + text + bytes(2560),
                 "gguf": b"GGUF" + struct.pack("<IQQ", 3, 1, 1) + struct.pack("<Q", len(name)) + name +
                 struct.pack("<IQ", 8, len(value)) + value + struct.pack("<Q", 6) + b"weight" +
                 struct.pack("<IQQIQ", 2, 64, 64, 1, 0) + bytes(64),
                 "pt": b"PK\x03\x04" + bytes(60)}
        paths = []
        for number in range(FILES):
            ending = self.random.choice([*seeds])
            ways = [change_safetensors] if ending == "safetensors" else []
            path = self.folder / f"{number:05}.{ending}"
            path.write_bytes(mutate(seeds[ending], ways, self.random))
            paths.append(path)
        self.run_one(paths, "models", self.folder)
        self.run_one(paths, "models", self.folder, "--json")
        for path in paths[:max(1, FILES // 4)]:
            self.run_one([path], "info", path)
            self.run_one([path], "convert", path, self.folder / "out.ply")

    def test_loras(self):
        """Weights and adapter_config.json; each run loads the networks, so fewer of them."""
        samples = SHARED / "data/odd"
        if not samples.exists() or not (ROOT / "assets/models/starter/model_index.json").exists():
            self.skipTest(f"[skip] {samples} or the starter model is not there")
        scene = ROOT / "assets/scenes/bear/scene.ply"
        seeds = [path for path in sorted(samples.glob("*_lora_*/**/*.safetensors"))]
        self.assertTrue(seeds)
        for _ in range(max(1, FILES // 8)):
            seed = self.random.choice(seeds)
            lora = self.folder / "lora"
            shutil.rmtree(lora, ignore_errors=True)
            lora.mkdir()
            config = seed.parent / "adapter_config.json"
            hostile_config = config.exists() and self.random.random() < 0.5
            weights = seed.read_bytes()
            if config.exists():
                text = config.read_bytes()
                (lora / config.name).write_bytes(
                    mutate(text, [change_text] * 3, self.random) if hostile_config else text)
            (lora / seed.name).write_bytes(
                weights if hostile_config else mutate(weights, [change_safetensors] * 3, self.random))
            self.run_one([lora], "locate", scene, "--lora", lora if config.exists() else lora / seed.name,
                         "--source", "bear", "--prompt", "a blue bear", "--views", 1, "--image-size", 16,
                         "--attention-repeats", 1, "--no-focus", "--out", self.folder / "out")

    def test_projects(self):
        seeds = [data for data in self.corpus("project") if data[:2] == b"PK"]
        path = self.folder / "hostile.gsep"
        for _ in range(FILES):
            path.write_bytes(mutate(self.random.choice(seeds), [change_zip, change_zip], self.random))
            self.run_one([path], "project", path)
            self.run_one([path], "project", path, "--export", self.folder / "out.ply")

    def test_recipes(self):
        """Read before the scene, which is not there."""
        seed = (ROOT / "assets/scenes/demo.recipe.json").read_bytes()
        path = self.folder / "recipe.json"
        for _ in range(FILES):
            path.write_bytes(mutate(seed, [change_text, change_text], self.random))
            self.run_one([path], "edit", self.folder / "none.ply", "--recipe", path, "--out",
                         self.folder / "out")
            self.assertFalse((self.folder / "out").exists())

    def cameras(self, corpus, name):
        scene = self.folder / "scene.ply"
        scene.write_bytes(self.corpus("ply")[-1])
        path = self.folder / name
        for _ in range(FILES):
            path.write_bytes(mutate(self.random.choice(self.corpus(corpus)), [change_text, change_text],
                                    self.random))
            self.run_one([path], "render", scene, self.folder / "out.png", "--cameras", path, "--view", 0,
                         "--width", 8,
                         "--height", 8)

    def test_cameras_json(self):
        self.cameras("cameras_json", "cameras.json")

    def test_transforms(self):
        self.cameras("transforms", "transforms.json")

    def test_camera_paths(self):
        key = {"time": 0.0, "position": [0, 0, -3], "rotation": [1, 0, 0, 0], "focal_length_mm": 30,
               "easing": "linear"}
        seed = json.dumps({"version": 1, "clip_duration": 0.1,
                           "keyframes": [key, {**key, "time": 0.1}]}).encode()
        scene = self.folder / "scene.ply"
        scene.write_bytes(self.corpus("ply")[-1])
        path = self.folder / "path.json"
        for _ in range(FILES):
            path.write_bytes(mutate(seed, [change_text, change_text], self.random))
            self.run_one([path], "turntable", scene, self.folder / "frames", "--path", path, "--fps", 10,
                         "--width", 16,
                         "--height", 16)

    def test_models(self):
        """Configurations, vocabularies and weights; each run loads the networks' library, so fewer of
        them."""
        starter = ROOT / "assets/models/starter"
        if not (starter / "model_index.json").exists():
            self.skipTest("[skip] the starter model is not there")
        scene = ROOT / "assets/scenes/bear/scene.ply"
        parts = ["model_index.json", "gseditpro.json", "unet/config.json", "vae/config.json",
                 "text_encoder/config.json",
                 "scheduler/scheduler_config.json", "tokenizer/vocab.json", "tokenizer/merges.txt",
                 "tokenizer/tokenizer_config.json", "unet/diffusion_pytorch_model.safetensors",
                 "text_encoder/model.safetensors"]
        parts = [part for part in parts if (starter / part).exists()]
        for _ in range(max(1, FILES // 8)):
            model = self.folder / "model"
            shutil.rmtree(model, ignore_errors=True)
            part = self.random.choice(parts)
            for file in starter.rglob("*"):
                if not file.is_file():
                    continue
                place = model / file.relative_to(starter)
                place.parent.mkdir(parents=True, exist_ok=True)
                if file == starter / part:
                    way = change_safetensors if part.endswith(".safetensors") else change_text
                    place.write_bytes(mutate(file.read_bytes(), [way, way], self.random))
                else:
                    place.symlink_to(file)
            self.run_one([model / part], "locate", scene, "--model", model, "--source", "bear", "--prompt",
                         "a blue bear",
                         "--views", 1, "--image-size", 16, "--attention-repeats", 1, "--no-focus", "--out",
                         self.folder / "out")

    def test_a_file_that_is_cut_off_while_it_is_read(self):
        """Mapped into memory, it would end the program."""
        header = (b"ply\nformat binary_little_endian 1.0\nelement vertex 400000\n" +
                  b"".join(b"property float %s\n" % name for name in
                           b"x y z f_dc_0 f_dc_1 f_dc_2 opacity "
                           b"scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3".split()) +
                  b"end_header\n")
        row = struct.pack("<14f", 0, 0, 0, 0, 0, 0, 3, -3, -3, -3, 1, 0, 0, 0)
        path = self.folder / "shrinking.ply"
        path.write_bytes(header + row * 400000)
        whole = path.stat().st_size
        for _ in range(max(8, FILES // 8)):
            end = threading.Event()

            def cut_and_grow(end=end):
                while not end.wait(self.random.uniform(0, 0.04)):
                    os.truncate(path, self.random.choice([1000, whole // 2, whole - 4096]))
                    end.wait(self.random.uniform(0, 0.02))
                    os.truncate(path, whole)

            thread = threading.Thread(target=cut_and_grow)
            thread.start()
            try:
                self.run_one([], "info", path)
            finally:
                end.set()
                thread.join()

    def test_the_samples(self):
        folder = SHARED / "data/hostile"
        if not folder.exists():
            self.skipTest(f"[skip] {folder} is not there")
        self.look_at([path for path in sorted(folder.iterdir()) if path.is_dir()
                      or path.suffix in (".ply", ".sog", ".spz")])
        for path in sorted(folder.glob("*.gsep")):
            self.run_one([path], "project", path)
        for path in sorted(folder.glob("recipe*.json")):
            self.run_one([path], "edit", self.folder / "none.ply", "--recipe", path, "--out",
                         self.folder / "out")


if __name__ == "__main__":
    sys.exit(unittest.main())
