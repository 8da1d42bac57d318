// A measurement of the rasterizer as JSON.
#include "engine/laboratory/bench/raster/raster_report.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

Json times_json(const raster::BenchTimes& times) {
    return {{"wall_median_ms", times.wall_median_ms},
            {"wall_min_ms", times.wall_min_ms},
            {"cpu_median_ms", times.cpu_median_ms},
            {"cpu_min_ms", times.cpu_min_ms}};
}

Json skip_times_json(const raster::SkipTimes& times, std::size_t pairs) {
    return {
        {"forward_cpu_ms", times.forward_ms}, {"backward_cpu_ms", times.backward_ms}, {"tile_pairs", pairs}};
}

}  // namespace

Json floor_report(const raster::RasterBench& bench) {
    const auto& kernel = bench.kernel_floor;
    const auto& step = bench.floor;
    Json backward;
    for (std::size_t i = 0; i < raster::FloorBlocks.size(); ++i)
        backward[std::to_string(raster::FloorBlocks[i])] = kernel.backward_ns[i];
    Json json;
    json["threads"] = bench.threads;
    json["ns_per_block"] = {{"forward", kernel.forward_ns}, {"backward_by_blocks_per_tile_pair", backward}};
    json["ns_per_tile_pair"] = {{"mask", kernel.mask_ns},
                                {"gather", kernel.scene_gather_ns},
                                {"gather_in_first_cache", kernel.gather_ns}};
    json["gigabytes_per_second"] = kernel.gigabytes_per_second;
    json["tile_pairs_reached"] = bench.pairs_reached;
    json["block_pairs"] = bench.block_pairs;
    json["ms"] = {{"forward_blend", step.forward_blend},
                  {"backward_blend", step.backward_blend},
                  {"lists", step.lists},
                  {"parameters", step.parameters},
                  {"parameter_gradients", step.parameter_gradients},
                  {"total", step.total()},
                  {"total_with_records_in_first_cache", step.total() - step.lists + step.lists_in_cache}};
    json["measured_ms"] = {
        {"wall", bench.forward_min_ms + bench.backward_min_ms},
        {"processor_per_thread", (bench.forward.cpu_min_ms + bench.backward.cpu_min_ms) / bench.threads}};
    json["ratio"] = {{"wall", bench.floor_ratio}, {"processor", bench.floor_ratio_cpu}};
    return json;
}

Json raster_report(const raster::RasterBench& bench) {
    Json json;
    json["kernels"] = bench.kernels;
    json["threads"] = bench.threads;
    json["splats"] = bench.splats;
    json["width"] = bench.width;
    json["height"] = bench.height;
    json["views"] = bench.views;
    json["forward_ms"] = bench.forward_ms;
    json["backward_ms"] = bench.backward_ms;
    json["forward"] = times_json(bench.forward);
    json["backward"] = times_json(bench.backward);
    json["tile_pairs"] = bench.pairs;
    json["blended_pairs"] = bench.blended_pairs;
    json["ns_per_pair"] = bench.forward_ns_per_pair + bench.backward_ns_per_pair;
    json["forward_ns_per_pair"] = bench.forward_ns_per_pair;
    json["backward_ns_per_pair"] = bench.backward_ns_per_pair;
    json["peak_rss_mb"] = bench.peak_rss_mb;
    if (bench.floor_ratio > 0) json["floor"] = floor_report(bench);
    json["error"] = {{"max_abs", bench.max_abs_error},
                     {"psnr_db", bench.psnr_db},
                     {"gradient_relative_l2", bench.gradient_error}};
    return json;
}

Json skip_report(const std::vector<raster::SkipBench>& shares) {
    Json json;
    json["labelled"] =
        "the rows nearest to the one in the middle of the scene, as the rows of an edit lie together";
    for (const auto& bench : shares)
        json["shares"].push_back({{"share", bench.share},
                                  {"rows", bench.labelled},
                                  {"full", skip_times_json(bench.full, bench.full_pairs)},
                                  {"skipping", skip_times_json(bench.skipping, bench.pairs)},
                                  {"ratio", bench.ratio},
                                  {"prepare_cpu_ms", bench.prepare_ms},
                                  {"kept_mib_per_view", bench.kept_mib},
                                  {"picture_difference", bench.picture_difference},
                                  {"gradient_difference", bench.gradient_difference}});
    return json;
}

}  // namespace gse::bench
