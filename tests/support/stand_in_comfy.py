#!/usr/bin/env python3
"""ComfyUI of the stand-in server: runs the few core nodes that the bundled workflows consist of."""
import json
import threading
import time
import uuid

import stand_in_pictures as pictures

# class -> names of its inputs that must be there
NODES = {
    "LoadImage": ["image"], "LoadImageMask": ["image", "channel"], "CheckpointLoaderSimple": ["ckpt_name"],
    "UNETLoader": ["unet_name", "weight_dtype"], "CLIPLoader": ["clip_name", "type"],
    "VAELoader": ["vae_name"],
    "CLIPTextEncode": ["text", "clip"], "VAEEncode": ["pixels", "vae"], "VAEDecode": ["samples", "vae"],
    "SetLatentNoiseMask": ["samples", "mask"], "FluxGuidance": ["conditioning", "guidance"],
    "InpaintModelConditioning": ["positive", "negative", "vae", "pixels", "mask", "noise_mask"],
    "ReferenceLatent": ["conditioning", "latent"], "ConditioningZeroOut": ["conditioning"],
    "KSampler": ["model", "seed", "steps", "cfg", "sampler_name", "scheduler", "positive", "negative",
                 "latent_image", "denoise"],
    "LoraLoader": ["model", "clip", "lora_name", "strength_model", "strength_clip"],
    "LoraLoaderModelOnly": ["model", "lora_name", "strength_model"],
    "SaveImage": ["images"], "PreviewImage": ["images"], "PaidApi": ["image"],
}
OUTPUTS = {"SaveImage", "PreviewImage"}
COMBOS = {"ckpt_name": ["stand-in.safetensors"], "unet_name": ["flux-2-klein-4b.safetensors"],
          "clip_name": ["qwen_3_4b.safetensors"], "vae_name": ["flux2-vae.safetensors"],
          "sampler_name": ["euler"], "scheduler": ["normal", "simple"], "channel": ["alpha", "red"],
          "lora_name": ["bronze.safetensors", "looks/oil paint.safetensors"], "type": ["flux2"],
          "weight_dtype": ["default"]}


class Graph:
    """Runs a workflow by following links back from its output."""

    def __init__(self, world, graph):
        self.world, self.graph = world, graph

    def value(self, link):
        """Output that a link leads to; a plain value is itself."""
        if not isinstance(link, list):
            return link
        node = self.graph[link[0]]
        return self.run(node["class_type"], node["inputs"], link[1])

    def run(self, kind, inputs, output):
        if kind == "LoadImage":
            picture = self.loaded(inputs["image"])
            if output == 0:
                return picture.colour()
            alpha = picture.alpha()
            return None if alpha is None else [255 - value for value in alpha]
        if kind == "LoadImageMask":
            return self.loaded(inputs["image"]).luma()
        if kind == "CLIPTextEncode":
            return {"text": self.value(inputs["text"]), "references": 0}
        if kind == "FluxGuidance":
            return self.value(inputs["conditioning"])
        if kind == "ConditioningZeroOut":
            return {"text": "", "references": 0}
        if kind == "ReferenceLatent":
            before = self.value(inputs["conditioning"])
            self.value(inputs["latent"])
            return {**before, "references": before["references"] + 1}
        if kind == "InpaintModelConditioning":
            if output < 2:
                return self.value(inputs["positive" if output == 0 else "negative"])
            return {"picture": self.value(inputs["pixels"]), "mask": self.value(inputs["mask"])}
        if kind == "VAEEncode":
            return {"picture": self.value(inputs["pixels"]), "mask": None}
        if kind == "SetLatentNoiseMask":
            return {**self.value(inputs["samples"]), "mask": self.value(inputs["mask"])}
        if kind == "KSampler":
            latent, words = self.value(inputs["latent_image"]), self.value(inputs["positive"])
            self.value(inputs["negative"])
            return pictures.draw(latent["picture"], latent["mask"], words["text"], self.value(inputs["seed"]),
                                 self.world.noise, self.world.drift)
        if kind == "VAEDecode":
            return self.value(inputs["samples"])
        return None

    def loaded(self, name):
        return pictures.decode_png(self.world.uploads[name])


def route(handler, method, path, query, value):
    world = handler.world
    place = path.strip("/").split("/")
    if path == "/system_stats":
        return handler.send_json({"system": {"comfyui_version": "0.3.66"}, "devices": []})
    if place[0] == "object_info":
        return handler.send_json(described(place[1]))
    if path.startswith("/models/"):
        return handler.send_json(COMBOS["ckpt_name"])
    if path == "/upload/image":
        return upload(handler)
    if path == "/prompt" and method == "POST":
        return prompt(handler, value)
    if place[0] == "history":
        return history(handler, method, place, value)
    if path == "/queue":
        return queue(handler, method, value)
    if path == "/view":
        return view(handler, query)
    if path == "/interrupt":
        world.interrupted = True
        return handler.send_json({})
    if place[:2] == ["api", "jobs"] and world.new_comfy:
        job = world.jobs.get(place[2], {})
        world.interrupted = world.interrupted or job.get("status") == "running"
        if job.get("status") == "queued":
            job["status"] = "cancelled"
        return handler.send_json({})
    return handler.send_json({"error": "no such place"}, 404)


def described(kind):
    if kind not in NODES:
        return {}
    required = {name: [COMBOS[name]] if name in COMBOS else ["ANY"] for name in NODES[kind]}
    return {kind: {"input": {"required": required}, "api_node": kind == "PaidApi"}}


def upload(handler):
    fields = {name: (file_name, content) for name, file_name, content in handler.parts}
    name, content = fields.get("image", ("", b""))
    if pictures.decode_png(content) is None:
        return handler.send_bytes(b"", "text/plain", 400)
    folder = fields["subfolder"][1].decode()
    kind = fields["type"][1].decode()
    handler.world.uploads[f"{folder}/{name}" + ("" if kind == "input" else f" [{kind}]")] = content
    return handler.send_json({"name": name, "subfolder": folder, "type": kind})


def errors_of(world, graph):
    found = {}
    for number, node in graph.items():
        kind, inputs = node.get("class_type"), node.get("inputs", {})
        missing = [name for name in NODES.get(kind, ["class_type"]) if name not in inputs]
        wrong = kind in ("LoadImage", "LoadImageMask") and inputs.get("image") not in world.uploads
        wrong = wrong or (world.fault == "no_temp" and "[temp]" in str(inputs.get("image")))
        if missing or wrong:
            words = "Required input is missing" if missing else "Invalid image file: " + str(inputs["image"])
            found[number] = {"errors": [{"type": "x", "message": words, "details": ",".join(missing)}],
                             "dependent_outputs": [], "class_type": kind}
    return found


def prompt(handler, value):
    world, graph = handler.world, value["prompt"]
    wrong = errors_of(world, graph)
    if wrong:
        return handler.send_json({"error": {"type": "prompt_outputs_failed_validation",
                                            "message": "Prompt outputs failed validation", "details": ""},
                                  "node_errors": wrong}, 400)
    number = value.get("prompt_id") or str(uuid.uuid4())
    if handler.fault == "old_server":
        number = str(uuid.uuid4())
    job = {"status": "queued", "graph": graph, "client": value.get("client_id")}
    world.jobs[number] = job
    threading.Thread(target=work, args=(handler, number, job), daemon=True).start()
    errors = {}
    if handler.fault == "node_errors":
        output = next(key for key, node in graph.items() if node["class_type"] in OUTPUTS)
        errors = {output: {"errors": [{"type": "x", "message": "bad \x1b[31mvalue", "details": "seed"}],
                           "dependent_outputs": [output], "class_type": "PreviewImage"}}
    return handler.send_json({"prompt_id": number, "number": 1, "node_errors": errors})


def work(handler, number, job):
    world = handler.world
    with world.drawing:
        if job["status"] != "queued":
            return
        job["status"] = "running"
        world.interrupted = False
        end = time.monotonic() + world.draw_s
        while time.monotonic() < end and not world.interrupted:
            time.sleep(.005)
        if world.interrupted:
            job["status"] = "interrupted"
            return
        graph = Graph(world, job["graph"])
        job["files"] = {}
        if world.most_side and any(pictures.decode_png(world.uploads[node["inputs"]["image"]]).width
                                   > world.most_side
                                   for node in job["graph"].values() if node["class_type"] == "LoadImage"):
            job["status"] = "memory"
            return
        for key, node in job["graph"].items():
            if node["class_type"] in OUTPUTS:
                job["files"][key] = graph.value(node["inputs"]["images"])
        job["status"] = "done"


def history(handler, method, place, value):
    world = handler.world
    if method == "POST":
        for number in value.get("delete", []):
            world.jobs.pop(number, None)
        return handler.send_json({})
    number = place[1]
    job, fault = world.jobs.get(number), handler.fault
    if fault == "job_lost":
        world.jobs.pop(number, None)
        job = None
    short = fault == "execution_memory" or (job is not None and job["status"] == "memory")
    if fault == "execution_error" or short:
        words = "CUDA out of memory" if short else "bad \x1b[31mthing"
        return handler.send_json({number: {"outputs": {}, "status": {
            "status_str": "error", "completed": False, "messages": [["execution_start", {}], [
                "execution_error", {"node_id": "3", "node_type": "KSampler", "exception_message": words,
                                    "exception_type": "RuntimeError"}]]}}})
    if job is None or job["status"] in ("queued", "running", "cancelled"):
        return handler.send_json({})
    if job["status"] == "interrupted" or fault == "interrupted":
        return handler.send_json({number: {"outputs": {}, "status": {
            "status_str": "error", "completed": False, "messages": [["execution_interrupted", {}]]}}})
    outputs = {}
    for key in job["files"]:
        name = '../we"ird #1.png' if fault == "evil_name" else f"{number}_{key}.png"
        world.uploads["view " + name] = job["files"][key]
        outputs[key] = {"images": [{"filename": name, "subfolder": "a b" if fault == "evil_name" else "",
                                    "type": "temp"}] * (2 if fault == "two_images" else 1)}
    if fault == "no_outputs":
        outputs = {}
    status = None if fault == "null_status" else {"status_str": "success", "completed": True, "messages": []}
    return handler.send_json({number: {"outputs": outputs, "status": status}})


def queue(handler, method, value):
    world = handler.world
    if method == "POST":
        for number in value.get("delete", []):
            job = world.jobs.get(number)
            if job and job["status"] == "queued":
                job["status"] = "cancelled"
        return handler.send_json({})
    waiting = [[1, number, {}] for number, job in world.jobs.items() if job["status"] == "queued"]
    running = [[1, number, {}] for number, job in world.jobs.items() if job["status"] == "running"]
    return handler.send_json({"queue_running": running, "queue_pending": waiting})


def view(handler, query):
    picture = handler.world.uploads.get("view " + query.get("filename", ""))
    if picture is None or query.get("type") != "temp":
        return handler.send_bytes(b"", "text/plain", 404)
    return handler.send_bytes(pictures.FILES.get(handler.fault, pictures.encode_png)(picture), "image/png")
