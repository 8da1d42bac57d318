// Checks for our own bugs. They print both values and abort. User errors throw gse::Error instead.
#pragma once

#include <fmt/core.h>

#include <string>

namespace gse::detail {
[[noreturn]] void check_failed(const char* file, int line, const char* expression, const std::string& values);
}

#define GSE_CHECK(condition)                                                             \
    do {                                                                                 \
        if (!(condition)) gse::detail::check_failed(__FILE__, __LINE__, #condition, ""); \
    } while (false)

#define GSE_CHECK_EQ(a, b)                                                    \
    do {                                                                      \
        const auto& gse_a = (a);                                              \
        const auto& gse_b = (b);                                              \
        if (!(gse_a == gse_b))                                                \
            gse::detail::check_failed(__FILE__, __LINE__, #a " == " #b,       \
                                      fmt::format("{} vs {}", gse_a, gse_b)); \
    } while (false)
