// Bytes of columns, moved row by row.
#include "engine/scene/origin/extra_columns.h"

#include <array>
#include <cstring>

#include "engine/base/check.h"

namespace gse {

std::size_t column_type_size(ColumnType type) {
    constexpr std::array<std::size_t, 8> sizes = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[static_cast<std::size_t>(type)];
}

ExtraColumns gathered(const ExtraColumns& columns, std::span<const std::int64_t> sources) {
    ExtraColumns result;
    for (const ExtraColumn& column : columns) {
        const std::size_t width = column_type_size(column.type);
        std::vector<std::byte> values(sources.size() * width);
        for (std::size_t row = 0; row < sources.size(); ++row) {
            if (sources[row] < 0) continue;
            const auto from = static_cast<std::size_t>(sources[row]);
            GSE_CHECK(from < column.size());
            std::memcpy(values.data() + row * width, column.values->data() + from * width, width);
        }
        result.push_back(
            {column.name, column.type, std::make_shared<const std::vector<std::byte>>(std::move(values))});
    }
    return result;
}

std::vector<std::int64_t> sources_of(std::span<const std::int64_t> places, std::size_t rows) {
    std::vector<std::int64_t> sources(rows, -1);
    for (std::size_t row = 0; row < places.size(); ++row) {
        if (places[row] < 0) continue;
        const auto place = static_cast<std::size_t>(places[row]);
        GSE_CHECK(place < rows);
        sources[place] = static_cast<std::int64_t>(row);
    }
    return sources;
}

ExtraColumns filtered(const ExtraColumns& columns, std::span<const unsigned char> keep) {
    if (columns.empty()) return {};
    std::vector<std::int64_t> sources;
    for (std::size_t row = 0; row < keep.size(); ++row)
        if (keep[row] != 0) sources.push_back(static_cast<std::int64_t>(row));
    return gathered(columns, sources);
}

std::vector<std::string> names_of(const ExtraColumns& columns) {
    std::vector<std::string> names;
    for (const ExtraColumn& column : columns) names.push_back(column.name);
    return names;
}

}  // namespace gse
