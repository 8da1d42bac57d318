// Faults of servers: each ends in one sentence, and a picture that is right in spite of its form is taken.
#include <doctest/doctest.h>

#include <thread>

#include "engine/remote/protocols/connect.h"
#include "tests/stress/remote/stand_in.h"

namespace gse::remote {
namespace {

constexpr auto Foreign = ErrorCode::Foreign;
constexpr auto Malformed = ErrorCode::Malformed;
constexpr auto Invalid = ErrorCode::InvalidArgument;

struct Fault {
    const char* name;
    ErrorCode code;
    const char* words;  // that the sentence holds
    Knobs more = {};
};

/// Faults of HTTP and of JSON, which all protocols share.
const std::vector<Fault>& transport_faults() {
    static const std::vector<Fault> faults{
        {"html_500", Foreign, "failed (500): \"Just a \\x1b[31mproxy\""},
        {"html_200", Foreign, "a web page"},
        {"not_found", Foreign, "does not know this request (404): \"Not Found\""},
        {"validation", Invalid, "(422): \"body.width: value is not a valid integer\""},
        {"empty", Foreign, "not JSON"},
        {"object", Foreign, "without"},
        {"list", Foreign, "without"},
        {"json_cut", Foreign, "not JSON"},
        {"json_deep", Foreign, "not JSON"},
        {"json_brackets", Foreign, "more than a picture can need"},
        {"json_nan", Foreign, "not JSON"},
        {"json_huge", Foreign, "not JSON"},
        {"json_utf8", Foreign, "not JSON"},
        {"out_of_memory", Foreign, "ran out of memory"},
        {"length_long", Foreign, "before its answer was whole"},
        {"length_short", Foreign, "not JSON"},
        {"no_length", Foreign, "without"},
        {"bad_chunk", Foreign, "before its answer was whole"},
        {"gzip", Foreign, "compresses"},
        {"header_long", Foreign, "more than a picture can need"},
        {"header_many", Foreign, "more than a picture can need"},
        {"not_http", Foreign, "does not speak HTTP"},
        {"no_bytes", Foreign, "before its answer was whole"},
        {"half_header", Foreign, "before its answer was whole"},
        {"reset", Foreign, "before its answer was whole"},
        {"redirect", Foreign, "sends us on to http://", {{"status", "302"}}},
        {"redirect", Foreign, "sends us on to http://", {{"status", "308"}}},
        {"redirect", Foreign, "sends us on to file:///etc/passwd", {{"target", "file:///etc/passwd"}}},
        {"redirect",
         Foreign,
         "sends us on to https://b.example/x",
         {{"target", "https://u:p@b.example/x?token=1"}, {"status", "307"}}},
        {"status", Invalid, "wants a password", {{"status", "401"}}},
        {"status", Invalid, "wants a password", {{"status", "403"}}},
        {"status", Foreign, "too large", {{"status", "413"}}},
        {"status", Foreign, "stays busy (503): \"later\"", {{"status", "503"}, {"words", "later"}}},
        {"status", Foreign, "stays busy (429)", {{"status", "429"}, {"retry_after", "99999999"}}},
    };
    return faults;
}

/// Pictures that are refused, whatever the protocol.
const std::vector<Fault>& picture_faults() {
    static const std::vector<Fault> faults{
        {"b64_cut", Malformed, "base64"},
        {"b64_lines", Malformed, "base64"},
        {"b64_urlsafe", Malformed, "base64"},
        {"b64_rubbish", Malformed, "base64"},
        {"png_cut", Malformed, "damaged"},
        {"png_crc", Malformed, "damaged"},
        {"png_huge", Malformed, "too large"},
        {"png_zero", Malformed, "no pixels"},
        {"png_animated", Malformed, "animat"},
        {"gif", Malformed, "no PNG, JPEG or WebP"},
        {"svg", Malformed, "no PNG"},
        {"bmp", Malformed, "no PNG"},
        {"size_triple", Malformed, "many times larger"},
    };
    return faults;
}

/// A stand-in with a connection that was made before it fails.
struct Tried {
    StandIn& stand_in;
    std::unique_ptr<ImageServer> server;

    Tried(const std::string& flavour, ServerKind kind, const ServerTimes& times = patient_times())
        : stand_in(shared_stand_in(flavour)) {
        auto address = stand_in.address();
        address.kind = kind;
        address.times = times;
        server = connect(address, {});
    }
    Caught with(const std::string& fault, const std::string& at, const Knobs& more = {}) {
        Knobs knobs = more;
        knobs.insert({{"fault", fault}, {"at", at}});
        stand_in.reset(knobs);
        return caught([&] { server->redraw(small_order(), {}); });
    }
    void check(const Fault& fault, const std::string& at) {
        const auto error = with(fault.name, at, fault.more);
        DOCTEST_CAPTURE(fault.name);
        DOCTEST_CAPTURE(at);
        DOCTEST_CAPTURE(error.message);
        DOCTEST_CHECK(error.is(fault.code));
        DOCTEST_CHECK(error.says(fault.words));
        DOCTEST_CHECK(!error.hint.empty());
        DOCTEST_CHECK(error.message.find('\x1b') == std::string::npos);
        DOCTEST_CHECK(error.message.find("token") == std::string::npos);
        DOCTEST_CHECK(error.message.size() < 500);
    }
};

struct Place {
    const char* flavour;
    ServerKind kind;
    const char* at;
};

DOCTEST_TEST_CASE("answers that break HTTP or JSON end in one sentence") {
    if (!can_stand_in()) return;
    for (const auto& [flavour, kind, at] :
         {Place{"forge", ServerKind::Webui, "draw"}, Place{"sdserver", ServerKind::SdCpp, "draw"},
          Place{"vllm", ServerKind::OpenAi, "draw"}, Place{"comfy", ServerKind::Comfy, "draw"}}) {
        Tried tried(flavour, kind);
        for (const auto& fault : transport_faults()) tried.check(fault, at);
    }
}

DOCTEST_TEST_CASE("a question that breaks for ever ends in one sentence") {
    if (!can_stand_in()) return;
    Tried tried("sdserver", ServerKind::SdCpp);
    for (const auto& fault : transport_faults()) {
        const std::string name = fault.name;
        if (name == "object" || name == "list" || name == "no_length") continue;  // an unknown state
        if (name == "not_found") continue;                                        // a job that is lost
        tried.check(fault, "poll");
    }
    DOCTEST_CHECK(tried.with("object", "poll").says("unknown state"));
}

DOCTEST_TEST_CASE("pictures that are damaged, hidden bombs or of another kind are refused") {
    if (!can_stand_in()) return;
    Tried webui("forge", ServerKind::Webui);
    for (const auto& fault : picture_faults()) webui.check(fault, "draw");
    Tried jobs("sdserver", ServerKind::SdCpp);
    for (const auto& fault : picture_faults()) jobs.check(fault, "poll");
    Tried forms("vllm", ServerKind::OpenAi);
    for (const auto& fault : picture_faults()) forms.check(fault, "draw");
    Tried comfy("comfy", ServerKind::Comfy);
    for (const auto& fault : picture_faults())
        if (!std::string(fault.name).starts_with("b64_")) comfy.check(fault, "view");
}

DOCTEST_TEST_CASE("pictures of unusual kinds are taken as colours of the size that came") {
    if (!can_stand_in()) return;
    Tried tried("forge", ServerKind::Webui);
    const auto order = small_order();
    const auto drawn = [&](const char* fault) {
        tried.stand_in.reset({{"fault", fault}});
        return tried.server->redraw(order, {}).picture;
    };
    const auto plain = drawn("");
    for (const char* fault : {"png_16", "png_opaque", "png_interlaced", "png_bomb"}) {
        DOCTEST_CAPTURE(fault);
        const auto picture = drawn(fault);
        DOCTEST_CHECK(picture.channels == 3);
        if (std::string(fault) != "png_bomb") DOCTEST_CHECK(picture.data == plain.data);
    }
    for (const char* fault : {"png_grey", "png_grey_alpha"}) {
        const auto grey = drawn(fault);
        DOCTEST_CHECK(grey.channels == 3);
        DOCTEST_CHECK(grey.at(20, 20, 0) == grey.at(20, 20, 2));
    }
    DOCTEST_CHECK(drawn("png_palette").channels == 3);
    const auto holes = drawn("png_holes");  // every second pixel shows what was sent
    DOCTEST_CHECK(holes.at(20, 20, 0) == plain.at(20, 20, 0));
    DOCTEST_CHECK(std::abs(holes.at(21, 20, 0) - order.picture.at(21, 20, 0)) < 0.003);
    DOCTEST_CHECK(drawn("size_double").width == 128);
    DOCTEST_CHECK(drawn("size_plus8").width == 72);
    DOCTEST_CHECK(drawn("png_tiny").width == 1);
}

DOCTEST_TEST_CASE("answers without a picture end in one sentence") {
    if (!can_stand_in()) return;
    Tried webui("kcpp", ServerKind::Webui);
    DOCTEST_CHECK(webui.with("images_none", "draw").says("without a picture"));
    DOCTEST_CHECK(webui.with("images_blank", "draw").says("drew nothing"));
    DOCTEST_CHECK(webui.with("images_null", "draw").says("no text"));
    DOCTEST_CHECK(webui.with("images_number", "draw").says("without a picture"));
    Tried jobs("sdserver", ServerKind::SdCpp);
    for (const char* fault : {"images_none", "images_blank", "images_null"})
        DOCTEST_CHECK(jobs.with(fault, "poll").says("without a picture"));
    Tried forms("vllm", ServerKind::OpenAi);
    for (const char* fault : {"images_none", "images_blank", "images_null", "images_number"})
        DOCTEST_CHECK(forms.with(fault, "draw").says("without a picture"));
    DOCTEST_CHECK(forms.with("images_url", "draw").says("the address of a picture"));
}

DOCTEST_TEST_CASE("servers that hang or drip are given up") {
    if (!can_stand_in()) return;
    for (const auto& [flavour, kind, at] :
         {Place{"forge", ServerKind::Webui, "draw"}, Place{"sdserver", ServerKind::SdCpp, "draw"},
          Place{"sdserver", ServerKind::SdCpp, "poll"}, Place{"comfy", ServerKind::Comfy, "view"}}) {
        Tried tried(flavour, kind, hasty_times());
        DOCTEST_CAPTURE(flavour);
        DOCTEST_CAPTURE(at);
        DOCTEST_CHECK(tried.with("hang", at).says("says nothing any more"));
        DOCTEST_CHECK(tried.with("drip", at, {{"rate", "1"}}).says("says nothing any more"));
        DOCTEST_CHECK(tried.with("drip", at, {{"rate", "50"}}).says("answers too slowly"));
        DOCTEST_CHECK(tried.with("continue_only", at).says("says nothing any more"));
    }
}

DOCTEST_TEST_CASE("a drawing may take longer than the longest silence between two bytes") {
    if (!can_stand_in()) return;
    auto times = patient_times();
    times.silence = Milliseconds(300);
    for (const auto& [flavour, kind, at] :
         {Place{"forge", ServerKind::Webui, ""}, Place{"vllm", ServerKind::OpenAi, ""}}) {
        Tried tried(flavour, kind, times);
        DOCTEST_CAPTURE(flavour);
        DOCTEST_CHECK(tried.with("", "draw", {{"draw_s", "1.5"}}).code == -1);
    }
}

DOCTEST_TEST_CASE("a server that is busy is asked again, and draws once") {
    if (!can_stand_in()) return;
    for (const auto& [flavour, kind, at] :
         {Place{"forge", ServerKind::Webui, "/img2img"}, Place{"sdserver", ServerKind::SdCpp, "/img_gen"}}) {
        Tried tried(flavour, kind);
        for (const char* status : {"429", "503"}) {
            const auto error = tried.with("status", "draw", {{"status", status}, {"times", "2"}});
            DOCTEST_CHECK(error.code == -1);
            DOCTEST_CHECK(tried.stand_in.asked(at).size() == 3);
        }
    }
}

DOCTEST_TEST_CASE("a password that is wanted in the middle is asked for once, and helps") {
    if (!can_stand_in()) return;
    for (const auto& [flavour, kind, at] :
         {Place{"forge", ServerKind::Webui, "/img2img"}, Place{"sdserver", ServerKind::SdCpp, "/img_gen"},
          Place{"vllm", ServerKind::OpenAi, "/edits"}, Place{"comfy", ServerKind::Comfy, "/upload/image"}}) {
        DOCTEST_CAPTURE(flavour);
        auto& stand_in = shared_stand_in(flavour);
        auto address = stand_in.address();
        address.kind = kind;
        const auto server = connect(address, {});
        stand_in.set({{"password", "bearer sk-1"}});
        DOCTEST_CHECK(caught([&] { server->redraw(small_order(), {}); }).says("wants a password"));
        DOCTEST_CHECK(stand_in.asked(at).size() <= 1);  // ComfyUI is asked about its nodes first
        setenv("GSEDITPRO_SERVER_TOKEN", "sk-1", 1);
        const auto picture = connect(address, {})->redraw(small_order(), {}).picture;
        unsetenv("GSEDITPRO_SERVER_TOKEN");
        DOCTEST_CHECK(picture.width == 64);
    }
}

DOCTEST_TEST_CASE("a drawing whose answer is lost is not asked for twice") {
    if (!can_stand_in()) return;
    for (const char* fault : {"reset", "no_bytes", "length_long", "half_header"}) {
        Tried tried("forge", ServerKind::Webui);
        DOCTEST_CHECK(tried.with(fault, "draw", {{"times", "1"}}).is(Foreign));
        DOCTEST_CHECK(tried.stand_in.asked("/img2img").size() == 1);
    }
}

DOCTEST_TEST_CASE("questions about a job survive connections that break") {
    if (!can_stand_in()) return;
    Tried tried("sdserver", ServerKind::SdCpp);
    for (const char* fault : {"reset", "no_bytes", "length_long"}) {
        DOCTEST_CHECK(tried.with(fault, "poll", {{"times", "2"}, {"draw_s", "0.1"}}).code == -1);
        DOCTEST_CHECK(tried.stand_in.asked("/img_gen").size() == 1);
    }
    DOCTEST_CHECK(tried.with("close_after", "poll", {{"draw_s", "0.2"}}).code == -1);
}

DOCTEST_TEST_CASE("a job that the server has forgotten is given once more, not for ever") {
    if (!can_stand_in()) return;
    Tried tried("sdserver", ServerKind::SdCpp);
    DOCTEST_CHECK(tried.with("job_lost", "poll", {{"times", "1"}}).code == -1);
    DOCTEST_CHECK(tried.stand_in.asked("/img_gen").size() == 2);
    DOCTEST_CHECK(tried.with("job_lost", "poll").says("forgets its jobs"));
    DOCTEST_CHECK(tried.stand_in.asked("/img_gen").size() == 2);
}

DOCTEST_TEST_CASE("ends of a job other than a picture are told in the server's words") {
    if (!can_stand_in()) return;
    Tried tried("sdserver", ServerKind::SdCpp);
    DOCTEST_CHECK(tried.with("job_expired", "poll").says("thrown the picture away"));
    DOCTEST_CHECK(tried.with("failed", "poll").says("failed to draw: \"model \\x1b[31mbroke <b>\""));
    DOCTEST_CHECK(tried.with("failed_memory", "poll").says("ran out of memory"));
    DOCTEST_CHECK(tried.with("cancelled", "poll").says("cancelled the job"));
    DOCTEST_CHECK(tried.with("unknown_status", "poll").says("unknown state of the job (\"pondering\")"));
    DOCTEST_CHECK(tried.with("poll_elsewhere", "draw").code == -1);
}

DOCTEST_TEST_CASE("ends of a ComfyUI job other than a picture are told in the server's words") {
    if (!can_stand_in()) return;
    Tried tried("comfy", ServerKind::Comfy);
    DOCTEST_CHECK(tried.with("node_errors", "draw")
                      .says("refuses the workflow: node 9 PreviewImage: bad \\x1b[31mvalue (seed)"));
    DOCTEST_CHECK(tried.with("execution_error", "poll")
                      .says("failed to draw: \"node 3 KSampler: bad \\x1b[31mthing\""));
    DOCTEST_CHECK(tried.with("execution_memory", "poll").says("ran out of memory"));
    DOCTEST_CHECK(tried.with("interrupted", "poll").says("was interrupted"));
    DOCTEST_CHECK(tried.with("no_outputs", "poll").says("without a picture"));
    DOCTEST_CHECK(tried.with("old_server", "draw").code == -1);
    DOCTEST_CHECK(tried.with("null_status", "poll").code == -1);
    DOCTEST_CHECK(tried.with("two_images", "poll").code == -1);
    DOCTEST_CHECK(tried.with("evil_name", "poll").code == -1);
    const auto view = tried.stand_in.asked("/view").at(0)["query"];
    DOCTEST_CHECK(view["filename"] == "../we\"ird #1.png");
    DOCTEST_CHECK(view["subfolder"] == "a b");
    DOCTEST_CHECK(tried.with("job_lost", "poll", {{"times", "1"}}).code == -1);
    DOCTEST_CHECK(tried.stand_in.asked("/prompt").size() == 2);
    DOCTEST_CHECK(tried.with("job_lost", "poll").says("forgets its jobs"));
    DOCTEST_CHECK(tried.with("validation", "upload").is(Invalid));
}

DOCTEST_TEST_CASE("a server that is started again in the middle draws after all") {
    if (!can_stand_in()) return;
    for (const auto& [flavour, kind, at] :
         {Place{"sdserver", ServerKind::SdCpp, "/job-1"}, Place{"comfy", ServerKind::Comfy, "/queue"}}) {
        StandIn stand_in(flavour);
        auto address = stand_in.address();
        address.times.away = Milliseconds(20'000);
        address.times.first_retry = address.times.longest_retry = Milliseconds(1'000);
        const auto server = connect(address, {});
        stand_in.set({{"draw_s", "30"}});
        int width = 0;
        std::thread drawing([&] { width = server->redraw(small_order(), {}).picture.width; });
        while (stand_in.asked(at).empty()) std::this_thread::sleep_for(Milliseconds(10));
        stand_in.restart();
        drawing.join();
        DOCTEST_CAPTURE(flavour);
        DOCTEST_CHECK(width == 64);
    }
}

DOCTEST_TEST_CASE("the model that drew a picture is told, also when it changes in between") {
    if (!can_stand_in()) return;
    Tried tried("forge", ServerKind::Webui);
    tried.stand_in.reset({{"model", "first"}});
    DOCTEST_CHECK(tried.server->redraw(small_order(), {}).model == "first");
    tried.stand_in.set({{"model", "second"}});
    DOCTEST_CHECK(tried.server->redraw(small_order(), {}).model == "second");
}

DOCTEST_TEST_CASE("a server that dies in the middle is named, and a queue that stays full is given up") {
    if (!can_stand_in()) return;
    StandIn stand_in("sdserver");
    auto address = stand_in.address();
    address.times.away = Milliseconds(300);
    const auto server = connect(address, {});
    stand_in.set({{"queue_limit", "0"}});
    DOCTEST_CHECK(
        caught([&] { server->redraw(small_order(), {}); }).says("stays busy (429): \"job queue is full\""));
    stand_in.kill();
    const auto gone = caught([&] { server->redraw(small_order(), {}); });
    DOCTEST_CHECK(gone.is(Foreign));
    DOCTEST_CHECK(gone.says("nobody answers at 127.0.0.1:"));
}

}  // namespace
}  // namespace gse::remote
