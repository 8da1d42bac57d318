// Loops over blocks of rows. Plain floats take a way of their own.
#include "engine/io/formats/ply/ply_rows.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "engine/io/bytes/byte_reader.h"
#include "engine/io/formats/ply/ply_layout.h"

namespace gse::io {
namespace {

struct SourceColumn {
    std::size_t offset = 0;
    PlyType type = PlyType::Float32;
    bool absent = false;
};

/// A target with the places of its columns in a row.
struct Gatherer {
    const PlyTarget& target;
    std::vector<SourceColumn> columns;
    bool plain = false;  // floats in the machine's order

    Gatherer(const PlyTarget& wanted, const PlyRowShape& shape) : target(wanted) {
        for (const int index : wanted.columns) {
            const auto i = static_cast<std::size_t>(std::max(index, 0));
            columns.push_back({shape.offsets[i], shape.types[i], index == Absent});
        }
        plain = !shape.big_endian && std::all_of(columns.begin(), columns.end(), [](const SourceColumn& c) {
            return !c.absent && c.type == PlyType::Float32;
        });
    }
};

template <class T> void put_whole(double value, std::byte* to) {
    const double least = std::numeric_limits<T>::min(), most = std::numeric_limits<T>::max();
    const T whole = static_cast<T>(std::clamp(std::isnan(value) ? 0 : std::round(value), least, most));
    std::memcpy(to, &whole, sizeof whole);
}

/// Writes a number as one of the type.
void store_number(double value, PlyType type, std::byte* to) {
    switch (type) {
        case PlyType::Int8: return put_whole<std::int8_t>(value, to);
        case PlyType::Uint8: return put_whole<std::uint8_t>(value, to);
        case PlyType::Int16: return put_whole<std::int16_t>(value, to);
        case PlyType::Uint16: return put_whole<std::uint16_t>(value, to);
        case PlyType::Int32: return put_whole<std::int32_t>(value, to);
        case PlyType::Uint32: return put_whole<std::uint32_t>(value, to);
        case PlyType::Float32: {
            const auto narrow = static_cast<float>(value);
            std::memcpy(to, &narrow, sizeof narrow);
            return;
        }
        case PlyType::Float64: std::memcpy(to, &value, sizeof value); return;
    }
}

/// Rows of a block.
struct RowBlock {
    std::span<const std::byte> rows;
    std::size_t count = 0;
    const PlyRowShape& shape;

    const std::byte* at(std::size_t row) const { return rows.data() + row * shape.stride; }
};

void append_floats(const RowBlock& block, const Gatherer& gatherer, std::vector<float>& buffer) {
    buffer.resize(block.count * gatherer.columns.size());
    float* out = buffer.data();
    for (std::size_t row = 0; row < block.count; ++row) {
        const std::byte* values = block.at(row);
        if (gatherer.plain)
            for (const SourceColumn& column : gatherer.columns)
                *out++ = load_scalar<float>(values + column.offset);
        else
            for (const SourceColumn& column : gatherer.columns)
                *out++ = column.absent
                             ? gatherer.target.missing
                             : load_ply_scalar(values + column.offset, column.type, block.shape.big_endian);
    }
    gatherer.target.floats->insert(gatherer.target.floats->end(), buffer.begin(), buffer.end());
}

void append_doubles(const RowBlock& block, const Gatherer& gatherer) {
    for (std::size_t row = 0; row < block.count; ++row)
        for (const SourceColumn& column : gatherer.columns)
            gatherer.target.doubles->push_back(
                load_ply_double(block.at(row) + column.offset, column.type, block.shape.big_endian));
}

void append_bytes(const RowBlock& block, const Gatherer& gatherer) {
    const SourceColumn& column = gatherer.columns.front();
    const std::size_t width = ply_type_size(gatherer.target.type);
    std::vector<std::byte>& to = *gatherer.target.bytes;
    const std::size_t before = to.size();
    to.resize(before + block.count * width);
    for (std::size_t row = 0; row < block.count; ++row) {
        const std::byte* from = block.at(row) + column.offset;
        std::byte* place = to.data() + before + row * width;
        if (column.type != gatherer.target.type)
            store_number(load_ply_double(from, column.type, block.shape.big_endian), gatherer.target.type,
                         place);
        else if (block.shape.big_endian) std::reverse_copy(from, from + width, place);
        else std::copy_n(from, width, place);
    }
}

}  // namespace

void read_ply_rows(const PlyRowSource& source, const PlyRowShape& shape, std::size_t count,
                   std::span<const PlyTarget> targets) {
    std::vector<Gatherer> gatherers;
    for (const PlyTarget& target : targets) gatherers.emplace_back(target, shape);
    std::vector<float> buffer;
    for (std::size_t begin = 0; begin < count; begin += PlyBlockRows) {
        const std::size_t end = std::min(count, begin + PlyBlockRows);
        const RowBlock block{source(begin, end), end - begin, shape};
        for (const Gatherer& gatherer : gatherers) {
            if (gatherer.target.floats != nullptr) append_floats(block, gatherer, buffer);
            else if (gatherer.target.doubles != nullptr) append_doubles(block, gatherer);
            else append_bytes(block, gatherer);
        }
    }
}

}  // namespace gse::io
