"""LoRAs on the command line: they count, are in the recipe, and bad ones end the command before any work."""
import json
import os
import pathlib
import random
import struct
import unittest
import unittest.mock

from program import ProgramTest, run, run_laboratory

ASSETS = pathlib.Path(__file__).resolve().parents[2] / "assets"
MODEL = ASSETS / "models/starter"
SCENE = ASSETS / "scenes/bear/scene.ply"
QUICK = ["--views", 4, "--image-size", 64, "--attention-repeats", 1, "--iterations", 4, "--fit-steps", 4,
         "--edited-views", 2,
         "--turntable-frames", 2, "--turntable-size", 64, "--no-gate", "--no-focus"]
RANK = 2


def safetensors_bytes(tensors, metadata=None):
    """tensors: {name: (shape, floats)}, all F32."""
    header, data = {"__metadata__": metadata} if metadata else {}, b""
    for name, (shape, values) in tensors.items():
        raw = struct.pack(f"<{len(values)}f", *values)
        header[name] = {"dtype": "F32", "shape": shape, "data_offsets": [len(data), len(data) + len(raw)]}
        data += raw
    text = json.dumps(header).encode()
    return struct.pack("<Q", len(text)) + text + data


def model_shapes():
    with (MODEL / "unet/diffusion_pytorch_model.safetensors").open("rb") as file:
        length = struct.unpack("<Q", file.read(8))[0]
        return {name: entry["shape"] for name,
                entry in json.loads(file.read(length)).items() if name != "__metadata__"}


def lora_bytes(size=0.2, layers="attn2.to_v", rows=None, alpha=RANK, metadata=None, more=()):
    """Kohya's names, for the starter's layers that end so; `alpha` None = no tensor says it."""
    draw = random.Random(3)
    tensors = {name: ([1], [1.0]) for name in more}
    for name, shape in model_shapes().items():
        if not name.endswith(f"{layers}.weight"):
            continue
        stem = "lora_unet_" + name.removesuffix(".weight").replace(".", "_")
        out, inner = (rows or shape[0]), shape[1]
        tensors[f"{stem}.lora_down.weight"] = ([RANK, inner],
                                               [draw.gauss(0, size) for _ in range(RANK * inner)])
        tensors[f"{stem}.lora_up.weight"] = ([out, RANK], [draw.gauss(0, size) for _ in range(RANK * out)])
        if alpha is not None:
            tensors[f"{stem}.alpha"] = ([], [float(alpha)])
    assert tensors
    return safetensors_bytes(tensors, metadata)


@unittest.skipUnless((MODEL / "model_index.json").exists(), "[skip] the starter model is not there")
class Loras(ProgramTest):
    def edit(self, out, *arguments):
        return run("-q", "edit", SCENE, "--source", "bear", "--prompt", "a blue bear on the grass",
                   "--target", "blue",
                   "--front", 0, "--method", "views", "--out", out, *QUICK, *arguments)

    def edited(self, name, *arguments):
        out = self.folder / name
        process = self.edit(out, *arguments)
        self.assertEqual(process.returncode, 0, process.stderr)
        return out

    def test_they_count_by_their_strength_and_the_recipe_repeats_them(self):
        style = self.write("style.safetensors", lora_bytes())
        other = self.write("other.safetensors", lora_bytes(0.1, "attn1.to_q"))
        plain = self.edited("plain")
        off = self.edited("off", "--lora", f"{style}:0")
        self.assertEqual((off / "scene.ply").read_bytes(), (plain / "scene.ply").read_bytes())
        both = self.edited("both", "--lora", f"{style}:0.5", "--lora", other)
        self.assertNotEqual((both / "scene.ply").read_bytes(), (plain / "scene.ply").read_bytes())
        recipe = json.loads((both / "recipe.json").read_text())
        self.assertEqual(recipe["job"]["lora"], [f"{style}:0.5", str(other)])
        again = self.folder / "again"
        process = run("-q", "edit", "--recipe", both / "recipe.json", "--no-gate", "--out", again)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual((again / "scene.ply").read_bytes(), (both / "scene.ply").read_bytes())
        # What stands on the command line takes the place of the recipe's.
        process = run("-q", "edit", "--recipe", both / "recipe.json", "--no-gate", "--lora", f"{style}:0",
                      "--out", again)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual(json.loads((again / "recipe.json").read_text())["job"]["lora"], [f"{style}:0"])
        self.assertEqual((again / "scene.ply").read_bytes(), (plain / "scene.ply").read_bytes())

    def test_alphas_beside_the_tensors_count_and_what_is_left_out_is_said(self):
        style = self.write("style.safetensors", lora_bytes(alpha=8))
        told = self.write("told.safetensors", lora_bytes(alpha=None, metadata={"ss_network_alpha": "8"}))
        strong = (self.edited("strong", "--lora", style) / "scene.ply").read_bytes()
        self.assertEqual((self.edited("told", "--lora", told) / "scene.ply").read_bytes(), strong)
        weak = self.write("weak.safetensors", lora_bytes(alpha=None))
        self.assertNotEqual((self.edited("weak", "--lora", weak) / "scene.ply").read_bytes(), strong)
        more = self.write("more.sft", lora_bytes(alpha=8, more=["bundle_emb.style.string_to_param.*"]))
        with unittest.mock.patch.dict(os.environ, GSE_CACHE_DIR=str(self.folder / "cache")):
            for name in ("first", "second"):   # the second time from the cache
                process = self.edit(self.folder / name, "--lora", more)
                self.assertEqual(process.returncode, 0, process.stderr)
                self.assertIn("without 1 tensor of embeddings", process.stderr)
                self.assertEqual((self.folder / name / "scene.ply").read_bytes(), strong)

    def test_a_distilled_one_brings_its_few_steps(self):
        fast = self.write("my lcm.safetensors", lora_bytes(0.01))
        out = self.edited("fast", "--lora", fast)
        report = json.loads((out / "report.json").read_text())
        settings = {entry["field"]: entry["value"] for entry in report["settings_from"]}
        self.assertEqual(settings["request.view_steps"], 4)
        self.assertEqual(settings["guidance.view_guidance_scale"], 1)
        recipe = json.loads((out / "recipe.json").read_text())
        # Views, steps and rounds, one row each.
        self.assertEqual(report["networks"]["edit"]["unet"],
                         recipe["request"]["edited_views"] * 4 * recipe["request"]["rounds"])

    def test_bad_ones_end_the_command_before_any_work(self):
        cases = {"gone.safetensors": (None, ["no lora file", "gone.safetensors"]),
                 "other.safetensors": (lora_bytes(rows=3), ["shape", "other.safetensors"]),
                 "weights.safetensors": (safetensors_bytes({"conv_in.weight": ([1], [0.0])}),
                                         ["no lora", "weights.safetensors"]),
                 "empty.safetensors": (safetensors_bytes({}), ["no tensors"]),
                 "cut.safetensors": (lora_bytes()[:200], ["damaged", "cut.safetensors"]),
                 "pickle.pt": (b"\x80\x02}q", [".safetensors"])}
        for name, (data, words) in cases.items():
            path = self.folder / name
            if data is not None:
                path.write_bytes(data)
            before = self.folder_listing()
            for command in ("edit", "locate"):
                process = run("-q", command, SCENE, "--source", "bear", "--prompt", "a blue bear", "--lora",
                              path, "--out",
                              self.folder / "out", *(QUICK if command == "edit" else []))
                self.assert_one_sentence(process, *words)
            self.assert_one_sentence(run_laboratory("-q", "eval", "--edits", 1, "--lora", path, "--out",
                                                    self.folder / "out"), *words)
            self.assert_one_sentence(run_laboratory("-q", "bench", "search", "--scenes", 1, "--lora", path),
                                     *words)
            self.assertEqual(self.folder_listing(), before)
        good = self.write("good.safetensors", lora_bytes())
        self.assert_one_sentence(self.edit(self.folder / "out", "--lora", f"{good}:50"), "strength", "50")


if __name__ == "__main__":
    unittest.main()
