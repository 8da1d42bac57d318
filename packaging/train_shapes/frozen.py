"""What does not change while new shapes are learned: the text encoder, and the VAE, of which the decoder can be trained by itself."""
import math

import torch
import torch.nn as nn
import torch.nn.functional as F


class TextEncoder(nn.Module):
    """CLIP's text encoder (engine/neural/diffusion/text_encoder.cpp): token ids [B,T] to the last hidden states
    [B,T,D]. Only the embeddings of its last `fresh` tokens are learned."""

    SPEED = 4   # by how much faster than the network

    def __init__(self, weights, heads, fresh=0):
        super().__init__()
        for name, tensor in weights.items():
            self.register_buffer(name.replace(".", "_"), tensor)
        table = self.weight("embeddings.token_embedding.weight")
        self.known = len(table) - fresh
        self.fresh = nn.Parameter(table[self.known:].clone() / self.SPEED)
        self.heads = heads
        self.layers = 1 + max(int(name.split(".")[3]) for name in weights if ".layers." in name)

    def weight(self, name):
        return getattr(self, ("text_model." + name).replace(".", "_"))

    def linear(self, x, name):
        return F.linear(x, self.weight(name + ".weight"), self.weight(name + ".bias"))

    def norm(self, x, name):
        return F.layer_norm(x, (x.shape[-1],), self.weight(name + ".weight"), self.weight(name + ".bias"), 1e-5)

    def forward(self, ids):
        table = torch.cat([self.weight("embeddings.token_embedding.weight")[: self.known], self.fresh * self.SPEED])
        x = F.embedding(ids, table) + self.weight("embeddings.position_embedding.weight")[: ids.shape[1]]
        batch, tokens, width = x.shape
        causal = torch.full((tokens, tokens), float("-inf"), device=x.device).triu(1)
        for i in range(self.layers):
            layer = f"encoder.layers.{i}."
            y = self.norm(x, layer + "layer_norm1")
            q, k, v = (self.linear(y, f"{layer}self_attn.{part}_proj").view(batch, tokens, self.heads, -1).transpose(1, 2) for part in "qkv")
            mixed = (q @ k.transpose(-1, -2) / math.sqrt(q.shape[-1]) + causal).softmax(-1) @ v
            x = x + self.linear(mixed.transpose(1, 2).reshape(batch, tokens, width), layer + "self_attn.out_proj")
            y = self.linear(self.norm(x, layer + "layer_norm2"), layer + "mlp.fc1")
            x = x + self.linear(y * torch.sigmoid(1.702 * y), layer + "mlp.fc2")
        return self.norm(x, "final_layer_norm")


class VaeResnet(nn.Module):
    def __init__(self, inner, outer, groups):
        super().__init__()
        self.norm1, self.conv1 = nn.GroupNorm(groups, inner, 1e-6), nn.Conv2d(inner, outer, 3, padding=1)
        self.norm2, self.conv2 = nn.GroupNorm(groups, outer, 1e-6), nn.Conv2d(outer, outer, 3, padding=1)
        self.conv_shortcut = nn.Conv2d(inner, outer, 1) if inner != outer else None

    def forward(self, x):
        h = self.conv2(F.silu(self.norm2(self.conv1(F.silu(self.norm1(x))))))
        return h + (x if self.conv_shortcut is None else self.conv_shortcut(x))


class VaeAttention(nn.Module):
    def __init__(self, width, groups):
        super().__init__()
        self.group_norm = nn.GroupNorm(groups, width, 1e-6)
        self.to_q, self.to_k, self.to_v = (nn.Linear(width, width) for _ in range(3))
        self.to_out = nn.ModuleList([nn.Linear(width, width)])

    def forward(self, x):
        batch, width, height, side = x.shape
        y = self.group_norm(x).flatten(2).transpose(1, 2)
        mixed = (self.to_q(y) @ self.to_k(y).transpose(1, 2) / math.sqrt(width)).softmax(-1) @ self.to_v(y)
        return x + self.to_out[0](mixed).transpose(1, 2).reshape(batch, width, height, side)


class Middle(nn.Module):
    def __init__(self, width, groups):
        super().__init__()
        self.resnets = nn.ModuleList([VaeResnet(width, width, groups), VaeResnet(width, width, groups)])
        self.attentions = nn.ModuleList([VaeAttention(width, groups)])

    def forward(self, x):
        return self.resnets[1](self.attentions[0](self.resnets[0](x)))


class Step(nn.Module):
    def __init__(self, width, stride):
        super().__init__()
        self.conv = nn.Conv2d(width, width, 3, stride=stride, padding=1 if stride == 1 else 0)


class Half(nn.Module):
    """Encoder or decoder."""

    def __init__(self, widths, groups, layers, ends, stride):
        super().__init__()
        inner, outer = ends
        width = widths[0]
        self.conv_in = nn.Conv2d(inner, width, 3, padding=1)
        blocks = []
        for i, wide in enumerate(widths):
            block = nn.Module()
            block.resnets = nn.ModuleList([VaeResnet(width if j == 0 else wide, wide, groups) for j in range(layers)])
            if i + 1 < len(widths):
                setattr(block, "downsamplers" if stride == 2 else "upsamplers", nn.ModuleList([Step(wide, stride)]))
            blocks.append(block)
            width = wide
        setattr(self, "down_blocks" if stride == 2 else "up_blocks", nn.ModuleList(blocks))
        self.mid_block = Middle(max(widths), groups)
        self.conv_norm_out = nn.GroupNorm(groups, width, 1e-6)
        self.conv_out = nn.Conv2d(width, outer, 3, padding=1)

    def end(self, x):
        return self.conv_out(F.silu(self.conv_norm_out(x)))


class Vae(nn.Module):
    def __init__(self, config):
        super().__init__()
        widths, groups, layers, latent = config["block_out_channels"], config["norm_num_groups"], config["layers_per_block"], config["latent_channels"]
        self.encoder = Half(widths, groups, layers, (3, 2 * latent), 2)
        self.decoder = Half(widths[::-1], groups, layers + 1, (latent, 3), 1)
        self.quant_conv = nn.Conv2d(2 * latent, 2 * latent, 1)
        self.post_quant_conv = nn.Conv2d(latent, latent, 1)

    def encode(self, x):
        """Pictures in [-1,1] to the means of their latents."""
        x = self.encoder.conv_in(x)
        for block in self.encoder.down_blocks:
            for resnet in block.resnets:
                x = resnet(x)
            if hasattr(block, "downsamplers"):
                x = block.downsamplers[0].conv(F.pad(x, (0, 1, 0, 1)))
        return self.quant_conv(self.encoder.end(self.encoder.mid_block(x))).chunk(2, 1)[0]

    def decode(self, z):
        x = self.decoder.mid_block(self.decoder.conv_in(self.post_quant_conv(z)))
        for block in self.decoder.up_blocks:
            for resnet in block.resnets:
                x = resnet(x)
            if hasattr(block, "upsamplers"):
                x = block.upsamplers[0].conv(F.interpolate(x, scale_factor=2, mode="nearest"))
        return self.decoder.end(x)
