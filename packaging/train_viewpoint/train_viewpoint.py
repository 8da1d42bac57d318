#!/usr/bin/env python3
"""Trains the classifier of viewpoints (engine/neural/clip/viewpoint_model.h), on a processor or a GPU.

Its pictures are drawn by `gseditpro-lab train-starter --pictures-only`. It is written into a starter model's
folder. Needs PyTorch and NumPy."""
import argparse
import glob
import json
import math
import os
import sys
import time

import numpy as np
import torch
import torch.nn as nn
import torch.nn.functional as F

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "train_shapes"))
import weights  # noqa: E402
from pictures import VIEWS, read_shard  # noqa: E402

SECTORS, WIDTHS, HIDDEN, GROUPS, SIDE = 24, (24, 48, 96, 128), 160, 8, 64
CONCENTRATION = 25     # of the wanted shares about the true azimuth: 11 degrees
HELD_OUT = 512         # scenes, the first ones
BEFORE = 0.6           # of the pictures in which something is worn: shown without it, as scenes are before an edit
DROPOUT, NOISE, GAIN = 0.1, 0.06, 0.3


class Block(nn.Module):
    def __init__(self, width):
        super().__init__()
        self.norm1, self.conv1 = nn.GroupNorm(GROUPS, width), nn.Conv2d(width, width, 3, padding=1)
        self.norm2, self.conv2 = nn.GroupNorm(GROUPS, width), nn.Conv2d(width, width, 3, padding=1)

    def forward(self, x):
        return x + self.conv2(F.silu(self.norm2(self.conv1(F.silu(self.norm1(x))))))


class Viewpoint(nn.Module):
    def __init__(self):
        super().__init__()
        before = 3
        for level, width in enumerate(WIDTHS):
            self.add_module(f"down{level}", nn.Conv2d(before, width, 3, stride=2, padding=1))
            self.add_module(f"block{level}", Block(width))
            before = width
        self.norm = nn.GroupNorm(GROUPS, before)
        self.hidden = nn.Linear(before * (SIDE >> len(WIDTHS)) ** 2, HIDDEN)
        self.out = nn.Linear(HIDDEN, SECTORS)

    def forward(self, x):
        for level in range(len(WIDTHS)):
            x = getattr(self, f"block{level}")(getattr(self, f"down{level}")(x))
        x = F.silu(self.norm(x)).flatten(1)
        return self.out(F.silu(self.hidden(F.dropout(x, DROPOUT, self.training)))).log_softmax(1)


class Pictures:
    """All in memory; batches of them, with the azimuths at which they are seen from their things' fronts."""

    def __init__(self, folder, device):
        shards = [read_shard(path) for path in sorted(glob.glob(f"{folder}/shard-*.bin"))]
        if not shards:
            raise SystemExit(f"{folder} has no training pictures: draw them with "
                             "gseditpro-lab train-starter --pictures-only")
        joined = lambda name: np.concatenate([shard[name] for shard in shards])
        self.after, self.before, self.device = joined("after"), joined("before"), device
        fronts = joined("front")
        if len(fronts) != len(self.after):
            raise SystemExit(f"{folder} has training pictures that do not tell the fronts of their things: draw them anew")
        self.azimuth = joined("camera")[:, 0] - fronts
        known = json.load(open(f"{folder}/vocabulary.json"))
        worn = [known.index(word) for word in ("hat", "crown", "sunglasses", "glasses", "scarf", "flames", "fire", "wings") if word in known]
        words = joined("words")
        self.wears = np.isin(words[:, :, 0].reshape(len(words), -1), worn).any(1)   # where nothing is, the thing itself is gone before
        self.random = np.random.default_rng(0)

    def tensors(self, rows, before):
        pictures = np.where(before[:, None, None, None], self.before[rows], self.after[rows])
        return (torch.from_numpy(pictures).to(self.device).permute(0, 3, 1, 2).float() / 127.5 - 1,
                torch.from_numpy(self.azimuth[rows]).float().to(self.device))

    def batch(self, size):
        rows = self.random.integers(HELD_OUT * VIEWS, len(self.after), size)
        x, azimuth = self.tensors(rows, self.wears[rows] & (self.random.random(size) < BEFORE))
        mirrored = torch.from_numpy(self.random.random(size) < 0.5).to(self.device)
        x = torch.where(mirrored[:, None, None, None], x.flip(-1), x)
        gain = torch.from_numpy(self.random.uniform(1 - GAIN, 1 + GAIN, (size, 3, 1, 1))).float().to(self.device)
        x = ((x + 1) * gain - 1).clamp(-1, 1)
        return x + NOISE * self.random.random() * torch.randn_like(x), torch.where(mirrored, -azimuth, azimuth)


def wanted_shares(azimuth):
    middles = torch.arange(SECTORS, device=azimuth.device) * (2 * math.pi / SECTORS)
    shares = torch.exp((torch.cos(azimuth[:, None] - middles) - 1) * CONCENTRATION)
    return shares / shares.sum(1, keepdim=True)


def loss_of(model, x, azimuth):
    return -(wanted_shares(azimuth) * model(x)).sum(1).mean()


@torch.no_grad()
def held_out(model, pictures):
    """Cross-entropy of a picture, and the median error in degrees of a scene's front as read from its views."""
    model.eval()
    rows = np.arange(HELD_OUT * VIEWS)
    losses, shares = [], []
    for part in np.array_split(rows, HELD_OUT // 16):
        x, azimuth = pictures.tensors(part, pictures.wears[part])
        shares.append(model(x).clamp(min=math.log(1e-3)).cpu().numpy())
        losses.append(loss_of(model, x, azimuth).item())
    model.train()
    shares, azimuth = np.concatenate(shares), pictures.azimuth[rows]
    fronts = 2 * math.pi * np.arange(72) / 72
    at = ((azimuth[:, None] - fronts) / (2 * math.pi) * SECTORS) % SECTORS
    first, share = at.astype(int) % SECTORS, at - np.floor(at)
    fit = (1 - share) * shares[rows[:, None], first] + share * shares[rows[:, None], (first + 1) % SECTORS]
    read = fronts[fit.reshape(HELD_OUT, VIEWS, 72).mean(1).argmax(1)]
    off = np.abs((read + math.pi) % (2 * math.pi) - math.pi) * 180 / math.pi
    return f"loss {np.mean(losses):.4f}, fronts off by {np.median(off):.0f} degrees (median; a tenth by more than {np.percentile(off, 90):.0f})"


def train(model, pictures, options):
    averaged = {name: value.detach().clone() for name, value in model.state_dict().items()}
    optimizer = torch.optim.AdamW(model.parameters(), lr=options.lr, weight_decay=0.01)
    begin, step = time.time(), 0
    while time.time() - begin < options.minutes * 60:
        done = (time.time() - begin) / (options.minutes * 60)
        optimizer.param_groups[0]["lr"] = options.lr * min(1, (step + 1) / 200) * 0.5 * (1 + math.cos(math.pi * done))
        loss = loss_of(model, *pictures.batch(options.batch))
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        optimizer.step()
        step += 1
        with torch.no_grad():
            for name, value in model.state_dict().items():
                averaged[name].lerp_(value, max(1 / (step + 1), 0.003))
        if step % 500 == 0:
            print(f"step {step}, {time.time() - begin:.0f} s, loss {loss.item():.3f}; held-out scenes: {held_out(model, pictures)}", flush=True)
    model.load_state_dict(averaged)
    print(f"{step} steps of {options.batch} pictures, averaged weights on held-out scenes: {held_out(model, pictures)}", flush=True)


def write(model, options):
    folder = f"{options.model}/viewpoint"
    os.makedirs(folder, exist_ok=True)
    weights.save(f"{folder}/model.safetensors", {name: value.half() for name, value in model.state_dict().items()})
    config = {"image_size": SIDE, "sectors": SECTORS, "widths": list(WIDTHS), "hidden": HIDDEN, "groups": GROUPS,
              "training": {"minutes": options.minutes, "batch": options.batch, "lr": options.lr}}
    json.dump(config, open(f"{folder}/config.json", "w"), indent=2)
    facts = json.load(open(f"{options.model}/gseditpro.json"))
    facts["viewpoint"] = "viewpoint"
    json.dump(facts, open(f"{options.model}/gseditpro.json", "w"), indent=2)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--model", required=True, help="folder of a starter model; its classifier, if it has one, is trained on")
    parser.add_argument("--pictures", required=True, help="folder of the training pictures")
    parser.add_argument("--minutes", type=float, default=45)
    parser.add_argument("--batch", type=int, default=64)
    parser.add_argument("--lr", type=float, default=1e-3, help="peak; cosine to zero")
    parser.add_argument("--anew", action="store_true", help="begin with random weights")
    parser.add_argument("--check", action="store_true", help="train nothing: say how good the model's classifier is")
    options = parser.parse_args()
    device = "cuda" if torch.cuda.is_available() else "cpu"
    torch.manual_seed(0)
    model, known = Viewpoint().to(device), f"{options.model}/viewpoint/model.safetensors"
    if os.path.exists(known) and not options.anew:
        model.load_state_dict(weights.load(known))
    pictures = Pictures(options.pictures, device)
    print(f"{len(pictures.after)} pictures; held-out scenes before: {held_out(model, pictures)}", flush=True)
    if options.check:
        return
    train(model, pictures, options)
    write(model, options)


if __name__ == "__main__":
    main()
