"""Trains the network for new objects on a GPU, in minutes (assets/models/starter/TRAINING.md).

`gseditpro-lab train-starter --pictures-only` draws the pictures, also while this runs. Needs PyTorch; without
a GPU it is slow, and good for --check only."""
import argparse
import json
import math
import os
import shutil
import time

import torch
import torch.nn.functional as F

import weights
import words
from frozen import TextEncoder, Vae
from pictures import TIMESTEPS, TOGETHER, VIEWS, Draw, Pictures, ShardReader, make_batch
from unet import UNet

OUTLINE_WEIGHT = 0.3
HELD_OUT = 128   # scenes, the first ones
START = time.time()


def say(*words):
    print(f"[{time.time() - START:7.1f} s]", *words, flush=True)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    add = parser.add_argument
    add("--model", default="assets/models/starter", help="starter folder to begin from")
    add("--pictures", default=".training/pictures",
        help="folder of gseditpro-lab train-starter --pictures-only")
    add("--out", required=True, help="starter folder to write")
    add("--seconds", type=float, default=430, help="of training")
    add("--decoder-seconds", type=float, default=0, help="of training the VAE's decoder first")
    add("--groups", type=int, default=64, help="scenes of a batch")
    add("--lr", type=float, default=5e-4)
    add("--layers", type=int, default=2, help="per block; one more than the model has begins as the identity")
    add("--capacity", type=int, default=600000, help="most pictures that are kept")
    add("--start", type=int, default=81920, help="pictures to wait for")
    add("--consume", action="store_true", help="remove every file of pictures once it is read: drawing and training may go on on a small disk")
    add("--save-every", type=float, default=0, help="seconds between two writings of what there is so far; 0 = only at the end")
    add("--words-only", action="store_true", help="the network stays as it is: only the embeddings of new words are learned, those in --words")
    add("--words", default="", help="of the new words only these; empty = all")
    add("--check", action="store_true", help="only say the loss of what the model has")
    return parser.parse_args()


def alphas_cumprod():
    """Stable Diffusion's schedule: scaled_linear."""
    betas = torch.linspace(0.00085**0.5, 0.012**0.5, TIMESTEPS, dtype=torch.float64) ** 2
    return torch.cumprod(1 - betas, 0).float()


class Trainer:
    def __init__(self, options):
        self.options, self.cuda = options, torch.cuda.is_available()
        self.device = torch.device("cuda" if self.cuda else "cpu")
        torch.manual_seed(151)
        model = options.model
        config = json.load(open(f"{model}/vae/config.json"))
        self.vae = Vae(config).to(self.device)
        self.vae.load_state_dict(weights.load(f"{model}/vae/diffusion_pytorch_model.safetensors"))
        heads = json.load(open(f"{model}/text_encoder/config.json"))["num_attention_heads"]
        self.tokenizer = words.Tokenizer(model, json.load(open(f"{options.pictures}/vocabulary.json")), options.words.split())
        self.text_weights = self.tokenizer.extended(weights.load(f"{model}/text_encoder/model.safetensors"))
        self.text = TextEncoder(self.text_weights, heads, self.tokenizer.fresh).to(self.device)
        self.scale = config["scaling_factor"]
        self.config, known = weights.initial(model)
        grows = options.layers > self.config["layers_per_block"]
        self.config["layers_per_block"] = options.layers
        self.unet = UNet(self.config)
        self.unet.load_state_dict(weights.deepened(known, self.unet) if grows else known)
        self.unet.to(self.device)
        self.alphas = alphas_cumprod().to(self.device)
        self.draw = Draw(self.device, 7)
        self.reader = ShardReader(options.pictures, options.consume)
        self.pictures = Pictures(options.capacity, self.device, self.encode, self.tokens(), 100000 if options.decoder_seconds > 0 else 0)
        while self.pictures.count < min(options.start, options.capacity):
            self.pictures.add(self.reader.ready.get())
        say(f"{len(self.tokenizer.new_words)} new words, {self.tokenizer.fresh} new tokens")
        say(f"{sum(p.numel() for p in self.unet.parameters()) / 1e6:.2f} M parameters, {self.pictures.count} pictures")

    def tokens(self):
        ids = self.tokenizer.ids
        table = torch.full((256,), ids["<|endoftext|>"])
        for i, word in enumerate(self.tokenizer.words):
            table[i] = ids.get(word + "</w>", ids["<|endoftext|>"])
        return table, ids["<|startoftext|>"], ids["<|endoftext|>"]

    def encode(self, pictures):
        with torch.autocast(self.device.type, torch.float16 if self.cuda else torch.bfloat16, enabled=self.cuda):
            return self.vae.encode(pictures).float() * self.scale

    def mixed(self):
        return torch.autocast(self.device.type, torch.bfloat16, enabled=self.cuda, cache_enabled=False)

    def loss(self, batch, together):
        """Velocity prediction (Salimans and Ho 2022) and the outlines' cross-entropy."""
        alpha = self.alphas[batch["timesteps"]].view(-1, 1, 1, 1)
        signal, sigma = alpha.sqrt(), (1 - alpha).sqrt()
        noisy = signal * batch["latents"] + sigma * batch["noise"]
        velocity = signal * batch["noise"] - sigma * batch["latents"]
        with self.mixed():
            sentence, other = self.text(batch["ids"]).chunk(2)
            context = torch.lerp(sentence, other, batch["share"])
            predicted, outline = self.unet(noisy, batch["timesteps"], context, together, batch["cameras"], batch["inpaint"])
        squared = (predicted - velocity).square()
        counts = batch["outlined"] * alpha
        outlined = (F.binary_cross_entropy_with_logits(outline, batch["outline"], reduction="none") * counts).sum() / counts.sum().clamp(min=1)
        loss = (squared * batch["weights"]).mean()
        return loss + OUTLINE_WEIGHT * outlined, torch.stack([loss.detach(), squared.mean().detach(), outlined.detach()]).float()

    @torch.no_grad()
    def held_out(self):
        draw, batches = Draw(self.device, 99), 16 if self.cuda else 2
        parts = [self.loss(make_batch(self.pictures, 32 if self.cuda else 8, 4, (0, HELD_OUT), draw), 4)[1] for _ in range(batches)]
        return " ".join(f"{value:.4f}" for value in torch.stack(parts).mean(0))

    def batch(self):
        return make_batch(self.pictures, self.options.groups, TOGETHER, (HELD_OUT, self.pictures.count // VIEWS), self.draw)

    def prepare(self):
        for parameter in self.unet.parameters():
            parameter.requires_grad_(not self.options.words_only)
        self.parameters = [] if self.options.words_only else list(self.unet.parameters())
        if self.tokenizer.fresh:
            self.parameters.append(self.text.fresh)
        self.averaged = [p.detach().clone() for p in self.parameters]
        self.rate, self.decay = torch.zeros((), device=self.device), torch.zeros((), device=self.device)
        self.logged = torch.zeros(3, device=self.device)
        kinds = {"fused": True, "capturable": True} if self.cuda else {}
        self.optimizer = torch.optim.AdamW(self.parameters, lr=self.rate if self.cuda else self.options.lr, betas=(0.9, 0.98), weight_decay=0, **kinds)

    def step(self, batch):
        loss, parts = self.loss(batch, TOGETHER)
        loss.backward()
        if self.cuda:   # without a copy to the host
            gradients = [p.grad for p in self.parameters]
            norm = torch.stack(torch._foreach_norm(gradients)).norm()
            torch._foreach_mul_(gradients, torch.clamp(1 / (norm + 1e-6), max=1.0))
        else:
            torch.nn.utils.clip_grad_norm_(self.parameters, 1.0)
        self.optimizer.step()
        with torch.no_grad():
            change = torch._foreach_sub(self.parameters, self.averaged)
            torch._foreach_mul_(change, self.decay)
            torch._foreach_add_(self.averaged, change)
            self.logged.lerp_(parts, 0.02)
        self.optimizer.zero_grad(set_to_none=not self.cuda)

    def captured(self):
        """The step as a CUDA graph: the kernels are small."""
        static, side = self.batch(), torch.cuda.Stream()
        side.wait_stream(torch.cuda.current_stream())
        with torch.cuda.stream(side):
            for _ in range(3):
                self.step(static)
        torch.cuda.current_stream().wait_stream(side)
        graph = torch.cuda.CUDAGraph()
        with torch.cuda.graph(graph, capture_error_mode="thread_local"):
            self.step(static)

        def run(batch):
            for name, tensor in batch.items():
                static[name].copy_(tensor)
            graph.replay()
        return run

    def run(self):
        self.prepare()
        step_on = self.captured() if self.cuda else self.step
        begin, step, seconds, saved = time.time(), 0, self.options.seconds, 0
        log = open(f"{self.options.out}/log/shapes.tsv", "w")
        log.write("step\tseconds\tlearning_rate\tpictures\tloss\tdiffusion\toutline\n")
        while time.time() - begin < seconds:
            rate = self.options.lr * min(1, (step + 1) / (10 if self.options.words_only else 300)) * 0.5 * (1 + math.cos(math.pi * (time.time() - begin) / seconds))
            self.rate.fill_(rate)
            self.decay.fill_(max(1 / (step + 2), 0.02 if self.options.words_only else 0.0006))
            if not self.cuda:
                self.optimizer.param_groups[0]["lr"] = rate
            step_on(self.batch())
            step += 1
            if step % 48 == 0 and not self.reader.ready.empty() and self.pictures.count < self.pictures.capacity:
                self.pictures.add(self.reader.ready.get())
            if self.cuda and step % 16 == 0:
                torch.cuda.synchronize()   # the clock is the GPU's
            if step % (100 if self.cuda else 1) == 0:
                seen = step * self.options.groups * TOGETHER
                log.write(f"{step}\t{time.time() - begin:.1f}\t{rate:.3g}\t{seen}\t" + "\t".join(f"{v:.4g}" for v in self.logged.tolist()) + "\n")
            if step % (500 if self.cuda else 5) == 0:
                say(f"step {step}, {seen / (time.time() - begin):.0f} pictures/s of {self.pictures.count}, loss, diffusion, outline:",
                    " ".join(f"{v:.4f}" for v in self.logged.tolist()))
            if self.options.save_every > 0 and time.time() - begin > (saved + 1) * self.options.save_every:
                saved, current = saved + 1, [p.detach().clone() for p in self.parameters]
                log.flush()
                self.set_weights(self.averaged)
                say(f"{step} steps, averaged weights on held-out scenes: {self.held_out()}")
                self.write()
                self.set_weights(current)
        self.set_weights(self.averaged)
        say(f"{step} steps, averaged weights on held-out scenes: {self.held_out()}")

    @torch.no_grad()
    def set_weights(self, values):
        for parameter, value in zip(self.parameters, values):
            parameter.copy_(value)

    def train_decoder(self):
        """L1 + 2 MSE + half of the gradients' L1 as for the whole VAE; what is new counts three times, and latents are off by a little, as
        those of a UNet are."""
        parameters = [p for name, p in self.vae.named_parameters() if name.startswith(("decoder.", "post_quant_conv."))]
        averaged, seconds = [p.detach().clone() for p in parameters], self.options.decoder_seconds
        optimizer = torch.optim.AdamW(parameters, lr=1e-3, betas=(0.9, 0.98), weight_decay=0)
        say(f"decoder: {self.psnr():.2f} dB")
        begin, step = time.time(), 0
        while time.time() - begin < seconds:
            optimizer.param_groups[0]["lr"] = 1e-3 * min(1, step / 50 + 0.02) * 0.5 * (1 + math.cos(math.pi * (time.time() - begin) / seconds))
            rows = self.draw.integers(HELD_OUT * VIEWS, min(self.pictures.count, len(self.pictures.rgb)), 8 * self.options.groups)
            wanted = self.pictures.rgb[rows].permute(0, 3, 1, 2).float() / 127.5 - 1
            latents = self.pictures.after[rows].float() / self.scale
            with torch.autocast(self.device.type, torch.bfloat16, enabled=self.cuda):
                error = self.vae.decode(latents + 0.05 * torch.randn_like(latents)).float() - wanted
            weight = 1 + 2 * F.max_pool2d((self.pictures.outline[rows] >= 13)[:, None].float(), 5, 1, 2)
            edges = (error[..., 1:] - error[..., :-1]).abs().mean() + (error[..., 1:, :] - error[..., :-1, :]).abs().mean()
            loss = (error.abs() * weight).mean() + 2 * (error.square() * weight).mean() + 0.5 * edges
            optimizer.zero_grad(set_to_none=True)
            loss.backward()
            torch.nn.utils.clip_grad_norm_(parameters, 1.0)
            optimizer.step()
            step += 1
            with torch.no_grad():
                for mean, parameter in zip(averaged, parameters):
                    mean.lerp_(parameter, max(0.002, 1 / (step + 1)))
        with torch.no_grad():
            for parameter, mean in zip(parameters, averaged):
                parameter.copy_(mean)
        say(f"decoder: {self.psnr():.2f} dB after {step} steps")

    @torch.no_grad()
    def psnr(self):
        rows = torch.arange(512, device=self.device)
        wanted = self.pictures.rgb[rows].permute(0, 3, 1, 2).float() / 127.5 - 1
        error = self.vae.decode(self.pictures.after[rows].float() / self.scale).clamp(-1, 1) - wanted
        return -10 * math.log10(error.square().mean().item() / 4)

    def write(self):
        """The model with a network of its own for new things in place of a LoRA."""
        out, facts = self.options.out, json.load(open(f"{self.options.model}/gseditpro.json"))
        self.tokenizer.write(out, facts, self.text_weights, self.text.fresh.detach().cpu() * self.text.SPEED)
        if self.options.words_only:
            json.dump(facts, open(f"{out}/gseditpro.json", "w"), indent=2)
            return
        os.makedirs(f"{out}/shapes", exist_ok=True)
        weights.save(f"{out}/shapes/diffusion_pytorch_model.safetensors", weights.quantized(self.unet.state_dict()))
        json.dump(self.config, open(f"{out}/shapes/config.json", "w"), indent=2)
        weights.save(f"{out}/vae/diffusion_pytorch_model.safetensors", {name: tensor.half() for name, tensor in self.vae.state_dict().items()})
        for path in (facts.pop(key) for key in ("shape_lora", "shape_cameras") if key in facts):
            if os.path.exists(f"{out}/{path}"):
                os.remove(f"{out}/{path}")
        facts.update(shape_unet="shapes", shape_views=TOGETHER, shape_training={name: value for name, value in vars(self.options).items() if name != "check"})
        json.dump(facts, open(f"{out}/gseditpro.json", "w"), indent=2)


def main():
    options = arguments()
    trainer = Trainer(options)
    say(f"loss, diffusion, outline on held-out scenes: {trainer.held_out()}")
    if options.check:
        return
    shutil.copytree(options.model, options.out, dirs_exist_ok=True)
    if options.decoder_seconds > 0:
        trainer.train_decoder()
    trainer.run()
    trainer.write()


if __name__ == "__main__":
    main()
