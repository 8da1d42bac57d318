// Fuzz target: texts and bytes of image servers, and workflows: one reader after another.
#include "engine/remote/http/http_types.h"
#include "engine/remote/picture/base64.h"
#include "engine/remote/picture/picture_header.h"
#include "engine/remote/protocols/server_error.h"
#include "engine/remote/workflow/workflow.h"
#include "tests/fuzz/fuzz_helpers.h"

namespace {

/// A workflow that is read has a place for everything that must be there, and takes values.
void exercise_workflow(std::string_view text) {
    using namespace gse::remote;
    const auto workflow = read_workflow(text);
    GSE_CHECK(workflow.find(WorkflowRole::Image) != nullptr &&
              workflow.find(WorkflowRole::Output) != nullptr);
    GSE_CHECK(!workflow.table().empty());
    GSE_CHECK_EQ(filled_workflow(workflow, {}).size(), workflow.graph.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace gse;
    const auto bytes = fuzz::as_bytes(data, size);
    const std::string text(reinterpret_cast<const char*>(data), size);
    fuzz::exercise([&] {
        const auto header = remote::read_picture_header(bytes, {});
        GSE_CHECK(header.width > 0 && header.width <= 4096 && header.height > 0);
    });
    fuzz::exercise([&] {
        const auto decoded = remote::base64_decoded(text);
        GSE_CHECK(text.starts_with("data:") || remote::base64_encoded(decoded) == text);
    });
    fuzz::exercise([&] {
        const auto typed = remote::parse_server_url(text);
        GSE_CHECK(remote::parse_server_url(typed.url.at("")).url.at("") == typed.url.at(""));
    });
    GSE_CHECK(remote::server_words({500, {}, text}).size() <= 300);
    return fuzz::exercise([&] { exercise_workflow(text); });
}
