// Connections: which protocol is spoken, passwords, proxies, addresses of unusual form.
#include <doctest/doctest.h>

#include <sys/stat.h>

#include <cstdlib>
#include <fstream>

#include "engine/base/file.h"
#include "engine/remote/protocols/connect.h"
#include "tests/stress/remote/stand_in.h"
#include "tests/test_paths.h"

namespace gse::remote {
namespace {

/// Sets a variable of the environment for as long as it lives.
class Variable {
public:
    Variable(const char* name, const std::string& value) : name_(name) {
        if (const char* before = std::getenv(name)) before_ = before;
        setenv(name, value.c_str(), 1);
    }
    ~Variable() {
        if (before_.empty()) unsetenv(name_);
        else setenv(name_, before_.c_str(), 1);
    }

private:
    const char* name_;
    std::string before_;
};

DOCTEST_TEST_CASE("each server is recognised by what it answers") {
    if (!can_stand_in()) return;
    struct Known {
        const char *flavour, *product;
        ServerKind kind;
    };
    for (const auto& known :
         {Known{"sdserver", "sd-server", ServerKind::SdCpp}, Known{"kcpp", "koboldcpp", ServerKind::Webui},
          Known{"sdnext", "SD.Next", ServerKind::Webui}, Known{"forge", "Forge", ServerKind::Webui},
          Known{"a1111", "A1111", ServerKind::Webui}, Known{"lookalike", "WebUI", ServerKind::Webui},
          Known{"comfy", "ComfyUI", ServerKind::Comfy}, Known{"vllm", "vLLM-Omni", ServerKind::OpenAi},
          Known{"openai", "OpenAI", ServerKind::OpenAi},
          Known{"local", "OpenAI look-alike", ServerKind::OpenAi}}) {
        auto& stand_in = shared_stand_in(known.flavour);
        const auto facts = connect(stand_in.address(), {})->probe({});
        DOCTEST_CAPTURE(known.flavour);
        DOCTEST_CHECK(facts.kind == known.kind);
        DOCTEST_CHECK(facts.product == known.product);
        for (const auto& entry : stand_in.log()) {
            DOCTEST_CHECK(entry["method"] == "GET");
            const auto path = entry["path"].get<std::string>();  // places that hand out a server's passwords
            DOCTEST_CHECK(path.find("cmd-flags") == std::string::npos);
            DOCTEST_CHECK(path.find("sysinfo") == std::string::npos);
        }
    }
}

DOCTEST_TEST_CASE("servers on this machine are found by their ports, or told with their problem") {
    if (!can_stand_in()) return;
    StandIn comfy("comfy"), locked("forge"), invoke("invoke"), gone("sdserver");
    locked.set({{"password", "basic mira:geheim"}});
    gone.kill();
    const Variable token("GSEDITPRO_SERVER_TOKEN", "geheim");
    const std::vector<int> ports{comfy.port(), locked.port(), gone.port(), invoke.port()};
    const auto found = find_here(ports, {});
    DOCTEST_REQUIRE(found.size() == 3);
    DOCTEST_CHECK(found[0].url == comfy.url());
    DOCTEST_CHECK(found[0].product == "ComfyUI");
    DOCTEST_CHECK(found[0].problem.empty());
    DOCTEST_CHECK(found[1].problem.find("password") != std::string::npos);
    DOCTEST_CHECK(found[2].problem.find("InvokeAI") != std::string::npos);
    for (auto* one : {&comfy, &locked, &invoke})
        for (const auto& entry : one->log()) {
            DOCTEST_CHECK(entry["method"] == "GET");
            DOCTEST_CHECK(entry["secret"] == "");
        }
}

DOCTEST_TEST_CASE("an older sd-server tells its features in another place") {
    if (!can_stand_in()) return;
    auto& stand_in = shared_stand_in("sdserver");
    DOCTEST_CHECK(connect(stand_in.address(), {})->probe({}).references == 4);
    stand_in.reset({{"old_features", "1"}});
    const auto facts = connect(stand_in.address(), {})->probe({});
    DOCTEST_CHECK(facts.references == 0);
    DOCTEST_CHECK(facts.takes_mask);
    stand_in.reset();
}

DOCTEST_TEST_CASE("a server that hangs is not waited for as long as an answer may take") {
    if (!can_stand_in()) return;
    auto& stand_in = shared_stand_in("forge");
    stand_in.set({{"fault", "hang"}, {"at", "probe"}});
    auto address = stand_in.address();
    address.times.look = Milliseconds(300);
    address.times.answer = Milliseconds(60'000);  // longer than the stand-in hangs
    DOCTEST_CHECK(caught([&] { connect(address, {}); }).says("says nothing any more"));
    stand_in.reset();
}

DOCTEST_TEST_CASE("servers that speak no known protocol are told apart") {
    if (!can_stand_in()) return;
    auto& invoke = shared_stand_in("invoke");
    DOCTEST_CHECK(caught([&] { connect(invoke.address(), {}); }).says("InvokeAI"));
    auto& plain = shared_stand_in("none");
    DOCTEST_CHECK(caught([&] { connect(plain.address(), {}); }).hint.find("--api") != std::string::npos);
    plain.set({{"fault", "html_200"}, {"at", "probe"}});
    DOCTEST_CHECK(caught([&] { connect(plain.address(), {}); }).says("speaks no protocol"));
    auto address = plain.address();
    address.kind = ServerKind::SdCpp;
    plain.reset();
    DOCTEST_CHECK(caught([&] { connect(address, {}); }).says("404"));
}

DOCTEST_TEST_CASE("nobody listening is said at once") {
    if (!can_stand_in()) return;
    StandIn stand_in("sdserver");
    const auto address = stand_in.address();
    stand_in.kill();
    const auto error = caught([&] { connect(address, {}); });
    DOCTEST_CHECK(error.is(ErrorCode::Foreign));
    DOCTEST_CHECK(error.says("nobody answers at 127.0.0.1:"));
}

DOCTEST_TEST_CASE("passwords come from the environment, the file or the address, and are refused once") {
    if (!can_stand_in()) return;
    test::ScratchFolder folder;
    const Variable config("GSE_CONFIG_DIR", folder.path().string());
    auto& stand_in = shared_stand_in("forge");
    stand_in.set({{"password", "basic anna:geheim:1"}});
    DOCTEST_CHECK(caught([&] { connect(stand_in.address(), {}); }).says("wants a password"));
    {
        const Variable token("GSEDITPRO_SERVER_TOKEN", "anna:geheim:1");
        connect(stand_in.address(), {})->redraw(small_order(), {});
    }
    {
        const Variable token("GSEDITPRO_SERVER_TOKEN", "anna:wrong");
        const auto error = caught([&] { connect(stand_in.address(), {}); });
        DOCTEST_CHECK(error.says("refuses the password"));
        DOCTEST_CHECK(error.message.find("wrong") == std::string::npos);
    }
    const auto typed = "http://anna:geheim%3A1@127.0.0.1:" + std::to_string(stand_in.port()) + "/";
    const auto kept = keep_credentials(typed);
    DOCTEST_CHECK(kept == stand_in.url());
    const auto file = folder.path() / "servers.json";
    struct stat status {};
    DOCTEST_REQUIRE(stat(file.c_str(), &status) == 0);
    DOCTEST_CHECK((status.st_mode & 0777) == 0600);
    connect(stand_in.address(), {});
    chmod(file.c_str(), 0644);
    DOCTEST_CHECK(caught([&] { connect(stand_in.address(), {}); }).says("can be read by others"));
}

DOCTEST_TEST_CASE("a secret goes to its own origin only") {
    if (!can_stand_in()) return;
    test::ScratchFolder folder;
    const Variable config("GSE_CONFIG_DIR", folder.path().string());
    auto& first = shared_stand_in("forge");
    auto& second = shared_stand_in("a1111");
    keep_credentials("http://anna:geheim@127.0.0.1:" + std::to_string(first.port()));
    connect(second.address(), {});
    for (const auto& entry : second.log()) DOCTEST_CHECK(entry["secret"] == "");
    const auto server = connect(first.address(), {});
    DOCTEST_CHECK(first.log().back()["secret"] == "Basic");
    first.set({{"fault", "redirect"}, {"target", second.url() + "/sdapi/v1/img2img"}});
    DOCTEST_CHECK(caught([&] { server->redraw(small_order(), {}); }).says("sends us on to " + second.url()));
    DOCTEST_CHECK(second.asked("/img2img").empty());
}

DOCTEST_TEST_CASE("a secret is not sent unencrypted to a public address") {
    const Variable token("GSEDITPRO_SERVER_TOKEN", "abc");
    ServerAddress address;
    for (const char* url : {"http://example.com", "http://8.8.8.8:7860", "http://a:b@example.com/x"}) {
        address.url = url;
        const auto error = caught([&] { connect(address, {}); });
        DOCTEST_CHECK(error.is(ErrorCode::InvalidArgument));
        DOCTEST_CHECK(error.says("unencrypted"));
    }
}

DOCTEST_TEST_CASE("a secret with characters that no header holds is not sent") {
    if (!can_stand_in()) return;
    auto& stand_in = shared_stand_in("sdserver");
    const Variable token("GSEDITPRO_SERVER_TOKEN", "abc\r\nEvil");
    const auto error = caught([&] { connect(stand_in.address(), {}); });
    DOCTEST_CHECK(error.is(ErrorCode::InvalidArgument));
    DOCTEST_CHECK(error.message.find("Evil") == std::string::npos);
    DOCTEST_CHECK(stand_in.log().empty());
}

DOCTEST_TEST_CASE("bearer tokens are sent as such") {
    if (!can_stand_in()) return;
    const Variable token("GSEDITPRO_SERVER_TOKEN", "sk-123");
    auto& stand_in = shared_stand_in("sdserver");
    stand_in.set({{"password", "bearer sk-123"}});
    DOCTEST_CHECK(connect(stand_in.address(), {})->probe({}).product == "sd-server");
}

DOCTEST_TEST_CASE("a proxy of the environment sees nothing of this machine's servers") {
    if (!can_stand_in()) return;
    auto& trap = shared_stand_in("none");
    const Variable one("http_proxy", trap.url()), all("ALL_PROXY", trap.url());
    auto& stand_in = shared_stand_in("sdserver");
    connect(stand_in.address(), {})->redraw(small_order(), {});
    const Variable none("no_proxy", "127.0.0.1");  // for the stand-in's own log
    DOCTEST_CHECK(trap.log().empty());
}

/// Certificate with its key in one file; empty where openssl makes none.
std::filesystem::path certificate(const std::filesystem::path& folder, const std::string& name,
                                  bool expired) {
    const auto file = folder / "certificate.pem";
    auto command = "cd " + folder.string() +
                   " && openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -subj /CN=x"
                   " -days 2 -addext subjectAltName=" +
                   name + " -keyout key.pem -out made.pem";
    if (expired) command += " && openssl x509 -in made.pem -signkey key.pem -days -1 -out made.pem";
    command = "(" + command + " && cat made.pem key.pem > certificate.pem) 2>/dev/null";
    return std::system(command.c_str()) == 0 ? file : std::filesystem::path();
}

DOCTEST_TEST_CASE("a certificate is trusted only where it is named, right and not expired") {
    if (!can_stand_in()) return;
    struct Certificate {
        const char* name;
        bool expired, named, trusted;
    };
    for (const auto& tried :
         {Certificate{"IP:127.0.0.1", false, true, true}, Certificate{"IP:127.0.0.1", false, false, false},
          Certificate{"IP:127.0.0.2", false, true, false}, Certificate{"IP:127.0.0.1", true, true, false}}) {
        const test::ScratchFolder folder;
        const auto file = certificate(folder.path(), tried.name, tried.expired);
        if (file.empty()) return test::skip("openssl makes no certificate here");
        StandIn stand_in("sdserver", "127.0.0.1", file);
        auto address = stand_in.address();
        if (tried.named) address.ca_file = file;
        const auto error = caught([&] { connect(address, {})->redraw(small_order(), {}); });
        DOCTEST_CAPTURE(tried.name);
        DOCTEST_CAPTURE(tried.expired);
        DOCTEST_CAPTURE(error.message);
        DOCTEST_CHECK((error.code == -1) == tried.trusted);
        if (!tried.trusted) DOCTEST_CHECK(error.says("no safe connection"));
    }
}

DOCTEST_TEST_CASE("servers are found over IPv6") {
    if (!can_stand_in()) return;
    std::unique_ptr<StandIn> stand_in;
    try {
        stand_in = std::make_unique<StandIn>("sdserver", "::1");
    } catch (const std::runtime_error&) { return test::skip("this machine has no IPv6"); }
    connect(stand_in->address(), {})->redraw(small_order(), {});
    DOCTEST_CHECK(stand_in->log().at(0)["host"] == "[::1]:" + std::to_string(stand_in->port()));
}

DOCTEST_TEST_CASE("servers are found below a path") {
    if (!can_stand_in()) return;
    auto& stand_in = shared_stand_in("sdnext");
    stand_in.set({{"prefix", "/studio/sd"}});
    auto address = stand_in.address();
    address.url += "/studio/sd/";
    DOCTEST_CHECK(connect(address, {})->probe({}).product == "SD.Next");
    DOCTEST_CHECK(caught([&] { connect(stand_in.address(), {}); }).is(ErrorCode::Foreign));
}

DOCTEST_TEST_CASE("plain HTTP behind an https address is no safe connection") {
    if (!can_stand_in()) return;
    auto& stand_in = shared_stand_in("sdserver");
    auto address = stand_in.address();
    address.url.replace(0, 4, "https");
    const auto error = caught([&] { connect(address, {}); });
    DOCTEST_CHECK(error.is(ErrorCode::Foreign));
    DOCTEST_CHECK(error.says("no safe connection"));
}

}  // namespace
}  // namespace gse::remote
