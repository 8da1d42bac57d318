"""Pictures in the GPU's memory, and batches of them.

Views of one scene are denoised together (MVDream, Shi et al. 2023), some of them clean. Most groups are shown
the scene as it was before the edit, as inpainting models are (Rombach et al. 2022)."""
import math
import os
import queue
import threading
import time

import numpy as np
import torch
import torch.nn.functional as F

VIEWS = 8          # of a scene, in the files
TOGETHER = 8       # of a scene that are denoised together
CELLS, SIDE = 16, 64
WORDINGS, TOKENS = 4, 32
TIMESTEPS = 1000
LEAST_COVER = 13   # of 255: less is the soft rim of a splat
LARGEST_MARGIN = 5


def read_shard(path):
    """Arrays of a file of `gseditpro-lab train-starter --pictures-only`.

    The layout is that of engine/laboratory/training/picture_shards.h."""
    raw = np.fromfile(path, np.uint8)
    magic, n, side, cells, wordings, words = (int(value) for value in raw[:24].view(np.int32))
    if magic != 0x32485347 or (side, cells, wordings, words) != (SIDE, CELLS, WORDINGS, TOKENS - 2):
        raise SystemExit(f"{path} is not a file of training pictures of this version")
    arrays, at = {}, 24
    for name, shape in (("after", (n, side, side, 3)), ("before", (n, side, side, 3)), ("cover", (n, 3, cells, cells)), ("room", (n, cells, cells)),
                        ("outline", (n, side, side)), ("words", (n, wordings, 2, words)), ("restyled", (n,))):
        size = math.prod(shape)
        arrays[name] = raw[at:at + size].reshape(shape)
        at += size
    arrays["camera"] = raw[at:at + 8 * n].view(np.float32).reshape(n, 2)
    at += 8 * n
    arrays["share"] = raw[at:at + 4 * n * wordings].view(np.float32).reshape(n, wordings)
    arrays["front"] = raw[at + 4 * n * wordings:].view(np.float32)
    return arrays


class ShardReader:
    """Reads files in their order as they come to be."""

    def __init__(self, folder, consume=False):
        self.ready = queue.Queue(4)
        threading.Thread(target=self.run, args=(folder, consume), daemon=True).start()

    def run(self, folder, consume):
        index = 0
        while True:
            path = f"{folder}/shard-{index}.bin"
            if os.path.exists(path):
                self.ready.put(read_shard(path))
                index += 1
                if consume:
                    os.remove(path)
            else:
                time.sleep(0.2)


class Pictures:
    """Everything a batch is made of; pictures as latents, scaled."""

    def __init__(self, capacity, device, encode, tokens, keep_rgb):
        empty = lambda *shape, dtype=torch.uint8: torch.empty(shape, dtype=dtype, device=device)
        self.count, self.capacity, self.device, self.encode = 0, capacity, device, encode
        self.after, self.before = (empty(capacity, 4, CELLS, CELLS, dtype=torch.float16) for _ in range(2))
        self.cover, self.room, self.outline = empty(capacity, 3, CELLS, CELLS), empty(capacity, CELLS, CELLS), empty(capacity, SIDE, SIDE)
        self.ids, self.restyled = empty(capacity, WORDINGS, 2, TOKENS, dtype=torch.int16), empty(capacity)
        self.share, self.camera = empty(capacity, WORDINGS, dtype=torch.float32), empty(capacity, 6, dtype=torch.float32)
        self.rgb = empty(min(keep_rgb, capacity), SIDE, SIDE, 3)
        self.table, self.bos, self.eos = tokens[0].to(device), tokens[1], tokens[2]

    @torch.no_grad()
    def add(self, arrays):
        n, first = min(len(arrays["after"]), self.capacity - self.count), self.count
        part = {name: torch.from_numpy(array[:n]).to(self.device) for name, array in arrays.items()}
        for name, kept in (("after", self.after), ("before", self.before)):
            for i in range(0, n, 1024):
                pictures = part[name][i:i + 1024].permute(0, 3, 1, 2).float() / 127.5 - 1
                kept[first + i:first + i + len(pictures)] = self.encode(pictures).half()
        rows = slice(first, first + n)
        self.cover[rows], self.room[rows], self.outline[rows], self.share[rows] = part["cover"], part["room"], part["outline"], part["share"]
        self.restyled[rows] = part["restyled"]
        azimuth, elevation = part["camera"].unbind(1)
        self.camera[rows] = torch.stack([azimuth.sin(), azimuth.cos(), (2 * azimuth).sin(), (2 * azimuth).cos(), elevation.sin(),
                                         torch.ones_like(azimuth)], 1)   # camera_features()
        words = self.table[part["words"].long()]
        ends = [torch.full_like(words[..., :1], token) for token in (self.bos, self.eos)]
        self.ids[rows] = torch.cat([ends[0], words, ends[1]], -1).to(torch.int16)
        kept = max(0, min(n, len(self.rgb) - first))
        self.rgb[first:first + kept] = part["after"][:kept]
        self.count += n


def ellipse(x0, y0, rx, ry, grid):
    """[B,G,G], 1 where the middle of a cell lies inside."""
    x, y = grid
    wide = lambda value: value[:, None, None]
    return (((x + 0.5 - wide(x0)) / wide(rx)) ** 2 + ((y + 0.5 - wide(y0)) / wide(ry)) ** 2 <= 1).float()


def random_regions(new, draw, grid):
    """Regions around what is new [B,G,G], as add_region() draws them: boxes, ellipses, grown outlines; anywhere where it is hidden."""
    batch, ar, wide = len(new), torch.arange(CELLS, device=new.device).float(), lambda value: value[:, None, None]
    x, y = grid
    columns, rows = new.amax(1) > 0, new.amax(2) > 0
    left, right = torch.where(columns, ar, 99.0).amin(1), torch.where(columns, ar, -1.0).amax(1)
    top, bottom = torch.where(rows, ar, 99.0).amin(1), torch.where(rows, ar, -1.0).amax(1)
    margin = draw.integers(1, LARGEST_MARGIN + 1, batch, 5).float()
    box = ((x >= wide(left - margin[:, 0])) & (x <= wide(right + margin[:, 1])) & (y >= wide(top - margin[:, 2])) & (y <= wide(bottom + margin[:, 3]))).float()
    radius = lambda low, high, m: ((high + 1 - low) / math.sqrt(2) + m - 0.5).clamp(min=0.1)
    round_ = ellipse((left + right + 1) / 2, (top + bottom + 1) / 2, radius(left, right, margin[:, 0]), radius(top, bottom, margin[:, 1]), grid)
    grown = torch.stack([F.max_pool2d(new[:, None], 2 * r + 1, 1, r)[:, 0] for r in range(1, LARGEST_MARGIN + 1)])
    outline = grown[margin[:, 4].long() - 1, torch.arange(batch, device=new.device)]
    kind = wide(draw.uniform(batch))
    region = torch.where(kind < 0.5, torch.maximum(grown[0], box), torch.where(kind < 0.75, torch.maximum(grown[0], round_), outline))
    r = draw.uniform(batch, low=-3, high=3)
    hidden = ellipse(draw.uniform(batch, high=CELLS), draw.uniform(batch, high=CELLS), r.clamp(min=1e-3), r.clamp(min=1e-3), grid) * (wide(r) > 0)
    return torch.where(wide(~columns.any(1)), hidden, region)


class Draw:
    def __init__(self, device, seed):
        self.device, self.generator = device, torch.Generator(device)
        self.generator.manual_seed(seed)

    def uniform(self, *shape, low=0.0, high=1.0):
        return torch.rand(*shape, device=self.device, generator=self.generator) * (high - low) + low

    def integers(self, low, high, *shape):
        return torch.randint(low, high, shape, device=self.device, generator=self.generator)

    def normal(self, shape):
        return torch.randn(shape, device=self.device, generator=self.generator)


NOTHING, SCENE, PLACE, AROUND, BACKGROUND = range(5)   # InpaintTask
RESTYLE = 5   # all of the scene is shown; a part of it, the place of which is known, gets another look
PARTS = 3     # Pictures.restyled of something new is larger


def new_cells(pictures, chosen, worn):
    """[B,G,G]: how much of each cell what is new covers, 0..255."""
    restyled = pictures.restyled[chosen].long()
    part = torch.where(restyled < PARTS, restyled, torch.where(worn, 2, 1))
    return pictures.cover[chosen, part]


def loose_outline(new, draw):
    """[B,G,G] grown by up to two cells, as masks of labels are."""
    grown = torch.stack([F.max_pool2d(new[:, None], 2 * r + 1, 1, r)[:, 0] for r in range(3)])
    return grown[draw.integers(0, 3, len(new)), torch.arange(len(new), device=new.device)]


def may_change(pictures, chosen, together, draw):
    """Task of each picture [B], where it may change and what is shown of it [B,1,G,G]."""
    batch, groups, wide = len(chosen), len(chosen) // together, lambda value: value[:, None, None]
    room = (pictures.room[chosen] > 0).float()
    restyled = pictures.restyled[chosen].view(groups, together)[:, 0] < PARTS
    worn = (pictures.cover[chosen, 2].flatten(1).amax(1) > 0).view(groups, together).any(1)
    nothing, other = draw.uniform(groups) < torch.where(restyled, 0.1, 0.2), draw.uniform(groups) < 0.45
    task = torch.where(worn, torch.where(other, PLACE, SCENE), torch.where(other, BACKGROUND, AROUND))
    task = torch.where(nothing, NOTHING, torch.where(restyled, RESTYLE, task)).repeat_interleave(together)
    new = (new_cells(pictures, chosen, worn.repeat_interleave(together)) >= LEAST_COVER).float()
    in_room = (task != SCENE) & (task != RESTYLE) & (room.flatten(1).amax(1) > 0) & ((task == PLACE) | (draw.uniform(batch) < 0.8))
    ar = torch.arange(CELLS, device=pictures.device).float()
    y, x = torch.meshgrid(ar, ar, indexing="ij")
    grid = (x[None], y[None])
    loose = (task == RESTYLE) & (draw.uniform(batch) < 0.85)
    mask = torch.where(wide(in_room), room, torch.where(wide(loose), loose_outline(new, draw), random_regions(new, draw, grid)))
    r = draw.uniform(batch, low=-4, high=4)
    hole = ellipse(draw.uniform(batch, high=CELLS), draw.uniform(batch, low=0.3 * CELLS, high=CELLS), r.clamp(min=1e-3), (r / 2).clamp(min=1e-3), grid)
    hole = hole * (wide(r) > 0)
    shown = torch.where(wide(task == AROUND), 1 - mask, torch.where(wide(task == BACKGROUND), 1 - hole * mask, torch.ones_like(mask)))
    none = wide(task == NOTHING)
    return task, torch.where(none, torch.ones_like(mask), mask)[:, None], torch.where(none, torch.zeros_like(shown), shown)[:, None]


def timesteps_of(groups, together, draw):
    """More often a high one, where shapes are decided; half of them near those of an edit's four steps. Some views of a quarter of the groups
    are clean, as views that are drawn already are."""
    t = (TIMESTEPS * draw.uniform(groups).sqrt()).long().clamp(max=TIMESTEPS - 1)
    steps = draw.integers(1, 5, groups) * (TIMESTEPS // 4) - 1 - draw.integers(0, 10, groups)
    t = torch.where(draw.uniform(groups) < 0.5, steps, t)[:, None].expand(groups, together)
    clean = torch.where(draw.uniform(groups) < 0.25, (1 + draw.integers(0, 2, groups)) * max(1, together // 4), 0)
    is_clean = torch.arange(together, device=draw.device)[None] < clean[:, None]
    return torch.where(is_clean, draw.integers(0, 20, groups, together), t).flatten()


def make_batch(pictures, groups, together, scenes, draw):
    """`groups` scenes of the range `scenes`, `together` views of each."""
    batch = groups * together
    scene = draw.integers(*scenes, groups)
    chosen = (scene[:, None] * VIEWS + draw.uniform(groups, VIEWS).argsort(1)[:, :together]).flatten()
    timesteps = timesteps_of(groups, together, draw)
    known = (draw.uniform(groups) >= 0.1).float().repeat_interleave(together)[:, None]
    said = (draw.uniform(groups) >= 0.1).repeat_interleave(together)
    wording = draw.integers(0, WORDINGS, groups).repeat_interleave(together)
    ids, share = pictures.ids[chosen, wording].long(), pictures.share[chosen, wording]
    ids = torch.where(said[:, None, None], ids, torch.full_like(ids, pictures.eos))
    task, mask, shown = may_change(pictures, chosen, together, draw)
    before = pictures.before[chosen].float()
    latents = torch.where(mask > 0, pictures.after[chosen].float(), before)
    cover = pictures.cover[chosen].float() / 255
    restyled = pictures.restyled[chosen].long()
    changes = cover[torch.arange(batch, device=cover.device), restyled.clamp(max=PARTS - 1)]
    counts = torch.where((restyled < PARTS)[:, None, None], 1.5 * changes, cover[:, 1] + 2 * cover[:, 2])
    weights = F.max_pool2d(counts[:, None], 3, 1, 1) + 0.1 + 0.3 * mask
    tells = (task != NOTHING).float()[:, None, None, None]
    return {
        "ids": torch.cat([ids[:, 0], ids[:, 1]]), "share": torch.where(said, share, torch.zeros_like(share)).view(batch, 1, 1),
        "latents": latents, "noise": draw.normal(latents.shape), "timesteps": timesteps,
        "weights": weights / weights.mean((1, 2, 3), keepdim=True), "cameras": pictures.camera[chosen] * known,
        "inpaint": torch.cat([mask, shown, shown * before], 1), "outline": pictures.outline[chosen][:, None].float() / 255,
        "outlined": F.interpolate(mask * tells, size=(SIDE, SIDE), mode="nearest"),
    }
