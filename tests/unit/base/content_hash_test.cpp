// Hashes of contents, and answers kept by them.
#include <doctest/doctest.h>

#include <set>
#include <string>
#include <thread>
#include <vector>

#include "engine/base/content_hash.h"
#include "engine/base/memory_cache.h"

namespace content_hash_test {

using namespace gse;

namespace {

struct Settings {
    bool on = true;
    int count = 3;
    double share = 0.5;
    std::string name = "bear";
    std::vector<std::string> words = {"a", "b"};
    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("on", self.on, "");
        f("count", self.count, "");
        f("share", self.share, "");
        f("name", self.name, "");
        f("words", self.words, "");
    }
};

ContentKey key_of_text(const std::string& text) {
    ContentHash hash;
    hash.text(text);
    return hash.key();
}

}  // namespace

DOCTEST_TEST_CASE("content hash: XXH3 of 128 bits, as its authors publish it") {
    // XXH3_128bits of nothing (xxHash 0.8.1, seed 0).
    DOCTEST_CHECK(ContentHash().key().hex() == "99aa06d3014798d86001c324468d497f");
}

DOCTEST_TEST_CASE("content hash: every byte, its place and the borders between texts count") {
    const auto hex = [](auto... texts) {
        ContentHash hash;
        (hash.text(texts), ...);
        return hash.key().hex();
    };
    DOCTEST_CHECK(hex("ab", "c") != hex("a", "bc"));
    DOCTEST_CHECK(hex("") != hex());
    DOCTEST_CHECK(hex(std::string(3, '\0')) != hex(std::string(4, '\0')));
    DOCTEST_CHECK(hex("abc").size() == 32);
    std::set<std::string> seen;
    for (int bit = 0; bit < 1024; ++bit) {
        std::string bytes(128, '\0');
        bytes[static_cast<std::size_t>(bit / 8)] = static_cast<char>(1 << bit % 8);
        seen.insert(hex(bytes));
    }
    DOCTEST_CHECK(seen.size() == 1024);
    Image wide(4, 2, 1, 0.5f), tall(2, 4, 1, 0.5f);
    DOCTEST_CHECK(key_of(wide) != key_of(tall));
}

DOCTEST_TEST_CASE("content hash: every field of a parameter struct counts") {
    const auto key = [](const Settings& settings) {
        ContentHash hash;
        hash.fields(settings);
        return hash.key();
    };
    std::set<ContentKey> keys{key({})};
    Settings changed;
    changed.on = false;
    keys.insert(key(changed));
    changed = {}, changed.count = 4, keys.insert(key(changed));
    changed = {}, changed.share = 0.25, keys.insert(key(changed));
    changed = {}, changed.name = "car", keys.insert(key(changed));
    changed = {}, changed.words = {"ab"}, keys.insert(key(changed));
    DOCTEST_CHECK(keys.size() == 6);
    DOCTEST_CHECK(key({}) == key(Settings{}));
}

DOCTEST_TEST_CASE("memory cache: an answer is worked out once, and the one used least recently goes") {
    MemoryCache<int> cache(2);
    int asked = 0;
    const auto answer = [&](const char* question) {
        return cache.get(key_of_text(question), [&] { return ++asked; });
    };
    DOCTEST_CHECK(answer("one") == 1);
    DOCTEST_CHECK(answer("one") == 1);
    DOCTEST_CHECK(answer("two") == 2);
    DOCTEST_CHECK(answer("one") == 1);
    DOCTEST_CHECK(answer("three") == 3);  // "two" goes
    DOCTEST_CHECK(!cache.contains(key_of_text("two")));
    DOCTEST_CHECK(answer("one") == 1);
    cache.keep(key_of_text("one"), 7);
    DOCTEST_CHECK(cache.find(key_of_text("one")) == 7);
    DOCTEST_CHECK(cache.contains(key_of_text("three")));
}

DOCTEST_TEST_CASE("memory cache: threads share it") {
    MemoryCache<std::string> cache(8);
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&] {
            for (int i = 0; i < 500; ++i) {
                const auto text = std::to_string(i % 16);
                if (cache.get(key_of_text(text), [&] { return text; }) != text) cache.keep({}, "wrong");
            }
        });
    threads.clear();
    DOCTEST_CHECK(!cache.contains({}));
}

}  // namespace content_hash_test
