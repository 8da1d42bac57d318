// Views of the first round: taken in place of being drawn, and written as pictures.
#include "engine/pipeline/report/views_to_draw.h"

#include "engine/base/error.h"
#include "engine/io/image/image_file.h"

namespace gse::pipeline {

std::vector<edit::EditView> views_to_draw(EditJob& job) {
    const auto server = job.shared_server();
    if (!server)
        throw Error(ErrorCode::InvalidArgument, "the views to draw are those that an image server is sent",
                    "name a server (--server)");
    std::vector<edit::EditView> views;
    server->hand_out(&views);
    try {
        job.run();
    } catch (const Error& error) {
        server->hand_out(nullptr);
        if (error.code() != ErrorCode::Cancelled || views.empty()) throw;
    }
    server->hand_out(nullptr);
    return views;
}

nlohmann::ordered_json write_views(const std::filesystem::path& folder,
                                   const std::vector<edit::EditView>& views) {
    std::filesystem::create_directories(folder);
    auto list = nlohmann::ordered_json::array();
    for (const auto& view : views) {
        const auto name = remote::file_name_of_view(view.view.name);
        write_png(folder / (name + ".png"), view.rendered);
        write_mask_png(folder / (name + "_mask.png"), view.mask);
        list.push_back(
            {{"view", view.view.name},
             {"file", folder.filename() / (name + ".png")},
             {"mask", folder.filename() / (name + "_mask.png")},
             {"share", static_cast<double>(view.mask.count()) / static_cast<double>(view.mask.data.size())}});
    }
    return list;
}

}  // namespace gse::pipeline
