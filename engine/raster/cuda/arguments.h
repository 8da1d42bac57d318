// Arguments of the CUDA rasterizer's kernels, read by the compiler of the device and by that of the
// processor. Plain structs of numbers and of addresses in the device's memory. Rows are those of the scene;
// ranks are their places in the order of depth. Pairs are numbered rank by rank, slots row by row.
#pragma once

#include "engine/raster/kernels.h"

namespace gse::raster::cuda {

inline constexpr std::uint32_t BlockThreads = 256;  // of every kernel
inline constexpr std::uint32_t ScanItems = 8;       // per thread
inline constexpr std::uint32_t RadixItems = 8;      // per thread
inline constexpr std::uint32_t RadixBits = 4;
inline constexpr std::uint32_t RadixDigits = 1u << RadixBits;
inline constexpr std::uint32_t NotDrawn = 0xffffffff;   // a key behind every depth
inline constexpr std::uint32_t Saturated = 0xffffffff;  // sums of counts stop here
inline constexpr std::uint32_t SlotFloats = 10;         // PartialSum
inline constexpr std::uint32_t WeightFloats = 2;        // ContributionSum

/// Prefix sums out[i] = sum of in[0..i), which may be one array; totals[b] = sum of block b's BlockThreads *
/// ScanItems.
struct ScanArguments {
    const std::uint32_t* in;
    std::uint32_t* out;
    std::uint32_t* totals;
    std::uint32_t count;
};

/// values[i] += offsets[block of the scan that had i].
struct AddArguments {
    std::uint32_t* values;
    const std::uint32_t* offsets;
    std::uint32_t count;
};

/// One digit of a stable radix sort. counts: [RadixDigits, blocks] frequency of each digit in each block,
/// later their exclusive sums.
struct RadixArguments {
    const std::uint32_t* keys;
    const std::uint32_t* values;  // none: 0, 1, 2 ...
    std::uint32_t* sorted_keys;
    std::uint32_t* sorted_values;
    std::uint32_t* counts;
    std::uint32_t count, blocks, shift;
};

/// Rows -> records, sort keys, numbers of tiles touched. Rows that are not drawn get NotDrawn and 0.
struct ProjectArguments {
    Source source;
    Viewpoint view;
    const float* values;  // if set: colour = (value, 0, 0)
    std::uint32_t rows;
    Record* records;             // [rows]
    std::uint32_t* keys;         // [rows] bits of the depth
    std::uint32_t* pair_counts;  // [rows]
    std::uint32_t* unusable;     // [1] counts up
};

/// out[i] = values[order[i]].
struct GatherArguments {
    const std::uint32_t* values;
    const std::uint32_t* order;
    std::uint32_t* out;
    std::uint32_t count;
};

/// Pairs of every rank: tiles and rows, and the first pair of each row.
struct EmitArguments {
    const Record* records;
    const std::uint32_t* order;        // [rows] rank -> row
    const std::uint32_t* begins;       // [rows] of a rank's pairs
    const std::uint32_t* pair_counts;  // [rows] of a row
    std::uint32_t rows;
    int width, height;
    std::uint32_t* pair_tiles;   // [pairs]
    std::uint32_t* pair_rows;    // [pairs]
    std::uint32_t* pair_begins;  // [rows]
};

/// A tile's part of the sorted pairs.
struct TileRange {
    std::uint32_t begin, end;
};

struct RangeArguments {
    const std::uint32_t* tiles;  // [pairs] sorted
    std::uint32_t pairs;
    TileRange* ranges;  // [tiles] zero before
};

/// The lists of all tiles, front to back.
struct TileLists {
    const Record* records;           // [rows]
    const TileRange* ranges;         // [tiles]
    const std::uint32_t* entries;    // [pairs] sorted by tile and depth -> pair
    const std::uint32_t* pair_rows;  // [pairs]
    std::uint32_t tile_columns;
    int width, height;
};

struct BlendArguments {
    TileLists lists;
    float background[3];
    int channels;           // 3, or 1: the first alone
    float* colour;          // [H,W,channels] with the background
    float* transmittance;   // [H,W]
    float* depth;           // [H,W]
    std::int32_t* blended;  // [H,W]
};

/// Slots of the sums of each (tile, Gaussian): slot slot_begins[row - first_row] + pair - pair_begins[row],
/// for rows >= first_row.
struct SlotTable {
    const std::uint32_t* pair_begins;  // [rows]
    const std::uint32_t* slot_begins;  // [rows - first_row]
    float* slots;                      // [slots, SlotFloats or WeightFloats] zero before
    std::uint32_t first_row;
};

struct BackwardArguments {
    TileLists lists;
    SlotTable table;
    const float* colour;  // of the blending
    const float* transmittance;
    const float* d_colour;  // [H,W,3]
    const float* d_alpha;   // [H,W] or none
};

struct ContributeArguments {
    TileLists lists;
    SlotTable table;
    const float* mask;  // [H,W]
};

/// Sums a row's slots and applies the chain rule; row `first_row` is index 0 of the arrays.
struct GradientArguments {
    Source source;
    Viewpoint view;
    const Record* records;
    const std::uint32_t* pair_counts;  // [rows]
    const std::uint32_t* slot_begins;
    const float* slots;
    std::uint32_t first_row, rows;
    GradientArrays out;
};

struct WeightArguments {
    const std::uint32_t* pair_counts;
    const std::uint32_t* slot_begins;
    const float* slots;
    std::uint32_t rows;
    double* total;   // [rows]
    double* masked;  // [rows]
};

// Both compilers must lay them out alike.
static_assert(sizeof(Source) == 48 && sizeof(Viewpoint) == 232 && sizeof(TileLists) == 48 &&
              sizeof(SlotTable) == 32);
static_assert(sizeof(ProjectArguments) == 328 && sizeof(BlendArguments) == 96 &&
              sizeof(BackwardArguments) == 112);
static_assert(sizeof(GradientArguments) == 376 && sizeof(RadixArguments) == 56 &&
              sizeof(EmitArguments) == 72);

}  // namespace gse::raster::cuda
