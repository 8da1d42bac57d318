"""Weights on disk and what a run begins with."""
import json
import struct

import torch

TYPES = {"F16": torch.float16, "F32": torch.float32, "BF16": torch.bfloat16, "I8": torch.int8}


def load(path):
    """The tensors of a safetensors file; those in eight bits as the numbers they stand for."""
    with open(path, "rb") as file:
        raw = file.read()
    length = struct.unpack("<Q", raw[:8])[0]
    tensors = {}
    for name, entry in json.loads(raw[8:8 + length]).items():
        if name != "__metadata__":
            begin, end = (8 + length + offset for offset in entry["data_offsets"])
            tensors[name] = torch.frombuffer(bytearray(raw[begin:end]), dtype=TYPES[entry["dtype"]]).reshape(entry["shape"])
    for name in [name for name in tensors if tensors[name].dtype == torch.int8]:
        values, scale = tensors[name], tensors.pop(name + "_scale")
        tensors[name] = (values.float().flatten(1) * scale[:, None]).view(values.shape)
    return {name: tensor.float() for name, tensor in tensors.items()}


def save(path, tensors):
    names = {value: key for key, value in TYPES.items()}
    header, parts, at = {}, [], 0
    for name, tensor in tensors.items():
        data = tensor.detach().cpu().contiguous().numpy().tobytes()
        header[name] = {"dtype": names[tensor.dtype], "shape": list(tensor.shape), "data_offsets": [at, at + len(data)]}
        at += len(data)
        parts.append(data)
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 8)
    with open(path, "wb") as file:
        file.write(struct.pack("<Q", len(text)) + text + b"".join(parts))


def quantized(tensors):
    """Matrices and kernels in eight bits with one scale per row, the rest in fp16 (neural::quantized())."""
    result = {}
    for name, tensor in tensors.items():
        tensor = tensor.detach().float().cpu()
        if tensor.dim() < 2:
            result[name] = tensor.half()
            continue
        rows = tensor.flatten(1)
        scale = (rows.abs().amax(1) / 127).clamp(min=torch.finfo(torch.float32).tiny)
        result[name] = (rows / scale[:, None]).round().clamp(-127, 127).to(torch.int8).view(tensor.shape)
        result[name + "_scale"] = scale
    return result


def initial(model):
    """Configuration and weights of what a starter folder draws new things with: a network of its own, or its UNet with the LoRA and the
    scene's inputs."""
    facts = json.load(open(f"{model}/gseditpro.json"))
    if "shape_unet" in facts:
        folder = f"{model}/{facts['shape_unet']}"
        return json.load(open(f"{folder}/config.json")), load(f"{folder}/diffusion_pytorch_model.safetensors")
    weights = load(f"{model}/unet/diffusion_pytorch_model.safetensors")
    lora = load(f"{model}/{facts['shape_lora']}")
    names = {"lora_unet_" + name[: -len(".weight")].replace(".", "_"): name for name in weights if name.endswith(".weight")}
    for layer in {name.split(".")[0] for name in lora}:
        down, up = lora[layer + ".lora_down.weight"], lora[layer + ".lora_up.weight"]
        change = float(lora[layer + ".alpha"]) / down.shape[0] * (up.flatten(1) @ down.flatten(1))
        weights[names[layer]] = weights[names[layer]] + change.reshape(weights[names[layer]].shape)
    weights.update(load(f"{model}/{facts['shape_cameras']}"))
    return json.load(open(f"{model}/unet/config.json")), weights


def deepened(small, network):
    """Weights for `network`, which has two layers per block, with which it computes what one with a single layer and the weights `small` does:
    the new layers begin as the identity (Net2DeeperNet, Chen et al. 2016). On the way up the first layer takes the skip of the new one on the
    way down, which is the old one's; the last takes the one that the old second layer took."""
    weights, taken = {name: tensor.clone() for name, tensor in network.state_dict().items()}, set()

    def take(prefix, old):
        for name in small:
            if name.startswith(old):
                weights[prefix + name[len(old):]] = small[name]
                taken.add(prefix + name[len(old):])

    for name in small:
        if not name.startswith(("down_blocks.", "up_blocks.")):
            take(name, name)
    for i in range(len(network.down_blocks)):
        down, up = f"down_blocks.{i}.", f"up_blocks.{i}."
        take(down + "downsamplers.", down + "downsamplers.")
        take(up + "upsamplers.", up + "upsamplers.")
        for part in ("resnets", "attentions"):
            take(f"{down}{part}.0.", f"{down}{part}.0.")
            take(f"{up}{part}.0.", f"{up}{part}.0.")
            take(f"{up}{part}.2.", f"{up}{part}.1.")
    for name, weight in weights.items():
        if name in taken:
            continue
        if ".conv2." in name or ".proj_out." in name or ".conv_shortcut." in name:
            weight.zero_()
        if ".conv_shortcut.weight" in name:
            weight[range(len(weight)), range(len(weight))] = 1
    return weights
