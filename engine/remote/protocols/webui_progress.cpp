// Progress by the number of our task where there are numbers, else of whatever the server draws.
#include "engine/remote/protocols/webui_progress.h"

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/printable.h"
#include "engine/remote/picture/picture_codec.h"
#include "engine/remote/protocols/order_checks.h"

namespace gse::remote {
namespace {

constexpr int ProgressSteps = 100;
constexpr double MostPreviews = 1e9;  // number of a preview
constexpr std::size_t PlainBytes = std::size_t{1} << 20, PreviewBytes = std::size_t{16} << 20;

}  // namespace

nlohmann::json webui_task_body(const std::string& task, int known_preview, bool previews) {
    return {{"id_task", task}, {"id_live_preview", known_preview}, {"live_preview", previews}};
}

WebuiProgress::WebuiProgress(ServerLink& link, WebuiProduct product, const std::string& task,
                             const RedrawOrder& order)
    : link_(link), order_(order), task_(task), has_tasks_(webui_has_tasks(product)),
      previews_(static_cast<bool>(order.preview)) {}

HttpRequest WebuiProgress::question() const {
    if (has_tasks_)
        return link_.requests().post("/internal/progress", webui_task_body(task_, known_preview_, previews_));
    return link_.get(previews_ ? "/sdapi/v1/progress?skip_current_image=false"
                               : "/sdapi/v1/progress?skip_current_image=true");
}

void WebuiProgress::look(const JobControl& job) {
    if (!job.progress && !previews_) return;
    const auto most = previews_ ? std::min(picture_answer_bytes(order_, 0), PreviewBytes) : PlainBytes;
    const auto json = link_.try_json(question(), job, most);
    if (!json) {
        previews_ = false;  // the next look asks for less
        return;
    }
    if (has_tasks_ && value_of(*json, "queued") == true)
        return job.report("waiting in the server's queue", 0, 0);
    const double share = number_of(*json, "progress", 0, 1, 0);
    job.report(DrawingStage, static_cast<int>(share * ProgressSteps), ProgressSteps);
    if (previews_) show_preview(*json);
}

void WebuiProgress::show_preview(const nlohmann::json& answer) {
    const auto text = text_of(answer, has_tasks_ ? "live_preview" : "current_image");
    if (text.empty()) return;
    try {
        order_.preview(received_picture(text, order_.picture));
        known_preview_ = static_cast<int>(number_of(answer, "id_live_preview", -1, MostPreviews, -1));
    } catch (const Error& error) {
        previews_ = false;
        log::info("the server's preview cannot be shown: {}", printable(error.message()));
    }
}

}  // namespace gse::remote
