"""models: the list of models on this machine; edits with those that are for a server."""
import json
import os
import pathlib
import struct
import unittest

from program import ProgramTest, run

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = ROOT / "assets/scenes/bear/scene.ply"
FLUX = {"double_blocks.0.img_attn.norm.key_norm.scale": [128], "img_in.weight": [3072, 64],
        "guidance_in.in_layer.weight": [3072, 256]}
STABLE_DIFFUSION = {
    "model.diffusion_model.input_blocks.0.0.weight": [320, 4, 3, 3],
    "model.diffusion_model.input_blocks.1.1.transformer_blocks.0.attn2.to_k.weight": [320, 768],
    "cond_stage_model.transformer.text_model.embeddings.token_embedding.weight": [49408, 768],
    "first_stage_model.decoder.conv_in.weight": [512, 4, 3, 3]}


def safetensors(tensors, number="F16"):
    header = {name: {"dtype": number, "shape": shape, "data_offsets": [0, 0]}
              for name, shape in tensors.items()}
    text = json.dumps(header).encode()
    return struct.pack("<Q", len(text)) + text


def gguf(architecture):
    name, value = b"general.architecture", architecture.encode()
    return (b"GGUF" + struct.pack("<IQQ", 3, 0, 1) + struct.pack("<Q", len(name)) + name +
            struct.pack("<IQ", 8, len(value)) + value)


class Models(ProgramTest):
    def setUp(self):
        super().setUp()
        for name, value in (("HOME", self.folder), ("XDG_DATA_HOME", ""), ("GSE_MODELS", ""),
                            ("COMFYUI_PATH", ""), ("SD_DATADIR", ""), ("SD_MODELSDIR", "")):
            before = os.environ.get(name)
            self.addCleanup(lambda name=name, before=before: os.environ.pop(name) if before is None
                            else os.environ.update({name: before}))
            os.environ[name] = str(value)

    def put(self, name, data):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
        return path

    def listed(self, *folders):
        process = run("models", *folders, "--json")
        self.assertEqual(process.returncode, 0, process.stderr)
        listed = json.loads(process.stdout)
        return {pathlib.Path(model["path"]).name: model for model in listed["models"]}

    def test_models_of_other_programs_are_listed_with_their_use(self):
        self.put("ComfyUI/models/diffusion_models/flux1-kontext.safetensors", safetensors(FLUX))
        self.put("ComfyUI/models/unet/qwen.gguf", gguf("qwen_image"))
        self.put("stable-diffusion-webui/models/Stable-diffusion/v1.safetensors",
                 safetensors(STABLE_DIFFUSION))
        self.put("stable-diffusion-webui/models/Stable-diffusion/small.safetensors",
                 safetensors(STABLE_DIFFUSION, "F8_E4M3"))
        self.put("ComfyUI/models/upscale_models/x4.pth", b"PK\x03\x04")
        models = self.listed()
        self.assertEqual({name: model["use"] for name, model in models.items()},
                         {"flux1-kontext.safetensors": "server", "qwen.gguf": "server",
                          "v1.safetensors": "here", "small.safetensors": "server", "x4.pth": "none"})
        self.assertEqual(models["v1.safetensors"]["option"], "--model")
        self.assertEqual(models["flux1-kontext.safetensors"]["server_family"], "kontext")
        table = run("models")
        self.assertEqual(table.returncode, 0, table.stderr)
        self.assertIn("FLUX.1 diffusion model, fp16", table.stdout)
        self.assertIn("Qwen-Image diffusion model, GGUF", table.stdout)
        self.assertIn("5 found: 1 loaded here, 3 through a server, 1 not used", table.stdout)
        for line in table.stdout.splitlines():
            self.assertLessEqual(len(line), 100)

    def test_named_folders_replace_the_usual_ones(self):
        self.put("ComfyUI/models/unet/usual.safetensors", safetensors(FLUX))
        self.put("mine/own.safetensors", safetensors(FLUX))
        self.assertEqual(list(self.listed(self.folder / "mine")), ["own.safetensors"])
        self.assertEqual(list(self.listed(self.folder / "ComfyUI")), ["usual.safetensors"])
        self.assert_one_sentence(run("models", self.folder / "nowhere"), "no folder of models")

    def test_a_broken_file_is_a_row_and_nothing_found_names_the_places(self):
        nothing = run("models")
        self.assertEqual(nothing.returncode, 0, nothing.stderr)
        self.assertIn("Looked at:", nothing.stdout)
        self.assertIn(str(self.folder / "ComfyUI/models"), nothing.stdout)
        self.put("mine/page.safetensors", b"<!DOCTYPE html>")
        self.put("mine/deep.safetensors", struct.pack("<Q", 100_006) + b'{"a": ' + b"[" * 100_000)
        self.put("mine/own.safetensors", safetensors(FLUX))
        models = self.listed(self.folder / "mine")
        self.assertEqual(len(models), 3)
        self.assertTrue(models["page.safetensors"]["broken"])
        self.assertTrue(models["deep.safetensors"]["broken"])
        self.assertIn("broken", run("models", self.folder / "mine").stdout)

    @unittest.skipUnless((ROOT / "assets/models/starter/model_index.json").exists(),
                         "[skip] the starter model is not there")
    def test_an_edit_with_a_model_for_a_server_is_refused_in_one_sentence(self):
        for name, data, words in (
                ("q4.gguf", gguf("flux"), ("GGUF files are not loaded here", "--server")),
                ("small.safetensors", safetensors(STABLE_DIFFUSION, "F8_E4M3"), ("fp8", "--server")),
                ("flux.safetensors", safetensors(FLUX), ("FLUX.1", "--server")),
                ("lora.safetensors",
                 safetensors({"lora_unet_double_blocks_0_img_attn_proj.lora_down.weight": [4, 3072]}),
                 ("LoRA of FLUX.1", "--server"))):
            with self.subTest(name):
                process = run("edit", SCENE, "--source", "bear", "--prompt", "a golden bear", "--model",
                              self.put(name, data), "--out", self.folder / "out")
                self.assert_one_sentence(process, *words)
                self.assertEqual(process.returncode, 2, process.stderr)
                self.assertFalse((self.folder / "out").exists())

    def test_weights_in_place_of_a_scene_are_named_with_what_takes_them(self):
        lora = "lora_unet_down_blocks_0_attentions_0_transformer_blocks_0_attn2_to_k.lora_down.weight"
        for name, data, words in (
                ("v1.safetensors", safetensors(STABLE_DIFFUSION), ("Stable Diffusion 1.x", "--model",
                                                                   "Models")),
                ("style.safetensors", safetensors({lora: [4, 768]}), ("LoRA of Stable Diffusion 1.x",
                                                                      "--lora", "Models")),
                ("style.SFT", safetensors({lora: [4, 768]}), ("LoRA of Stable Diffusion 1.x", "--lora")),
                ("flux.safetensors", safetensors(FLUX), ("FLUX.1 diffusion model", "--server")),
                ("q4.gguf", gguf("flux"), ("FLUX.1", "GGUF", "--server")),
                ("vae.safetensors", safetensors({"decoder.conv_in.weight": [512, 4, 3, 3],
                                                 "encoder.conv_in.weight": [128, 3, 3, 3]}),
                 ("VAE of Stable Diffusion", "NAME.vae.safetensors")),
                ("other.safetensors", safetensors({"a": [1]}), ("unknown weights", "gseditpro models")),
                ("page.safetensors", b"<!DOCTYPE html>", ("by its name", "not a file of weights",
                                                          "download it again")),
                ("chkpnt30000.pth", b"PK\x03\x04" + bytes(40), ("pickled", "PLY", ".safetensors")),
                ("v1.ckpt", b"\x80\x02" + bytes(40), ("pickled", ".safetensors")),
                ("sam.pt", b"PK\x03\x04" + bytes(40), ("pickled", "--segmenter"))):
            path = self.put(f"weights/{name}", data)
            commands = [["open", path], [path], ["convert", path, self.folder / "out.ply"],
                        ["render", path, self.folder / "out.png"],
                        ["turntable", path, self.folder / "out.mp4"],
                        ["turntable", SCENE, self.folder / "out.mp4", "--before", path],
                        ["transform", path, self.folder / "out.ply", "--turn", 20],
                        ["edit", path, "--source", "bear", "--prompt", "a golden bear", "--out",
                         self.folder / "out"],
                        ["merge", SCENE, path, "--out", self.folder / "out.ply"]]
            if name in ("page.safetensors", "chkpnt30000.pth", "v1.ckpt", "sam.pt"):
                commands.append(["info", path])   # of others it prints the facts
            for command in commands:
                with self.subTest(command=command[0], name=name):
                    process = run(*command)
                    self.assert_one_sentence(process, *words, name)
                    self.assertEqual(process.returncode, 2)
        self.assertEqual(self.folder_listing(), sorted(
            ["weights", *(f"weights/{path.name}" for path in (self.folder / "weights").iterdir())]))

    def test_info_says_which_option_takes_weights(self):
        lora = "lora_unet_down_blocks_0_attentions_0_transformer_blocks_0_attn2_to_k.lora_down.weight"
        for name, tensors, option, problem in (
                ("style.safetensors", {lora: [4, 768]}, "--lora", ""),
                ("v1.safetensors", STABLE_DIFFUSION, "--model", ""),
                ("flux.safetensors", FLUX, "", "a server can use it")):
            facts = self.info(self.put(name, safetensors(tensors)))
            self.assertEqual(facts["use"], option)
            (self.assertIn if problem else self.assertEqual)(problem, facts["problem"])

    def test_a_folder_of_weights_is_named_too(self):
        lora = "base_model.model.down_blocks.0.attentions.0.transformer_blocks.0.attn2.to_k.lora_A.weight"
        self.put("peft/adapter_model.safetensors", safetensors({lora: [4, 768]}))
        self.assert_one_sentence(run("convert", self.folder / "peft", self.folder / "out.ply"), "LoRA",
                                 "--lora")
        starter = ROOT / "assets/models/starter"
        if (starter / "model_index.json").exists():
            self.assert_one_sentence(run("convert", starter, self.folder / "out.ply"), "starter", "--model")

    def test_pickles_that_are_cameras_or_missing_are_no_weights(self):
        self.assert_one_sentence(run("convert", self.folder / "none.safetensors", self.folder / "out.ply"),
                                 "none.safetensors")
        self.put("cameras.bin", bytes(64))
        said = self.assert_one_sentence(run("convert", self.folder / "cameras.bin", self.folder / "out.ply"))
        self.assertNotIn("pickled", said)


if __name__ == "__main__":
    unittest.main()
