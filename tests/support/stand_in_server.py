#!/usr/bin/env python3
"""Image server for tests: speaks all four protocols, draws a pure function of what it is sent, and fails on
request.

    stand_in_server.py [--flavour sdserver] [--host 127.0.0.1] [--port 0] [--certificate FILE]

The first line of output names the port. GET /gse/set?NAME=VALUE sets knobs (see World), /gse/reset?NAME=VALUE
forgets everything first, /gse/log tells what was asked. Faults count requests of the kind `at`: draw, poll,
upload, view, progress, probe.
"""
import argparse
import base64
import hashlib
import json
import re
import socket
import ssl
import sys
import threading
import time
import urllib.parse
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import stand_in_comfy
import stand_in_faults as faults
import stand_in_pictures as pictures

WEBUI = {"sdserver", "a1111", "forge", "sdnext", "kcpp", "lookalike"}
OPENAI = {"sdserver", "vllm", "openai", "local"}
TASKS = {"a1111", "forge"}


class World:
    """Knobs, jobs and log of one server."""

    def __init__(self, flavour):
        self.first_flavour = flavour
        self.lock = threading.Lock()        # of the fields
        self.drawing = threading.Lock()     # one drawing at a time, first in first out
        self.reset()

    def reset(self):
        self.flavour = self.first_flavour
        self.fault, self.at, self.after, self.times = "", "draw", 0, -1
        self.rate, self.target, self.status, self.words, self.retry_after = 20, "", 0, "", ""
        self.draw_s, self.noise, self.drift = 0.0, 0, 0
        self.previews = 0    # 1: the picture in the making is shown, coarsely
        self.preview = None  # of what is drawn now
        self.unread = 0      # 1: bodies of drawings are not read
        self.most_side = 0   # px that its memory does for; 0 = any
        self.edits = ""   # "red": what is red is edited where no mask says what
        self.no_loras = 0    # 1: a WebUI has no list of LoRAs
        self.old_features = 0   # 1: sd-server tells its features as older builds do, and takes no references
        self.password, self.model, self.prefix = "", "stand-in", ""
        self.queue_limit, self.new_comfy = 64, 0
        self.jobs, self.log, self.uploads, self.tasks = {}, [], {}, {}
        self.next_job, self.interrupted = 1, False

    def set(self, name, value):
        old = getattr(self, name)
        setattr(self, name, type(old)(value))

    def fault_for(self, kind):
        """The fault that this request shall have; empty for none."""
        with self.lock:
            if not self.fault or self.at != kind:
                return ""
            if self.after > 0:
                self.after -= 1
                return ""
            if self.times == 0:
                return ""
            self.times -= 1
            return self.fault


def kind_of(method, path):
    if method == "POST" and path in ("/sdapi/v1/img2img", "/v1/images/edits", "/sdcpp/v1/img_gen", "/prompt"):
        return "draw"
    if path.startswith(("/upload/", "/view")):
        return path.split("/")[1]
    if path.startswith(("/sdcpp/v1/jobs/", "/history", "/queue")) and method == "GET":
        return "poll"
    if path in ("/sdapi/v1/progress", "/internal/progress"):
        return "progress"
    return "probe"


def short(value):
    """A request's value for the log: pictures are named by size, channels and digest."""
    if isinstance(value, dict):
        return {key: short(part) for key, part in value.items()}
    if isinstance(value, list):
        return [short(part) for part in value]
    if isinstance(value, str) and len(value) > 60:
        picture = decoded(value)
        if picture is not None:
            return described(picture)
    return value


def described(picture):
    luma = picture.luma()
    alpha = picture.alpha()
    return {"picture": [picture.width, picture.height, picture.channels],
            "digest": hashlib.sha256(picture.data).hexdigest()[:16], "white": sum(v > 127 for v in luma),
            "clear": None if alpha is None else sum(v < 128 for v in alpha)}


def decoded(text):
    """Picture in base64; None when it cannot be read."""
    if not isinstance(text, str):
        return None
    text = text.partition(",")[2] if text.startswith("data:") else text
    try:
        return pictures.decode_png(base64.b64decode(text, validate=True))
    except ValueError:
        return None


def mask_of(picture):
    """White is where to change; rounded at one half."""
    return None if picture is None else [255 if value > 127 else 0 for value in picture.luma()]


class Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True

    def log_message(self, *words):
        pass

    @property
    def world(self):
        return self.server.world

    def send_json(self, value, status=200, *more):
        self.send_bytes(json.dumps(value).encode(), "application/json", status, *more)

    def send_bytes(self, body, kind, status=200, *more):
        try:
            self.send_response(status)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(body)))
            for name, value in more:
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(body)
            if self.fault == "close_after":
                self.close_connection = True
        except OSError:
            self.close_connection = True

    def read_body(self):
        length = int(self.headers.get("Content-Length") or 0)
        return self.rfile.read(length) if length else b""

    def do_GET(self):
        self.handle_request("GET", b"")

    def do_POST(self):
        if self.world.unread and kind_of("POST", self.path) == "draw":
            return faults.hang(self)
        try:
            self.handle_request("POST", self.read_body())
        except OSError:
            self.close_connection = True

    def handle_request(self, method, body):
        url = urllib.parse.urlsplit(self.path)
        path, query = url.path, dict(urllib.parse.parse_qsl(url.query))
        if path.startswith("/gse/"):
            return self.control(path, query)
        if self.world.prefix:
            if not path.startswith(self.world.prefix + "/"):
                return self.send_json({"detail": "Not Found"}, 404)
            path = path[len(self.world.prefix):]
        self.note(method, path, query, body)
        self.fault = self.world.fault_for(kind_of(method, path))
        if self.fault in faults.TRANSPORT:
            return faults.TRANSPORT[self.fault](self)
        if not self.allowed():
            return self.send_json({"detail": "Incorrect username or password"}, 401,
                                  ("WWW-Authenticate", "Basic"))
        return self.route(method, path, query, body)

    fault = ""

    def allowed(self):
        kind, _, secret = self.world.password.partition(" ")
        if not kind:
            return True
        wanted = "Bearer " + secret
        if kind == "basic":
            wanted = "Basic " + base64.b64encode(secret.encode()).decode()
        return self.headers.get("Authorization") == wanted

    def note(self, method, path, query, body):
        entry = {"method": method, "path": path, "query": query, "host": self.headers.get("Host"),
                 "secret": (self.headers.get("Authorization") or "").split(" ")[0],
                 "headers": sorted(name.lower() for name in self.headers), "json": None, "fields": []}
        kind = self.headers.get("Content-Type") or ""
        if kind.startswith("application/json"):
            try:
                entry["json"] = short(json.loads(body))
            except ValueError:
                entry["json"] = "broken"
        elif kind.startswith("multipart/"):
            self.parts = read_parts(kind, body)
            for name, file_name, content in self.parts:
                picture = pictures.decode_png(content)
                entry["fields"].append([name, file_name, described(picture) if picture else
                                        content.decode("utf-8", "replace")])
        with self.world.lock:
            self.world.log.append(entry)

    parts = []

    def control(self, path, query):
        if path == "/gse/set":
            for name, value in query.items():
                self.world.set(name, value)
        elif path == "/gse/reset":
            self.world.reset()
            for name, value in query.items():
                self.world.set(name, value)
        elif path == "/gse/log":
            with self.world.lock:
                return self.send_json(self.world.log)
        return self.send_json({})

    def route(self, method, path, query, body):
        flavour = self.world.flavour
        value = {}
        if body and (self.headers.get("Content-Type") or "").startswith("application/json"):
            try:
                value = json.loads(body)
            except ValueError:
                return self.send_json({"error": "server_error", "message": "broken JSON"}, 500)
        if flavour == "comfy":
            return stand_in_comfy.route(self, method, path, query, value)
        if flavour == "sdserver" and path.startswith("/sdcpp/v1/"):
            return self.sdcpp(method, path, value)
        if flavour == "kcpp" and path == "/api/extra/version":
            return self.send_json({"result": "KoboldCpp", "version": "1.102"})
        if flavour == "invoke" and path == "/api/v1/app/version":
            return self.send_json({"version": "6.0"})
        if flavour in WEBUI and path.startswith(("/sdapi/v1/", "/internal/")):
            return self.webui(method, path, query, value)
        if flavour in OPENAI and path.startswith("/v1/"):
            return self.openai(method, path)
        return self.send_json({"detail": "Not Found"}, 404)

    # Drawing. Waits its turn, as all servers do.

    def drawn(self, picture, mask, prompt, seed, task=None):
        """Bytes of the answer's file; None when it was interrupted."""
        world = self.world
        with world.drawing:
            if task is not None:
                world.tasks[task] = "active"
            world.interrupted = False
            end = time.monotonic() + world.draw_s
            exact = world.flavour in ("a1111", "forge", "sdnext")
            made = pictures.draw(picture, mask, prompt, seed, world.noise, world.drift, exact, world.edits)
            if world.previews:
                world.preview = pictures.coarse(made)
                end = time.monotonic() + world.draw_s   # it is to be seen so long
            while time.monotonic() < end and not world.interrupted:
                time.sleep(.005)
            world.preview = None
            if task is not None:
                world.tasks[task] = "completed"
        make = pictures.FILES.get(self.fault, pictures.encode_png)
        return make(made)

    def b64(self, data):
        return faults.text_of(data, self.fault)

    def preview_text(self):
        """Picture in the making; None where nothing is drawn, or previews are off."""
        preview = self.world.preview
        if preview is None:
            return None
        return self.b64(pictures.FILES.get(self.fault, pictures.encode_png)(preview))

    # A: WebUI

    def webui(self, method, path, query, value):
        flavour, place = self.world.flavour, path.rpartition("/")[2]
        if method == "POST" and place == "img2img":
            return self.img2img(value)
        if path == "/internal/progress" and flavour in TASKS:
            state = self.world.tasks.get(value.get("id_task"), "")
            answer = {"active": state == "active", "queued": state == "queued",
                      "completed": state == "completed", "progress": .5, "live_preview": None}
            preview = self.preview_text() if state == "active" and value.get("live_preview") else None
            if preview and value.get("id_live_preview") != 1:
                answer.update(live_preview="data:image/png;base64," + preview, id_live_preview=1)
            return self.send_json(answer)
        if place == "interrupt" and flavour != "sdserver":
            self.world.interrupted = True
            return self.send_json({}, 204 if flavour == "sdnext" else 200)
        if place == "progress" and flavour not in ("sdserver", "kcpp"):
            preview = self.preview_text() if query.get("skip_current_image") == "false" else None
            return self.send_json({"progress": .25, "eta_relative": 1, "state": {"sampling_step": 5},
                                   "current_image": preview})
        if place == "options" and flavour != "sdserver":
            if method == "POST":
                self.world.model = value["sd_model_checkpoint"]
            return self.send_json({"sd_model_checkpoint": self.world.model})
        if place == "checkpoint" and flavour == "sdnext":
            self.world.model = query["sd_model_checkpoint"]
            return self.send_json({})
        lists = {"version": (("sdnext",), {"version": "2026"}),
                 "sd-modules": (("forge",), [{"model_name": "vae"}]),
                 "sd-vae": (("a1111",), []),
                 "sd-models": (WEBUI, [{"title": "stand-in"}, {"title": "other"}]),
                 "loras": (WEBUI, [{"name": "bronze", "path": "bronze.safetensors"}])}
        if place == "loras" and self.world.no_loras:
            return self.send_json({"detail": "Not Found"}, 404)
        if place in lists and flavour in lists[place][0]:
            return self.send_json(lists[place][1])
        return self.send_json({"detail": "Not Found"}, 404)

    def img2img(self, value):
        flavour = self.world.flavour
        if not value.get("prompt") and flavour == "sdserver":
            return self.send_json({"error": "prompt required"}, 400)
        images = value.get("init_images")
        picture = decoded(images[0]) if isinstance(images, list) and images else None
        if picture is None and flavour in ("a1111", "forge"):
            return self.send_json({"detail": "Init image not found"}, 404)
        width, height = value.get("width", 512), value.get("height", 512)
        mask = mask_of(decoded(value.get("mask")))
        fault = self.fault
        if 0 < self.world.most_side < width:
            return faults.TRANSPORT["out_of_memory"](self)
        if fault.startswith("images_"):
            wrong = {"images_none": [], "images_blank": [""], "images_null": [None], "images_number": 3}
            return self.send_json({"images": wrong.get(fault), "info": ""})
        if picture is None:
            file = pictures.encode_png(pictures.unrelated(width, height, value.get("seed", 0)))
        else:
            if (picture.width, picture.height) != (width, height):
                picture = pictures.resized(picture.colour(), width, height)
            if mask is not None and flavour == "a1111" and value.get("inpaint_full_res", True):
                return self.send_json({"detail": "crops to the mask: not what the client means"}, 500)
            task = value.get("force_task_id") if flavour in TASKS else None
            if task:
                self.world.tasks[task] = "queued"
            file = self.drawn(picture, None if fault == "mask_ignored" else mask, value["prompt"],
                              value.get("seed", -1), task)
        info = "" if flavour == "kcpp" else json.dumps({"seed": value.get("seed"),
                                                        "sd_model_name": self.world.model})
        echoed = [images, value.get("mask")] if flavour == "sdserver" else None
        return self.send_json({"images": [self.b64(file)], "parameters": {"echo": echoed}, "info": info})

    # B: OpenAI

    def openai(self, method, path):
        flavour = self.world.flavour
        if path == "/v1/models":
            owner = {"vllm": "vllm", "openai": "openai"}.get(flavour, "local")
            return self.send_json({"object": "list", "data": [{"id": self.world.model, "owned_by": owner}]})
        if method != "POST" or path != "/v1/images/edits":
            return self.send_json({"error": {"message": "no such place"}}, 404)
        fields = {}
        for name, _, content in self.parts:
            fields.setdefault(name, []).append(content)
        images = [pictures.decode_png(data) for data in fields.get("image[]", []) + fields.get("image", [])]
        text = {name: values[0].decode("utf-8", "replace") for name, values in fields.items()}
        prompt, seed = text.get("prompt", ""), int(text.get("seed", 0))
        if not prompt:
            return self.send_json({"error": {"message": "prompt is required", "code": None}}, 400)
        if flavour == "vllm" and not vllm_has(text.get("lora")):
            return self.send_json({"detail": "LoRA adapter is not registered"}, 400)
        mask = None
        if flavour == "vllm" and "mask_image" in fields:
            mask = mask_of(pictures.decode_png(fields["mask_image"][0]))
        elif "mask" in fields and flavour != "vllm":
            shape = pictures.decode_png(fields["mask"][0])
            if flavour == "openai":
                if shape is None or shape.alpha() is None:
                    return self.send_json({"error": {"message": "mask needs alpha"}}, 400)
                mask = [255 - value for value in shape.alpha()]
            else:
                mask = mask_of(shape)
        extra = re.search(r"<sd_cpp_extra_args>(.*?)</sd_cpp_extra_args>", prompt)
        if flavour == "sdserver" and extra:
            values = json.loads(extra.group(1))
            seed, prompt = values.get("seed", seed), prompt.replace(extra.group(0), "")
        if images and images[0] is not None and 0 < self.world.most_side < images[0].width:
            return faults.TRANSPORT["out_of_memory"](self)
        if not images or images[0] is None:
            file = pictures.encode_png(pictures.unrelated(64, 64, seed))
        else:
            file = self.drawn(images[0], mask, prompt, seed)
        data = {"images_none": [], "images_blank": [{"b64_json": ""}], "images_null": [None],
                "images_number": 3,
                "images_url": [{"url": "http://127.0.0.1:1/picture.png"}]}.get(self.fault,
                                                                             [{"b64_json": self.b64(file)}])
        return self.send_json({"created": 1, "data": data, "output_format": "png"})

    # C: sd-server's jobs

    def sdcpp(self, method, path, value):
        world = self.world
        if path == "/sdcpp/v1/capabilities":
            features = {"ref_images": not world.old_features, "mask_image": True, "cancel_queued": True,
                        "cancel_generating": False}
            told = {"features": features} if world.old_features else \
                {"features_by_mode": {"img_gen": features}}
            return self.send_json({
                "model": {"name": world.model, "stem": world.model, "path": "/models/x"},
                "samplers": ["euler", "euler_a"], "schedulers": ["discrete", "karras"],
                "loras": [{"name": "bronze", "path": "bronze.safetensors"}],
                "limits": {"max_queue_size": world.queue_limit}, **told})
        if method == "POST" and path == "/sdcpp/v1/img_gen":
            return self.submit(value)
        parts = path.split("/")
        if len(parts) < 5 or parts[3] != "jobs":
            return self.send_json({"error": "no such place"}, 404)
        job = world.jobs.get(parts[4])
        if job is None or self.fault == "job_lost":
            if self.fault == "job_lost":
                world.jobs.pop(parts[4], None)
            return self.send_json({"error": "job not found"}, 404)
        if self.fault == "job_expired":
            return self.send_json({"error": "job expired"}, 410)
        if method == "POST" and parts[-1] == "cancel":
            if job["status"] == "generating":
                return self.send_json({"error": "job is running"}, 409)
            if job["status"] == "queued":
                job["status"] = "cancelled"
        return self.send_json(self.job_answer(job))

    def job_answer(self, job):
        fault = self.fault
        answer = {key: job[key] for key in ("id", "kind", "status", "created")}
        answer["queue_position"] = 3 if job["status"] == "queued" else 0
        short = fault == "failed_memory" or job["status"] == "memory"
        if fault == "failed" or short:
            words = "CUDA error: out of memory" if short else "model \x1b[31mbroke\n<b>"
            return {**answer, "status": "failed", "error": {"code": "x", "message": words}}
        if fault == "cancelled":
            return {**answer, "status": "cancelled"}
        if fault == "unknown_status":
            return {**answer, "status": "pondering"}
        if job["status"] == "completed":
            images = [{"index": 0, "b64_json": self.b64(job["file"](self.fault))}]
            answer["result"] = {"output_format": "png", "images": images}
            if fault.startswith("images_"):
                wrong = {"images_none": [], "images_blank": [{"b64_json": ""}], "images_null": [None]}
                answer["result"]["images"] = wrong.get(fault)
        return answer

    def submit(self, value):
        world = self.world
        if not isinstance(value, dict):
            return self.send_json({"error": "server_error"}, 500)
        if not 0 <= value.get("strength", .75) <= 1:
            return self.send_json({"error": "strength must be in [0,1]"}, 400)
        init = value.get("init_image")
        picture = decoded(init) if init else None
        if init and (picture is None or picture.channels < 3 or "\n" in init):
            return self.send_json({"error": "invalid init_image"}, 400)
        with world.lock:
            waiting = sum(job["status"] in ("queued", "generating") for job in world.jobs.values())
            if waiting >= world.queue_limit:
                return self.send_json({"error": "job queue is full"}, 429)
            number = f"job-{world.next_job}"
            world.next_job += 1
            job = {"id": number, "kind": "img_gen", "status": "queued", "created": int(time.time())}
            world.jobs[number] = job
            first = dict(job)
        threading.Thread(target=self.work, args=(job, picture, value), daemon=True).start()
        target = "http://127.0.0.1:1" if self.fault == "poll_elsewhere" else ""
        return self.send_json({**first, "poll_url": f"{target}/sdcpp/v1/jobs/{number}"}, 202)

    def work(self, job, picture, value):
        world = self.world
        with world.drawing:
            if job["status"] != "queued":
                return
            job["status"] = "generating"
            time.sleep(world.draw_s)
            if 0 < world.most_side < value.get("width", 512):
                job["status"] = "memory"
                return
            seed = value.get("seed", 0)
            mask = mask_of(decoded(value.get("mask_image")))
            if picture is None:
                made = pictures.unrelated(value.get("width", 512), value.get("height", 512), seed)
            else:
                made = pictures.draw(picture, mask, value.get("prompt", ""), seed, world.noise, world.drift,
                                     edits=world.edits)
            job["file"] = lambda fault: pictures.FILES.get(fault, pictures.encode_png)(made)
            job["status"] = "completed"


def vllm_has(lora):
    """False for a LoRA field that vLLM-Omni refuses: a name that it was not started with, or no name."""
    try:
        listed = json.loads(lora or "[]")
    except ValueError:
        return False
    listed = listed if isinstance(listed, list) else [listed]
    known = [one for one in listed if isinstance(one, dict) and isinstance(one.get("scale"), (int, float))
             and (one.get("name") == "bronze" or one.get("name") and one.get("local_path"))]
    return len(known) == len(listed)


def read_parts(kind, body):
    """(name, file name, content) of a multipart body."""
    boundary = re.search(r'boundary="?([^";]+)', kind).group(1).encode()
    found = []
    for part in body.split(b"--" + boundary)[1:-1]:
        head, _, content = part.partition(b"\r\n\r\n")
        head = head.decode("utf-8", "replace")
        name = re.search(r'[ ;]name="([^"]*)"', head)
        file_name = re.search(r'filename="([^"]*)"', head)
        found.append((name.group(1) if name else "", file_name.group(1) if file_name else "", content[:-2]))
    return found


class Server(ThreadingHTTPServer):
    daemon_threads = True
    request_queue_size = 64

    def handle_error(self, request, client_address):
        """Clients that hang up are no news."""
        if not isinstance(sys.exc_info()[1], OSError):
            super().handle_error(request, client_address)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--flavour", default="sdserver")
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--certificate", help="file of a certificate with its key: speaks TLS")
    options = parser.parse_args()
    Server.address_family = socket.AF_INET6 if ":" in options.host else socket.AF_INET
    server = Server((options.host, options.port), Handler)
    if options.certificate:
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(options.certificate)
        server.socket = context.wrap_socket(server.socket, server_side=True)
    server.world = World(options.flavour)
    print(f"port {server.server_address[1]}", flush=True)
    server.serve_forever(poll_interval=.05)


if __name__ == "__main__":
    main()
