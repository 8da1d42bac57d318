// Cameras that a reader leaves out: counted, named, with the reason.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "engine/io/cameras/cameras.h"

namespace gse::io {

/// Name of a camera in a sentence: quoted, and cut where it is very long.
std::string quoted(std::string_view name);

/// Names in a row, with the number of those that are too many to list.
class NameList {
public:
    void add(std::string name);
    std::size_t size() const { return size_; }
    /// `"a", "b" and 3 others`.
    std::string text() const;

private:
    std::vector<std::string> names_;
    std::size_t size_ = 0;
};

/// Cameras that are left out of a list, by reason.
class LeftOut {
public:
    /// `name` as it is to be shown. The message of `why` is the reason alone.
    void add(std::string name, const Error& why);
    /// The cameras that are kept, with a note for every reason. `notes` come after these. Throws Error with
    /// the commonest reason where none is kept, or `nothing` where the file lists none.
    CameraList finish(std::vector<View> kept, std::vector<std::string> notes, const Error& nothing) const;

private:
    struct Reason {
        Error why;
        NameList names;
    };
    const Reason& commonest() const;

    std::vector<Reason> reasons_;
    std::size_t size_ = 0;
};

}  // namespace gse::io
