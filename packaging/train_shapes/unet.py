"""Network for new objects (engine/neural/diffusion/unet.cpp), with the parameter names of diffusers.

The names are those of UNet2DConditionModel. Tensors are [B,C,h,w] and [B,tokens,C]; norms sum in fp32 whatever the type.
"""
import math

import torch
import torch.nn as nn
import torch.nn.functional as F

GROUPS = 16
CAMERA_FEATURES = 6
INPAINT_CHANNELS = 6   # may change, is shown, four latents of what was there
OUTLINE_SCALE = 4      # pixels of an outline along a latent cell


class GroupNorm(nn.GroupNorm):
    def forward(self, x):
        with torch.autocast(x.device.type, enabled=False):
            return F.group_norm(x, self.num_groups, self.weight.to(x.dtype), self.bias.to(x.dtype), self.eps)


class LayerNorm(nn.LayerNorm):
    def forward(self, x):
        with torch.autocast(x.device.type, enabled=False):
            return F.layer_norm(x, self.normalized_shape, self.weight.to(x.dtype), self.bias.to(x.dtype), self.eps)


class Resnet(nn.Module):
    def __init__(self, inner, outer, time):
        super().__init__()
        self.norm1 = GroupNorm(GROUPS, inner, 1e-5)
        self.conv1 = nn.Conv2d(inner, outer, 3, padding=1)
        self.time_emb_proj = nn.Linear(time, outer)
        self.norm2 = GroupNorm(GROUPS, outer, 1e-5)
        self.conv2 = nn.Conv2d(outer, outer, 3, padding=1)
        self.conv_shortcut = nn.Conv2d(inner, outer, 1) if inner != outer else None

    def forward(self, x, time):
        h = self.conv1(F.silu(self.norm1(x))) + self.time_emb_proj(time)[:, :, None, None]
        h = self.conv2(F.silu(self.norm2(h)))
        return h + (x if self.conv_shortcut is None else self.conv_shortcut(x))


class Attention(nn.Module):
    def __init__(self, width, context, heads):
        super().__init__()
        self.heads = heads
        self.to_q = nn.Linear(width, width, bias=False)
        self.to_k = nn.Linear(context, width, bias=False)
        self.to_v = nn.Linear(context, width, bias=False)
        self.to_out = nn.ModuleList([nn.Linear(width, width)])

    def forward(self, x, context):
        split = lambda y: y.view(y.shape[0], y.shape[1], self.heads, -1).transpose(1, 2)
        q, k, v = split(self.to_q(x)), split(self.to_k(context)), split(self.to_v(context))
        if hasattr(F, "scaled_dot_product_attention"):
            mixed = F.scaled_dot_product_attention(q, k, v)
        else:   # torch below 2.0
            mixed = (q @ k.transpose(-1, -2) / math.sqrt(q.shape[-1])).softmax(-1) @ v
        return self.to_out[0](mixed.transpose(1, 2).reshape(x.shape))


class Gate(nn.Module):
    def __init__(self, width):
        super().__init__()
        self.proj = nn.Linear(width, 8 * width)


class FeedForward(nn.Module):
    def __init__(self, width):
        super().__init__()
        self.net = nn.ModuleList([Gate(width), nn.Identity(), nn.Linear(4 * width, width)])

    def forward(self, x):
        values, gate = self.net[0].proj(x).chunk(2, -1)
        return self.net[2](values * F.gelu(gate))


class Block(nn.Module):
    def __init__(self, width, context, heads):
        super().__init__()
        self.norm1, self.attn1 = LayerNorm(width), Attention(width, width, heads)
        self.norm2, self.attn2 = LayerNorm(width), Attention(width, context, heads)
        self.norm3, self.ff = LayerNorm(width), FeedForward(width)

    def forward(self, x, context, together):
        normed = self.norm1(x)
        if together > 1:   # the tokens of all views of a scene
            normed = normed.reshape(x.shape[0] // together, -1, x.shape[2])
        x = x + self.attn1(normed, normed).reshape(x.shape)
        x = x + self.attn2(self.norm2(x), context)
        return x + self.ff(self.norm3(x))


class SpatialTransformer(nn.Module):
    def __init__(self, width, context, heads):
        super().__init__()
        self.norm = GroupNorm(GROUPS, width, 1e-6)
        self.proj_in = nn.Conv2d(width, width, 1)
        self.transformer_blocks = nn.ModuleList([Block(width, context, heads)])
        self.proj_out = nn.Conv2d(width, width, 1)

    def forward(self, x, context, together):
        batch, width, height, side = x.shape
        tokens = self.proj_in(self.norm(x)).permute(0, 2, 3, 1).reshape(batch, height * side, width)
        tokens = self.transformer_blocks[0](tokens, context, together)
        return x + self.proj_out(tokens.reshape(batch, height, side, width).permute(0, 3, 1, 2))


class Resample(nn.Module):
    def __init__(self, width, stride):
        super().__init__()
        self.conv = nn.Conv2d(width, width, 3, stride=stride, padding=1)


class Level(nn.Module):
    """One resolution: resnets, each with a transformer behind it where there are any, and the step to the next."""

    def __init__(self, resnets, attentions, down=None, up=None):
        super().__init__()
        self.resnets = nn.ModuleList(resnets)
        if attentions:
            self.attentions = nn.ModuleList(attentions)
        if down is not None:
            self.downsamplers = nn.ModuleList([down])
        if up is not None:
            self.upsamplers = nn.ModuleList([up])

    def layer(self, j, x, time, context, together):
        x = self.resnets[j](x, time)
        return self.attentions[j](x, context, together) if hasattr(self, "attentions") else x


def two_layers(inner, outer):
    return nn.ModuleDict({"linear_1": nn.Linear(inner, outer), "linear_2": nn.Linear(outer, outer)})


class UNet(nn.Module):
    """`config` is that of diffusers; its first two levels have cross-attention in the starter."""

    def __init__(self, config):
        super().__init__()
        widths, heads, context = config["block_out_channels"], config["attention_head_dim"], config["cross_attention_dim"]
        layers, first, levels = config["layers_per_block"], widths[0], len(widths)
        time = 4 * first
        crosses = ["CrossAttn" in kind for kind in config["down_block_types"]]
        self.first = first
        self.conv_in = nn.Conv2d(4, first, 3, padding=1)
        self.time_embedding = two_layers(first, time)
        self.camera_embedding = two_layers(CAMERA_FEATURES, time)
        self.conv_inpaint = nn.Conv2d(INPAINT_CHANNELS, first, 3, padding=1)
        transformers = lambda i, count: [SpatialTransformer(widths[i], context, heads[i]) for _ in range(count)] if crosses[i] else []
        skips, down = [first], []
        for i, width in enumerate(widths):
            resnets = []
            for _ in range(layers):
                resnets.append(Resnet(skips[-1], width, time))
                skips.append(width)
            last = i + 1 == levels
            down.append(Level(resnets, transformers(i, layers), down=None if last else Resample(width, 2)))
            if not last:
                skips.append(width)
        self.down_blocks = nn.ModuleList(down)
        middle = widths[-1]
        self.mid_block = Level([Resnet(middle, middle, time), Resnet(middle, middle, time)], [SpatialTransformer(middle, context, heads[-1])])
        up, width = [], middle
        for i in reversed(range(levels)):
            resnets = []
            for _ in range(layers + 1):
                resnets.append(Resnet(width + skips.pop(), widths[i], time))
                width = widths[i]
            up.append(Level(resnets, transformers(i, layers + 1), up=Resample(width, 1) if i > 0 else None))
        self.up_blocks = nn.ModuleList(up)
        self.conv_norm_out = GroupNorm(GROUPS, first, 1e-5)
        self.conv_out = nn.Conv2d(first, 4, 3, padding=1)
        self.outline = nn.ModuleDict({"conv_1": nn.Conv2d(first, first, 3, padding=1), "conv_2": nn.Conv2d(first, OUTLINE_SCALE**2, 3, padding=1)})

    def embedding(self, timesteps, cameras):
        half = self.first // 2
        frequency = torch.exp(torch.arange(half, device=timesteps.device, dtype=torch.float32) * (-math.log(10000.0) / half))
        angle = timesteps.float()[:, None] * frequency
        both = lambda net, value: net["linear_2"](F.silu(net["linear_1"](value)))
        return F.silu(both(self.time_embedding, torch.cat([angle.cos(), angle.sin()], 1)) + both(self.camera_embedding, cameras))

    def forward(self, latents, timesteps, context, together, cameras, inpaint):
        """The velocity [B,4,h,w] and the logits of what is new [B,1,4h,4w], both fp32."""
        time = self.embedding(timesteps, cameras)
        seen = lambda x: together if x.shape[2] < latents.shape[2] else 1   # maps of the latents' own size stay apart
        x = self.conv_in(latents) + self.conv_inpaint(inpaint)
        skips = [x]
        for level in self.down_blocks:
            for j in range(len(level.resnets)):
                x = level.layer(j, x, time, context, seen(x))
                skips.append(x)
            if hasattr(level, "downsamplers"):
                x = level.downsamplers[0].conv(x)
                skips.append(x)
        x = self.mid_block.layer(0, x, time, context, seen(x))
        x = self.mid_block.resnets[1](x, time)
        for level in self.up_blocks:
            for j in range(len(level.resnets)):
                x = level.layer(j, torch.cat([x, skips.pop()], 1), time, context, seen(x))
            if hasattr(level, "upsamplers"):
                x = level.upsamplers[0].conv(F.interpolate(x, size=skips[-1].shape[2:], mode="nearest"))
        x = F.silu(self.conv_norm_out(x))
        outline = self.outline["conv_2"](F.silu(self.outline["conv_1"](x)))
        return self.conv_out(x).float(), F.pixel_shuffle(outline.float(), OUTLINE_SCALE)
