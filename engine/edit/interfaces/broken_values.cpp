// Picture by picture.
#include "engine/edit/interfaces/broken_values.h"

#include <cmath>

#include "engine/base/check.h"
#include "engine/base/error.h"

namespace gse::edit {

std::size_t mend_broken(const std::vector<EditView>& views, std::vector<Image>& pictures) {
    GSE_CHECK_EQ(views.size(), pictures.size());
    std::size_t all = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
        auto& values = pictures[v].data;
        GSE_CHECK_EQ(values.size(), views[v].rendered.data.size());
        std::size_t broken = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (std::isfinite(values[i])) continue;
            values[i] = views[v].rendered.data[i];
            ++broken;
        }
        if (2 * broken > values.size())
            throw Error(
                ErrorCode::Model,
                "the picture that the model drew of " + views[v].view.name + " is not finite",
                "the model's weights are damaged, or it overflows: try another model, or precision fp32");
        all += broken;
    }
    return all;
}

}  // namespace gse::edit
