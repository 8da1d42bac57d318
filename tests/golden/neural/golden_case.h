// Reference cases of the networks: reads tensors of a case, compares with the tolerance its README states.
#pragma once

#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <torch/torch.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "engine/neural/api/config.h"
#include "engine/neural/weights/safetensors.h"
#include "engine/neural/weights/weights.h"
#include "tests/test_paths.h"

namespace gse::test {

/// One folder of the reference numbers; `present` is false (after a [skip] line) when it is not there.
struct GoldenCase {
    explicit GoldenCase(const std::string& name)
        : folder(goldens_folder() / name), present(available(folder / "README.md")) {}

    neural::Json json(const std::string& file) const { return neural::read_json_file(folder / file); }
    neural::SafetensorsFile tensors(const std::string& file = "io.safetensors") const {
        return neural::SafetensorsFile(folder / file);
    }

    std::filesystem::path folder;
    bool present;
};

/// Names and shapes of the tensors of a published model: a line each, the name, a tab, "3x4" or "scalar" or
/// nothing.
inline neural::KeyShapes read_manifest(const std::filesystem::path& path) {
    neural::KeyShapes shapes;
    std::ifstream stream(path);
    for (std::string line; std::getline(stream, line);) {
        const auto tab = line.find('\t');
        if (line.empty() || tab == std::string::npos || line.starts_with('#') || line.starts_with("key"))
            continue;
        std::vector<std::int64_t> shape;
        auto text = line.substr(tab + 1, line.find('\t', tab + 1) - tab - 1);
        if (text == "scalar") text.clear();
        for (std::size_t at = 0; at < text.size();) {
            std::size_t used = 0;
            shape.push_back(std::stoll(text.substr(at), &used));
            at += used + 1;
        }
        shapes.emplace(line.substr(0, tab), shape);
    }
    return shapes;
}

/// Largest absolute difference; infinite for a wrong shape or a value that is not a number.
inline double difference(const torch::Tensor& actual, const torch::Tensor& expected) {
    if (actual.numel() == 0 && expected.numel() == 0) return 0;
    if (actual.numel() != expected.numel() || actual.squeeze().sizes() != expected.squeeze().sizes())
        return INFINITY;
    const auto worst =
        (actual.detach().to(torch::kFloat64).reshape(-1) - expected.to(torch::kFloat64).reshape(-1))
            .abs()
            .max()
            .item<double>();
    return std::isnan(worst) ? INFINITY : worst;
}

inline double largest(const torch::Tensor& tensor) {
    return tensor.numel() == 0 ? 0 : tensor.to(torch::kFloat64).abs().max().item<double>();
}

/// Prints the worst share of its tolerance that a case used (GSE_MARGINS set), for the report.
class Margins {
public:
    explicit Margins(std::string name) : name_(std::move(name)) {}
    ~Margins() {
        if (std::getenv("GSE_MARGINS") != nullptr)
            std::printf("[margin] %-22s worst %.4f of tolerance (%s, %.3g)\n", name_.c_str(), worst_,
                        where_.c_str(), error_);
    }
    /// |actual - expected| <= tolerance everywhere.
    void near(const std::string& what, const torch::Tensor& actual, const torch::Tensor& expected,
              double tolerance) {
        const double error = difference(actual, expected);
        note(what, error, tolerance);
        DOCTEST_CHECK_MESSAGE(error <= tolerance, what, ": ", error, " > ", tolerance);
    }
    /// Relative to the largest value of the expected tensor.
    void near_relative(const std::string& what, const torch::Tensor& actual, const torch::Tensor& expected,
                       double tolerance) {
        near(what, actual, expected, tolerance * largest(expected));
    }

private:
    void note(const std::string& what, double error, double tolerance) {
        const double share = tolerance > 0 ? error / tolerance : (error > 0 ? INFINITY : 0);
        if (share <= worst_) return;
        worst_ = share;
        where_ = what;
        error_ = error;
    }
    std::string name_, where_ = "-";
    double worst_ = 0, error_ = 0;
};

/// The key of a "grad.<parameter>" tensor, or empty.
inline std::string gradient_key(const std::string& name) {
    constexpr std::string_view prefix = "grad.";
    return name.starts_with(prefix) ? name.substr(prefix.size()) : std::string();
}

}  // namespace gse::test
