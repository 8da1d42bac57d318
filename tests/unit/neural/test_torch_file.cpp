// Files of torch.save: read where they are plain tensors, refused where they could be more.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <sys/resource.h>
#include <zip.h>

#include <numeric>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/neural/weights/torch_file.h"
#include "tests/test_paths.h"

namespace gse::test {
namespace {

using namespace gse::neural;

std::string corpus(const std::string& name) {
    return read_file(source_folder() / "tests/fuzz/corpus/torch_pickle" / name);
}

void refuses(const std::string& pickle, ErrorCode code, const std::string& part) {
    try {
        read_tensor_pickle(pickle, "weights.pt");
        DOCTEST_FAIL("it was read");
    } catch (const Error& error) {
        DOCTEST_CHECK(error.code() == code);
        DOCTEST_CHECK_MESSAGE(std::string(error.what()).find(part) != std::string::npos, error.what());
    }
}

/// A zip archive as torch.save makes them, with these entries.
void write_archive(const std::filesystem::path& path,
                   const std::vector<std::pair<std::string, std::string>>& entries) {
    std::filesystem::remove(path);
    int error = 0;
    zip_t* archive = zip_open(path.c_str(), ZIP_CREATE, &error);
    DOCTEST_REQUIRE(archive != nullptr);
    for (const auto& [name, bytes] : entries) {
        auto* source = zip_source_buffer(archive, bytes.data(), bytes.size(), 0);
        const auto index = zip_file_add(archive, name.c_str(), source, ZIP_FL_ENC_UTF_8);
        zip_set_file_compression(archive, static_cast<zip_uint64_t>(index), ZIP_CM_STORE, 0);
    }
    DOCTEST_REQUIRE(zip_close(archive) == 0);
}

long peak_kilobytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
}

std::string floats(std::size_t count) {
    std::vector<float> values(count);
    std::iota(values.begin(), values.end(), 0.0f);
    return {reinterpret_cast<const char*>(values.data()), count * sizeof(float)};
}

void file_refused(const std::filesystem::path& path, ErrorCode code) {
    try {
        open_tensor_file(path);
        DOCTEST_FAIL("it was read");
    } catch (const Error& error) {
        DOCTEST_CHECK_MESSAGE(error.code() == code, error.what());
        DOCTEST_CHECK(error.path() == path);
    }
}

}  // namespace

DOCTEST_TEST_CASE("a pickled state dictionary is a list of tensors, also one level down") {
    const auto plain = read_tensor_pickle(corpus("state_dict.pkl"), "x");
    DOCTEST_REQUIRE(plain.size() == 2);
    DOCTEST_CHECK(plain.at("weight").shape == std::vector<std::int64_t>{2, 3});
    DOCTEST_CHECK(plain.at("bias").elements == 2);
    const auto nested = read_tensor_pickle(corpus("nested.pkl"), "x");
    DOCTEST_REQUIRE(nested.size() == 2);
    DOCTEST_CHECK(nested.at("a").type == StoredType::Float16);
    DOCTEST_CHECK(nested.at("b").type == StoredType::Int64);
    const auto views = read_tensor_pickle(corpus("parameters.pkl"), "x");
    DOCTEST_CHECK(views.at("view").strides == std::vector<std::int64_t>{1, 4});
    DOCTEST_CHECK(views.at("w").shape == std::vector<std::int64_t>{5});
}

DOCTEST_TEST_CASE("a pickle that calls something is refused by its name") {
    refuses(corpus("call.pkl"), ErrorCode::Unsupported, "posix system");
    refuses(corpus("protocol4.pkl"), ErrorCode::Unsupported, "no dictionary of tensors");
    refuses(std::string("\x80\x02"
                        "cbuiltins\neval\nX\x01\0\0\0"
                        "1\x85R.",
                        27),
            ErrorCode::Unsupported, "builtins eval");
}

DOCTEST_TEST_CASE("a damaged pickle is refused, wherever it ends and whatever it says of sizes") {
    const auto whole = corpus("state_dict.pkl");
    for (std::size_t size = 0; size < whole.size(); ++size)
        DOCTEST_CHECK_THROWS_AS(read_tensor_pickle(whole.substr(0, size), "x"), Error);
    auto longer = whole;
    const auto at = longer.find("K\x02K\x03");
    DOCTEST_REQUIRE(at != std::string::npos);
    longer[at + 3] = '\x7f';
    refuses(longer, ErrorCode::Malformed, "beyond its storage");
}

DOCTEST_TEST_CASE("a text that is taken up again is not copied, and what is copied is short") {
    const long before = peak_kilobytes();
    std::string large("\x80\x02X\0\0\x10\0",
                      7);  // a megabyte of text, remembered, and in a list four thousand times
    large += std::string(1 << 20, 'x') + std::string("q\0](", 4);
    for (int i = 0; i < 4000; ++i) large += std::string("h\0", 2);
    refuses(large + "e.", ErrorCode::Unsupported, "no dictionary of tensors");
    constexpr long AllowedKilobytes = 64 * 1024;  // without sharing, four gigabytes
    DOCTEST_CHECK(peak_kilobytes() - before < AllowedKilobytes);
    std::string joined("\x80\x02X\0\x10\0\0", 7);
    joined += std::string(4096, 'x') + std::string("q\0h\0\x93.", 6);
    refuses(joined, ErrorCode::Malformed, "a name is too long");
    std::string key("\x80\x02}X\0\x10\0\0", 8);
    refuses(key + std::string(4096, 'x') + "Ns.", ErrorCode::Malformed, "a name is too long");
}

DOCTEST_TEST_CASE("dictionaries that name each other thousands of times are looked into once") {
    std::string nested("\x80\x02X\5\0\0\0modelq\0}q\1", 17);
    for (char level = 1; level < 6; ++level) {  // without that, 10^15 visits
        nested += "}(";
        for (int i = 0; i < 1000; ++i) nested += std::string("h\0h", 3) + level;
        nested += std::string("uq") + static_cast<char>(level + 1);
    }
    refuses(nested + ".", ErrorCode::Unsupported, "no dictionary of tensors");
}

DOCTEST_TEST_CASE("a tensor of more numbers than its storage has is refused") {
    auto spread = corpus("state_dict.pkl");
    const auto at = spread.find("K\x03K\x01\x86");  // the strides of [2, 3]
    DOCTEST_REQUIRE(at != std::string::npos);
    spread.replace(at, 4, std::string("K\0K\0", 4));
    // Six of six.
    DOCTEST_CHECK(read_tensor_pickle(spread, "x").at("weight").strides == std::vector<std::int64_t>{0, 0});
    const auto shape = spread.find("K\x02K\x03");
    auto terabytes = spread;
    terabytes.replace(shape, 4, "J\xff\xff\xff\x7fJ\xff\xff\xff\x7f");
    refuses(terabytes, ErrorCode::Unsupported, "numbers from 6");
    spread.replace(shape, 4, "K\x07K\x01");
    refuses(spread, ErrorCode::Unsupported, "make a tensor of 7 numbers from 6");
}

DOCTEST_TEST_CASE("containers a million deep, or inside themselves, end well") {
    std::string deep = "\x80\x02]";
    deep += std::string(1'000'000, '\x85') + ".";
    refuses(deep, ErrorCode::Unsupported, "no dictionary of tensors");
    refuses(std::string("\x80\x02]q\0h\0a.", 9), ErrorCode::Unsupported, "no dictionary of tensors");
}

DOCTEST_TEST_CASE("the archive around it: numbers as they were saved, and every damage is said") {
    const ScratchFolder scratch;
    const auto path = scratch.path() / "weights.pt";
    const auto pickle = corpus("parameters.pkl");
    write_archive(path, {{"any/data.pkl", pickle}, {"any/data/0", floats(5)}, {"any/data/1", floats(12)}});
    const auto file = open_tensor_file(path);
    DOCTEST_CHECK(torch::equal(file->tensor("w"), torch::arange(5).to(torch::kFloat32)));
    DOCTEST_CHECK(torch::equal(file->tensor("view"), torch::arange(12).to(torch::kFloat32).view({3, 4}).t()));
    DOCTEST_CHECK(file->shapes().at("view") == std::vector<std::int64_t>{4, 3});
    auto target = torch::zeros({5}, torch::kFloat64);
    file->copy_to("w", target);
    DOCTEST_CHECK(target[4].item<double>() == 4);
    DOCTEST_CHECK_THROWS_AS(file->tensor("none"), Error);
    write_archive(path, {{"any/data.pkl", pickle}, {"any/data/0", floats(5)}, {"any/data/1", floats(11)}});
    file_refused(path, ErrorCode::Malformed);
    write_archive(path, {{"any/data.pkl", pickle}, {"any/data/0", floats(5)}});
    file_refused(path, ErrorCode::Malformed);
    write_archive(path, {{"any/other", "x"}});
    file_refused(path, ErrorCode::Unsupported);
    write_file(path, pickle);  // as before PyTorch 1.6
    file_refused(path, ErrorCode::Unsupported);
    write_file(path, "PK\x03\x04 and no more");
    file_refused(path, ErrorCode::Malformed);
    std::filesystem::remove(path);
    file_refused(path, ErrorCode::NotFound);
}

}  // namespace gse::test
