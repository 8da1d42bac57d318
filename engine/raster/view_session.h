// Rendering the same views again and again while only the last rows of the scene change, as the edit loop
// does.
#pragma once

#include <cstddef>
#include <memory>

#include "engine/raster/rasterizer.h"

namespace gse::raster {

/// What a session has done so far (work, not result).
struct ViewSessionWork {
    std::size_t prepared = 0;    // times that a view's fixed rows were prepared
    std::size_t continued = 0;   // pictures that needed only the rows that change
    std::size_t full = 0;        // pictures for which every row was prepared
    std::size_t kept_bytes = 0;  // memory that the prepared views hold now
};

/// Pictures and gradients of a fixed number of views of a scene whose rows [0, first_row) stay as they are:
/// what those rows show in a view is prepared once. Pictures and gradients are bit for bit those of the
/// rasterizer the session comes from, which must outlive it; only ForwardOutput::pairs counts less, what was
/// really looked at. Results do not depend on the budget either.
class ViewSession {
public:
    virtual ~ViewSession() = default;

    /// Renders view `view` (below the number the session was made for). Rows from `first_row` on may be
    /// others, and more or fewer, than the last time; when earlier rows have changed, forget() has to be
    /// called before. Another camera, other settings or another `first_row` than the last time cost the
    /// preparation anew. Keeps what backward() needs; `gaussians` must stay alive and unchanged until then.
    virtual void forward(std::size_t view, const GaussianSpans& gaussians, std::size_t first_row,
                         const Camera& camera, const Settings& settings, ForwardOutput& output) = 0;

    /// Gradient of sum(colour * d_colour) + sum(alpha * d_alpha) of the last forward(), for its rows >=
    /// first_row. d_alpha may be empty. Rows that were not drawn get exact zeros.
    virtual void backward(const Image& d_colour, const Image& d_alpha, Gradients& output) = 0;

    /// The rows that do not change are others from here on.
    virtual void forget() = 0;

    virtual ViewSessionWork work() const = 0;
};

/// The session that does the full work every time.
std::unique_ptr<ViewSession> make_full_view_session(Rasterizer& rasterizer);

}  // namespace gse::raster
