// Fuzz target: SOG, as a zip archive or as its parts laid out plainly, so that checksums do not hide the
// readers. Streamed scenes too.
#include <map>
#include <string>

#include "engine/io/formats/sog/sog_files.h"
#include "engine/io/formats/sog/sog_format.h"
#include "tests/fuzz/fuzz_helpers.h"

namespace {

using namespace gse;

/// Parts as [u8 name length][name][u32 size][bytes], one after the other.
class PlainParts final : public io::PartFiles {
public:
    explicit PlainParts(io::Bytes bytes) : stored_(bytes.size()) {
        while (bytes.size() > 1) {
            const std::size_t name_size = std::to_integer<std::size_t>(bytes[0]);
            if (bytes.size() < 5 + name_size) return;
            const std::string name(reinterpret_cast<const char*>(bytes.data() + 1), name_size);
            std::uint32_t size = 0;
            std::memcpy(&size, bytes.data() + 1 + name_size, sizeof size);
            bytes = bytes.subspan(5 + name_size);
            const std::size_t kept = std::min<std::size_t>(size, bytes.size());
            parts_[name] = {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(kept)};
            bytes = bytes.subspan(kept);
        }
    }
    std::vector<std::byte> read(const std::string& name, std::uint64_t most) const override {
        const auto found = parts_.find(place_ + name);
        if (found == parts_.end()) throw Error(ErrorCode::NotFound, "no such part");
        if (found->second.size() > most) throw Error(ErrorCode::Malformed, "the part is too large");
        return found->second;
    }
    std::uint64_t stored_bytes() const override { return stored_; }
    std::unique_ptr<io::PartFiles> below(const std::string& folder) const override {
        auto files = std::make_unique<PlainParts>(*this);
        if (!folder.empty()) files->place_ += folder + "/";
        return files;
    }
    bool has(const std::string& name) const { return parts_.contains(name); }

private:
    std::string place_;
    std::uint64_t stored_ = 0;
    std::map<std::string, std::vector<std::byte>> parts_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const io::Bytes bytes = fuzz::as_bytes(data, size);
    return fuzz::exercise([&] {
        if (find_format("sog")->detect(bytes)) return fuzz::exercise_scene(io::parse_sog(bytes));
        const PlainParts parts(bytes);
        fuzz::exercise_scene(parts.has("lod-meta.json") ? io::read_sog_levels(parts, "lod-meta.json")
                                                        : io::read_sog(parts, "meta.json"));
    });
}
