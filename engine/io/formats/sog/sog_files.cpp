// Archives and WebP textures of SOG scenes, by libzip and libwebp.
#include "engine/io/formats/sog/sog_files.h"

#include <fmt/core.h>
#include <webp/decode.h>
#include <webp/encode.h>
#include <zip.h>

#include <algorithm>
#include <limits>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/memory.h"
#include "engine/io/bytes/claims.h"

namespace gse::io {
namespace {

constexpr int WebpLevel = 6;  // of 0 (fast) to 9 (small)
constexpr std::size_t EntryPieceBytes = std::size_t{1} << 20;

class Folder final : public SogFiles {
public:
    explicit Folder(std::filesystem::path folder) : folder_(std::move(folder)) {}

    std::vector<std::byte> read(const std::string& name, std::uint64_t most) const override {
        const std::filesystem::path relative(name);
        if (relative.is_absolute() || std::find(relative.begin(), relative.end(), "..") != relative.end())
            throw Error(ErrorCode::Malformed, "the SOG scene names a file outside of its folder", "",
                        folder_ / "meta.json");
        const InputFile file(folder_ / relative);
        if (file.size() > most)
            throw Error(ErrorCode::Malformed, "the file is larger than its place in a SOG scene allows", "",
                        folder_ / relative);
        require_memory(file.size(), fmt::format("the file \"{}\" of the SOG scene",
                                                name));  // a sparse file may have any size
        std::vector<std::byte> content(static_cast<std::size_t>(file.size()));
        file.read(0, content);
        return content;
    }

    std::uint64_t stored_bytes() const override {
        std::uint64_t bytes = 0;
        std::error_code failure;
        std::filesystem::directory_iterator entry(folder_, failure);
        for (; !failure && entry != std::filesystem::directory_iterator(); entry.increment(failure))
            if (std::error_code ignored; entry->is_regular_file(ignored)) bytes += entry->file_size(ignored);
        return bytes;
    }

private:
    std::filesystem::path folder_;
};

class Archive final : public SogFiles {
public:
    explicit Archive(std::span<const std::byte> bytes) : zip_(nullptr, zip_discard), stored_(bytes.size()) {
        zip_error_t error;
        zip_error_init(&error);
        zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
        zip_t* zip = source != nullptr ? zip_open_from_source(source, ZIP_RDONLY, &error) : nullptr;
        if (zip == nullptr) {
            if (source != nullptr) zip_source_free(source);
            zip_error_fini(&error);
            throw Error(ErrorCode::Malformed, "the SOG file is not a readable zip archive",
                        "the file is cut off or damaged; get it again");
        }
        zip_error_fini(&error);
        zip_.reset(zip);
    }

    std::vector<std::byte> read(const std::string& name, std::uint64_t most) const override {
        const zip_int64_t index = zip_name_locate(zip_.get(), name.c_str(), ZIP_FL_NODIR);
        if (index < 0)
            throw Error(ErrorCode::Malformed, fmt::format("the SOG archive holds no file \"{}\"", name),
                        "the file is damaged or not a SOG scene");
        const std::uint64_t stated = stated_size(static_cast<zip_uint64_t>(index), name, most);
        const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(
            zip_fopen_index(zip_.get(), static_cast<zip_uint64_t>(index), 0), zip_fclose);
        std::vector<std::byte> content;
        while (file != nullptr) {
            const std::size_t filled = content.size();
            content.resize(filled + EntryPieceBytes);
            const zip_int64_t got = zip_fread(file.get(), content.data() + filled, EntryPieceBytes);
            content.resize(filled + static_cast<std::size_t>(std::max<zip_int64_t>(got, 0)));
            if (got == 0 && content.size() == stated) return content;
            if (got <= 0 || content.size() > stated) break;
        }
        throw Error(ErrorCode::Malformed,
                    fmt::format("the file \"{}\" of the SOG archive cannot be unpacked", name),
                    "the file is cut off or damaged; get it again");
    }

    std::uint64_t stored_bytes() const override { return stored_; }

private:
    /// Unpacked bytes of the entry, as the archive states them. They are held against the archive's size and
    /// the free memory, and no more is unpacked.
    std::uint64_t stated_size(zip_uint64_t index, const std::string& name, std::uint64_t most) const {
        zip_stat_t status;
        zip_stat_init(&status);
        if (zip_stat_index(zip_.get(), index, 0, &status) != 0 || (status.valid & ZIP_STAT_SIZE) == 0 ||
            status.size > most)
            throw Error(
                ErrorCode::Malformed,
                fmt::format("the file \"{}\" of the SOG archive has no size, or more than its place allows",
                            name),
                "the file is damaged or made to do harm");
        check_claim({status.size, stored_}, fmt::format("the file \"{}\" of the SOG archive", name));
        return status.size;
    }

    std::unique_ptr<zip_t, void (*)(zip_t*)> zip_;
    std::uint64_t stored_;  // bytes of the whole archive
};

}  // namespace

std::unique_ptr<SogFiles> open_sog_folder(const std::filesystem::path& folder) {
    return std::make_unique<Folder>(folder);
}

std::unique_ptr<SogFiles> open_sog_archive(std::span<const std::byte> bytes) {
    return std::make_unique<Archive>(bytes);
}

Texture decode_webp(std::span<const std::byte> bytes, const std::string& name, std::uint64_t stored_bytes) {
    const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
    int width = 0, height = 0;
    const auto fail = [&](const char* what) {
        throw Error(ErrorCode::Malformed, fmt::format("the texture \"{}\" {}", name, what),
                    "the file is cut off or damaged; get it again");
    };
    if (WebPGetInfo(data, bytes.size(), &width, &height) == 0) fail("is not a WebP picture");
    const std::uint64_t texels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    check_claim({texels * 4, stored_bytes},
                fmt::format("the texture \"{}\" of {} x {} texels", name, width, height));
    Texture texture;
    texture.width = static_cast<std::size_t>(width);
    texture.height = static_cast<std::size_t>(height);
    texture.rgba.resize(static_cast<std::size_t>(texels) * 4);
    if (WebPDecodeRGBAInto(data, bytes.size(), texture.rgba.data(), texture.rgba.size(), width * 4) ==
        nullptr)
        fail("cannot be decoded");
    return texture;
}

std::string encode_webp(const Texture& texture) {
    WebPConfig config;
    WebPPicture picture;
    GSE_CHECK(WebPConfigInit(&config) != 0 && WebPPictureInit(&picture) != 0);
    GSE_CHECK(WebPConfigLosslessPreset(&config, WebpLevel) != 0);
    config.exact = 1;  // else colours under alpha 0 are changed
    WebPMemoryWriter writer;
    WebPMemoryWriterInit(&writer);
    const std::unique_ptr<WebPPicture, void (*)(WebPPicture*)> free_picture(&picture, WebPPictureFree);
    const std::unique_ptr<WebPMemoryWriter, void (*)(WebPMemoryWriter*)> free_writer(&writer,
                                                                                     WebPMemoryWriterClear);
    picture.use_argb = 1;
    picture.width = static_cast<int>(texture.width);
    picture.height = static_cast<int>(texture.height);
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &writer;
    if (WebPPictureImportRGBA(&picture, texture.rgba.data(), picture.width * 4) == 0 ||
        WebPEncode(&config, &picture) == 0)
        throw Error(ErrorCode::Foreign,
                    fmt::format("a texture of {} x {} texels cannot be made (WebP error {})", texture.width,
                                texture.height, static_cast<int>(picture.error_code)));
    return {reinterpret_cast<const char*>(writer.mem), writer.size};
}

}  // namespace gse::io
