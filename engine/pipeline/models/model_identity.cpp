// Digests of files, and the text made of them.
#include "engine/pipeline/models/model_identity.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <vector>

#include "engine/base/content_hash.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/safetensors_header.h"
#include "engine/neural/api/checkpoint.h"
#include "engine/neural/api/lora_spec.h"
#include "engine/pipeline/models/model_words.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/pipeline/models/recipe_model.h"

namespace gse::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t PieceBytes = std::size_t{1} << 20;
// Nothing else of a model is read.
constexpr std::array<std::string_view, 3> ModelEndings{".json", ".txt", ".bin"};

std::string digest_of(const fs::path& path) {
    const InputFile file(path);
    std::vector<std::byte> piece(PieceBytes);
    ContentHash hash;
    for (std::uint64_t at = 0; at < file.size(); at += PieceBytes) {
        const auto bytes = static_cast<std::size_t>(std::min<std::uint64_t>(PieceBytes, file.size() - at));
        file.read(at, std::span(piece).first(bytes));
        hash.bytes(piece.data(), bytes);
    }
    return hash.key().hex();
}

/// The digest, from the cache where size, times and place say that the file is the one it was taken of.
std::string contents_of(const fs::path& path, AnswerCache& cache) {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) return digest_of(path);  // which says what is wrong
    const auto seconds = [](const timespec& time) {
        return fmt::format("{}.{:09}", time.tv_sec, time.tv_nsec);
    };
    const auto question = fmt::format("contents of {}: device {}, file {}, {} bytes, changed {} and {}",
                                      fs::absolute(path).string(), status.st_dev, status.st_ino,
                                      status.st_size, seconds(status.st_mtim), seconds(status.st_ctim));
    if (auto known = cache.find(question)) return *known;
    auto digest = digest_of(path);
    cache.keep(question, digest);
    return digest;
}

bool belongs_to_model(const fs::path& path) {
    return is_safetensors_name(path) || std::find(ModelEndings.begin(), ModelEndings.end(),
                                                  path.extension().string()) != ModelEndings.end();
}

/// One line per file below a folder: its name there and its contents.
std::string contents_below(const fs::path& folder, AnswerCache& cache) {
    std::vector<std::string> lines;
    std::error_code failure;
    for (fs::recursive_directory_iterator
             at(folder, fs::directory_options::follow_directory_symlink, failure),
         end;
         !failure && at != end; at.increment(failure))
        if (at->is_regular_file(failure) && belongs_to_model(at->path()))
            lines.push_back(at->path().lexically_relative(folder).generic_string() + " " +
                            contents_of(at->path(), cache));
    if (failure)
        throw Error(ErrorCode::Unreadable, "the folder cannot be read (" + failure.message() + ")", "",
                    folder);
    std::sort(lines.begin(), lines.end());
    return fmt::format("{}\n", fmt::join(lines, "\n"));
}

bool is_configuration(const fs::path& path) {
    return path.extension() == ".json" || neural::is_yaml_name(path);
}

/// A checkpoint has its configurations, its tokenizer, and the tiny autoencoder, beside it.
std::string contents_beside(const fs::path& checkpoint, AnswerCache& cache) {
    std::string text = "weights " + contents_of(checkpoint, cache) + "\n";
    std::vector<std::string> lines;
    const auto folder = fs::absolute(checkpoint).parent_path();
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.is_regular_file() && is_configuration(entry.path()))
            lines.push_back(entry.path().filename().string() + " " + contents_of(entry.path(), cache));
    std::sort(lines.begin(), lines.end());
    text += fmt::format("{}\n", fmt::join(lines, "\n"));
    for (const char* part : {"taesd", "vae", "tokenizer"})
        if (fs::is_directory(folder / part)) text += contents_below(folder / part, cache);
    if (const auto vae = neural::vae_beside(checkpoint); !vae.empty())
        text += "vae " + contents_of(vae, cache) + "\n";
    return text;
}

/// The folder of a tiny autoencoder that the job or the model names outside of the model; empty = none.
fs::path named_taesd(const JobParameters& job, const fs::path& folder) {
    if (!job.taesd.empty()) return job.taesd == "none" ? fs::path() : fs::path(job.taesd);
    const auto facts = model_json(folder / "gseditpro.json");
    if (!facts.is_object() || !facts.contains("taesd") || !facts["taesd"].is_string()) return {};
    const auto name = facts["taesd"].get<std::string>();
    return name.empty() || name == "none" ? fs::path() : folder / name;
}

/// Contents of a LoRA and of PEFT's configuration beside it.
std::string lora_contents(const fs::path& file, AnswerCache& cache) {
    const auto config = file.parent_path() / "adapter_config.json";
    return contents_of(file, cache) + (fs::is_regular_file(config) ? " " + contents_of(config, cache) : "");
}

/// Libraries choose other kernels on another processor, which round differently.
std::string processor() {
    std::ifstream stream("/proc/cpuinfo");
    std::string line;
    while (std::getline(stream, line))
        if (line.starts_with("model name")) return line;
    return {};
}

std::string library_line(AnswerCache& cache) {
    const auto library = neural_library();
    return library.empty() ? std::string() : "library " + contents_of(library, cache) + "\n";
}

std::string digest_of_text(const std::string& text) {
    ContentHash hash;
    hash.text(text);
    return hash.key().hex();
}

}  // namespace

std::string segmenter_identity(const fs::path& path, const std::string& device, AnswerCache& cache,
                               int version) {
    return digest_of_text(fmt::format("segmenter, version {}\n{}\n{}device {}\n", version, processor(),
                                      library_line(cache), device) +
                          (fs::is_directory(path) ? contents_below(path, cache)
                                                  : "weights " + contents_of(path, cache) + "\n"));
}

std::string model_identity(const JobParameters& job, AnswerCache& cache, int version) {
    const auto path = model_path(job);
    const bool folder = fs::is_directory(path);
    std::string text =
        fmt::format("version {}\n{}\nname {}\n", version, processor(), path.filename().string());
    text += library_line(cache);
    text += fmt::format("device {}, precision {}, tiny autoencoder {}\n", job.device, job.precision,
                        job.taesd == "none" ? "off" : "on");
    text += folder ? contents_below(path, cache) : contents_beside(path, cache);
    if (const auto tiny = named_taesd(job, folder ? path : path.parent_path());
        !tiny.empty() && fs::is_directory(tiny))
        text += "tiny autoencoder\n" + contents_below(tiny, cache);
    for (const auto& lora : neural::find_loras(job.lora))  // its name may say that it was distilled
        text += fmt::format("lora {} {} {}\n", static_cast<int>(neural::lora_mark(lora.file)), lora.strength,
                            lora_contents(lora.file, cache));
    return digest_of_text(text);
}

}  // namespace gse::pipeline
