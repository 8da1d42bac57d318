// Repeated rendering of views while only the last rows of the scene change, as in the edit loop.
#pragma once

#include <cstddef>
#include <memory>

#include "engine/raster/rasterizer.h"

namespace gse::raster {

/// Work of a session so far; no result depends on it.
struct ViewSessionWork {
    std::size_t prepared = 0;    // times that a view's fixed rows were prepared
    std::size_t continued = 0;   // pictures that needed only the rows that change
    std::size_t full = 0;        // pictures for which every row was prepared
    std::size_t kept_bytes = 0;  // memory that the prepared views hold now
};

/// Pictures and gradients of a fixed number of views of a scene whose rows [0, first_row) stay as they are.
/// The part of those rows in a view is prepared once. Pictures and gradients are bit for bit those of the
/// session's rasterizer, which must outlive it. Only ForwardOutput::pairs counts less: the pairs that were
/// looked at. Results do not depend on the budget.
class ViewSession {
public:
    virtual ~ViewSession() = default;

    /// Renders view `view`, below the session's number of views. Rows from `first_row` on may differ from the
    /// last call, also in number. Call forget() first when earlier rows have changed. Another camera,
    /// settings or `first_row` cost the preparation anew. Keeps the inputs of backward(): `gaussians` must
    /// stay alive and unchanged until then.
    virtual void forward(std::size_t view, const GaussianSpans& gaussians, std::size_t first_row,
                         const Camera& camera, const Settings& settings, ForwardOutput& output) = 0;

    /// Gradient of sum(colour * d_colour) + sum(alpha * d_alpha) of the last forward(), for its rows >=
    /// first_row. d_alpha may be empty. Rows that were not drawn get exact zeros.
    virtual void backward(const Image& d_colour, const Image& d_alpha, Gradients& output) = 0;

    /// Forgets the fixed rows, which differ from here on.
    virtual void forget() = 0;

    virtual ViewSessionWork work() const = 0;
};

/// Session that does the full work every time.
std::unique_ptr<ViewSession> make_full_view_session(Rasterizer& rasterizer);

}  // namespace gse::raster
