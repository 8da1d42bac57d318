// Plain structs and one function table shared by the driver of the fast rasterizer and its kernels of each
// instruction set. No standard containers and no inline functions are here. Code compiled with special flags
// must stay in its own file, or the linker may pick it for all.
#pragma once

#include <cstddef>
#include <cstdint>

namespace gse::raster {

inline constexpr int TileSize = 16;       // pixels
inline constexpr int BlockSize = 4;       // pixels; one 16-lane register is a 4x4 block
inline constexpr int TilePixels = 256;    // in block order: [block 16][lane 16]
inline constexpr int PartialStride = 16;  // floats per (tile, Gaussian) in the backward pass
inline constexpr std::uint32_t BatchEntries = 256;

/// Pixel inputs of one Gaussian, in one cache line. The ellipse is kept as its Cholesky factor in the log2
/// domain: u = l1 dx + l2 dy, v = l3 dy, log2(alpha) = log2_opacity - u^2 - v^2. Unlike A dx^2 + 2 B dx dy +
/// C dy^2, this cannot lose its sign for needles.
struct alignas(64) Record {
    float x, y;  // pixels
    float l1, l2, l3;
    float log2_opacity;  // <= 0
    float colour[3];
    float depth;
    float half_width, half_height;  // pixels, a little more than where alpha falls below 1/255
    float lean;                     // dy of the ellipse's rightmost point
    std::uint32_t row;
};
static_assert(sizeof(Record) == 64);

/// Raw arrays of the scene.
struct Source {
    const float* position;
    const float* log_scale;
    const float* rotation;
    const float* opacity_logit;
    const float* sh;
    std::size_t sh_stride;  // floats per row
};

/// Camera and settings, widened and with derived limits.
struct Viewpoint {
    double rotation[9], translation[3], eye[3];
    double fx, fy, cx, cy;
    double ratio_low[2], ratio_high[2];  // of x/z and y/z in the Jacobian
    double near_plane, far_plane, blur;
    int width, height;
    int sh_count;  // coefficients per channel in use
    float negative_slope;
    bool antialiased;
};

/// Rows [begin, end) -> records and sort keys, in order of rows, densely from `records` and `keys`.
struct ProjectJob {
    Source source;
    const Viewpoint* view;
    const float* values;  // if set: colour = (value, 0, 0)
    bool colours;         // whether they are computed: for the picture, or because some may not be finite
    std::size_t begin, end;
    Record* records;
    std::uint32_t* keys;   // bits of the depth, which sort as unsigned numbers
    std::size_t drawn;     // result
    std::size_t unusable;  // result
};

struct TilePair {
    std::uint32_t tile;
    std::uint32_t blocks;  // bit 4 row + column of the 4x4 blocks touched
};

/// Pairs of one record: a place in its chunk's pairs and their number.
struct PairRange {
    std::uint32_t begin, count;
};

/// Records [begin, end) -> the tiles and blocks their ellipses touch, record by record.
struct BinJob {
    const Record* records;
    std::size_t begin, end;  // begin is advanced; stops early when `pairs` may not suffice
    int width, height;
    TilePair* pairs;
    std::size_t capacity, written;
    PairRange* ranges;  // of each record
};

/// An entry of a tile's list, front to back.
struct TileEntry {
    std::uint32_t record;
    std::uint32_t slot;  // of its partial sums: the pairs of all records are numbered in order of rows
    std::uint32_t blocks;
};

/// Sums of a tile's pixels.
struct alignas(64) TileLight {
    float transmittance[TilePixels];
    float colour[3][TilePixels];  // without the background
    std::uint32_t
        ends[16];  // of each block: the first entry that finds no light left in it; 0 if it was not blended
    std::uint32_t reached;      // entries in front of the last of them
    std::uint32_t block_pairs;  // pairs of block and entry in front of them
};

struct alignas(64) BlendScratch {
    float running[TilePixels];  // transmittance that goes on shrinking behind the cut
    float depth[TilePixels];
    std::int32_t blended[TilePixels];
    Record records[BatchEntries];
    std::uint16_t lists[16][BatchEntries + 16];
};

/// Records by index. Those below `split` lie in one array, the others in a second one.
struct RecordTable {
    const Record* first;
    const Record* second;  // its first is record `split`
    std::uint32_t split;
};

inline constexpr std::uint32_t NoSplit = 0xffffffff;  // all records lie in the first array
inline constexpr std::uint32_t AllBlocks = 0xffff;

struct BlendJob {
    RecordTable records;
    const TileEntry* entries;
    std::uint32_t count;
    std::uint32_t blocks;  // those to blend; nothing is said of the others
    int x, y;              // first pixel of the tile
    int width, height;     // of the image
    TileLight* light;
    BlendScratch* scratch;
};

struct alignas(64) BackwardScratch {
    float transmittance[TilePixels];
    float remaining[TilePixels];  // gradient-weighted light behind the pair under way
    float d_colour[3][TilePixels];
    float mask[TilePixels];
};

struct BackwardJob {
    RecordTable records;
    const TileEntry* entries;
    std::uint32_t count;
    int x, y;
    int width, height;
    const std::uint32_t* ends;   // of the tile's light (not for contributions)
    BackwardScratch* scratch;    // remaining, d_colour (or mask) filled by the driver
    std::uint32_t first_record;  // records from here on get gradients
    std::uint32_t first_slot;    // the first of theirs, where `partials` begin
    float* partials;
    bool past_caches;  // slots are written straight to memory
};

/// Order of the sums in a slot of partial gradients. g is dL/d ln(alpha), w is the weight alpha T.
enum PartialSum : int { SumG, SumGu, SumGv, SumGuu, SumGuv, SumGvv, SumRed, SumGreen, SumBlue, SumBlended };
/// Order in the slots of contributions.
enum ContributionSum : int { SumWeight, SumMasked };

/// Destinations of the raw-parameter gradients.
struct GradientArrays {
    float* position;
    float* log_scale;
    float* rotation;
    float* opacity_logit;
    float* sh;
    float* mean2d_norm;
    std::uint8_t* visible;
};

/// Sums the partial gradients of records [begin, end) and applies the chain rule. Rows of [first_row,
/// end_row) that no pixel shows get zeros.
struct GradientJob {
    Source source;
    const Viewpoint* view;
    const Record* begin;
    const Record* end;
    const PairRange* ranges;   // of begin
    std::uint32_t slot_shift;  // slot of place 0 of the ranges, modulo 2^32: it may lie before the first
    const float* partials;
    std::size_t first_row, end_row;
    std::size_t out_row;  // the one that index 0 of the arrays belongs to
    GradientArrays out;
    bool past_caches;  // coefficients of whole cache lines are written straight to memory
};

/// The innermost loops, for floor_bench.h.
enum class FloorLoop { Forward, Backward, Mask, Gather, SceneGather };
inline constexpr std::uint32_t FloorRecords = 64;

struct FloorScratch {
    Record records[FloorRecords];
    TileEntry entries[FloorRecords];  // of record i, with as many blocks as are to be timed
    TileLight light;
    BlendScratch blend;
    BackwardScratch backward;
    alignas(64) float partials[FloorRecords * PartialStride];
    TilePair pairs[16 * FloorRecords];
    PairRange ranges[FloorRecords];
};

struct FloorJob {
    FloorLoop loop;
    std::uint32_t rounds;
    FloorScratch* scratch;
    const Record* records;     // of a whole scene, for SceneGather,
    const TileEntry* entries;  // and rounds x FloorRecords of them in any order
    std::size_t work;          // result: pairs of block and Gaussian, or of tile and Gaussian
};

/// The kernels of one instruction set.
struct Kernels {
    const char* name;
    void (*project)(ProjectJob&);
    void (*bin)(BinJob&);
    void (*blend)(const BlendJob&);
    void (*backward)(const BackwardJob&);
    void (*contribute)(const BackwardJob&);
    void (*gradient)(const GradientJob&);
    void (*floor)(FloorJob&);
};

extern const Kernels ScalarKernels;
#ifdef GSE_X86
extern const Kernels Avx2Kernels;
extern const Kernels Avx512Kernels;
#endif

/// Table of that name. An empty name is the choice of GSE_CPU, else the best this processor runs. Throws
/// Error for one that is unknown or cannot run here.
const Kernels& choose_kernels(const char* name);

}  // namespace gse::raster
