"""Words that only what draws new things learns: tokens behind those of the model, so that every sentence without them stays what it is."""
import json

import torch

import weights


# Known words whose mean a new word begins from.
BEGINNINGS = {
    "pink": "red white", "brown": "wooden black", "gray": "stone", "grey": "stone", "turquoise": "blue green", "silver": "golden white",
    "bronze": "golden orange", "marble": "stone white", "brick": "red stone", "striped": "white purple", "spotted": "white purple",
    "checkered": "black white", "rainbow": "yellow purple green", "rusty": "orange stone", "lava": "black orange", "mossy": "green stone",
    "leaves": "sand orange", "mud": "sand wood", "gravel": "stone sand", "ice": "snow water",
}


def pieces(word, ranks):
    """Byte-pair encoding of an ASCII word (Sennrich et al. 2016, as CLIP's tokenizer has it)."""
    parts = list(word[:-1]) + [word[-1] + "</w>"]
    while len(parts) > 1:
        rank, i = min((ranks.get(pair, len(ranks)), i) for i, pair in enumerate(zip(parts, parts[1:])))
        if rank == len(ranks):
            break
        parts[i:i + 2] = [parts[i] + parts[i + 1]]
    return parts


# The program dyes what is drawn in these colours, which comes out as well; of patterns the network draws the mean colour, and the program lays them
# over in space.
DYED = ("pink", "brown", "gray", "grey", "turquoise", "marble", "brick", "striped", "spotted", "checkered", "rainbow", "rusty", "lava", "mossy")


class Tokenizer:
    """The tokenizer of a starter folder, in which each of `words` is one token."""

    def __init__(self, model, words, chosen=()):
        """`chosen`: of the words that are new to the model only these become tokens; none = all."""
        self.words = words
        self.ids = json.load(open(f"{model}/tokenizer/vocab.json"))
        self.merges = open(f"{model}/tokenizer/merges.txt").read().splitlines()
        self.size = len(self.ids)
        ranks = {tuple(line.split(" ")): i for i, line in enumerate(self.merges[1:])}
        self.new_words = [word for word in words if word + "</w>" not in self.ids and (not chosen or word in chosen)]
        for word in self.new_words:
            parts = pieces(word, ranks)
            while len(parts) > 1:   # from the front on: what other words' merges leave is merged in its order
                pair = (parts[0], parts[1])
                ranks.setdefault(pair, len(ranks))
                self.ids.setdefault("".join(pair), len(self.ids))
                parts[0:2] = ["".join(pair)]
        self.merges = self.merges[:1] + [" ".join(pair) for pair in sorted(ranks, key=ranks.get)]
        wrong = [word for word in words if len(pieces(word, ranks)) != 1 and (word in self.new_words or word + "</w>" in self.ids)]
        if wrong:
            raise SystemExit(f"these words cannot be made one token each: {', '.join(wrong)}")
        self.fresh = len(self.ids) - self.size

    def extended(self, text):
        """The text encoder's tensors with rows for the new tokens, as its own are spread."""
        name = "text_model.embeddings.token_embedding.weight"
        rows = text[name]
        if len(rows) == len(self.ids):
            return text
        used = rows[rows.std(1) > 0]
        fresh = used.mean(0) + used.std() * torch.randn(self.fresh, rows.shape[1], generator=torch.Generator().manual_seed(17))
        for word in self.new_words:
            like = [rows[self.ids[known + "</w>"]] for known in BEGINNINGS.get(word, "").split()]
            if like:
                fresh[self.ids[word + "</w>"] - self.size] = torch.stack(like).mean(0)
        return {**text, name: torch.cat([rows, fresh])}

    def write(self, out, facts, text, fresh):
        """Tokenizer, text encoder and the list of the new words of the folder `out`."""
        if not self.fresh:
            return
        json.dump(self.ids, open(f"{out}/tokenizer/vocab.json", "w"), ensure_ascii=False, separators=(",", ":"))
        open(f"{out}/tokenizer/merges.txt", "w").write("\n".join(self.merges) + "\n")
        name = "text_model.embeddings.token_embedding.weight"
        text = {**text, name: torch.cat([text[name][: self.size], fresh])}
        weights.save(f"{out}/text_encoder/model.safetensors", {key: tensor.half() for key, tensor in text.items()})
        path = f"{out}/text_encoder/config.json"
        config = json.load(open(path))
        config["vocab_size"] = len(self.ids)
        json.dump(config, open(path, "w"), indent=2)
        known = set(facts["vocabulary"])
        facts["drawn_vocabulary"] = facts.get("drawn_vocabulary", []) + [word for word in self.new_words if word not in known and word not in DYED]
