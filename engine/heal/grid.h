// Rectangular grid of values, row by row.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gse::heal {

template <class T> struct Grid {
    int width = 0, height = 0;
    std::vector<T> cells;  // [height,width]

    Grid() = default;
    Grid(int columns, int rows, T fill = T{})
        : width(columns), height(rows),
          cells(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), fill) {}

    bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
    T& at(int x, int y) { return cells[index(x, y)]; }
    const T& at(int x, int y) const { return cells[index(x, y)]; }
};

using BitGrid = Grid<std::uint8_t>;

/// Calls call(x, y) for every cell, row by row.
template <class T, class F> void each_cell(const Grid<T>& grid, F&& call) {
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x) call(x, y);
}

/// Calls call(x, y) for the cells around (x, y) that are in the grid: all in a square of 2 reach + 1 a side.
template <class T, class F> void each_neighbour(const Grid<T>& grid, int x, int y, int reach, F&& call) {
    for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx)
            if ((dx != 0 || dy != 0) && grid.inside(x + dx, y + dy)) call(x + dx, y + dy);
}

}  // namespace gse::heal
